// SPDX-License-Identifier: GPL-3.0-or-later
// What speaks against each algorithm, as the dissertation's Table IV lists it.
#include <fmt/format.h>

#include <algorithm>

#include "base/joined.h"
#include "base/text.h"
#include "peers/comparison.h"

namespace trephine::peers {
namespace {

constexpr double period_us = 1000, picture_ms = 17, grows = 3, lost = 0.01;

void servo_issues(const Comparison& c, const std::string& name, std::vector<std::string>& out) {
  const ServoRow* slowest = nullptr;
  for (const ServoRow& r : c.servo)
    if (r.algorithm == name && keeps_contact(r) && (!slowest || r.times.p99_us > slowest->times.p99_us)) slowest = &r;
  if (slowest && slowest->times.p99_us >= period_us)
    out.push_back(fmt::format("ticks above 1 ms (99th percentile {:.0f} us)", slowest->times.p99_us));
  const ServoRow *small = servo_of(c, name, false), *large = servo_of(c, name, true);
  if (!small || !large || small->triangles == large->triangles) return;
  const double ratio = large->times.mean_us / std::max(1e-3, small->times.mean_us);
  if (ratio >= grows)
    out.push_back(fmt::format("a tick takes {:.0f} times as long with {} polygons as with {}", ratio,
                              grouped_text(large->triangles), grouped_text(small->triangles)));
}

void force_issues(const Comparison& c, const std::string& name, std::vector<std::string>& out) {
  const Spread anomaly = spread_of(c, name, true, [](const RunFigures& f) { return f.force.anomaly_ratio; });
  const Spread without = spread_of(c, name, true, [](const RunFigures& f) { return f.force.zero_force_ratio; });
  if (anomaly.most > 0)
    out.push_back(
        fmt::format("anomalies of the force (coefficient {:.5f}, at most {:.5f})", anomaly.mean, anomaly.most));
  if (without.mean > lost) out.push_back(fmt::format("no force in {:.1f} % of the frames", 100 * without.mean));
  int falls = 0, pokes = 0;
  for (const FallRow& r : c.falls) {
    if (r.algorithm != name) continue;
    falls += r.falls;
    pokes += r.pokes;
  }
  if (falls > 0) out.push_back(fmt::format("thin walls are poked through ({} of {})", falls, pokes));
}

}  // namespace

std::vector<std::string> issues_of(const Comparison& c, const std::string& algorithm) {
  std::vector<std::string> out;
  servo_issues(c, algorithm, out);
  force_issues(c, algorithm, out);
  const ClientRow* client = client_of(c, algorithm, true);
  if (client && client->haptics_ms >= picture_ms)
    out.push_back(fmt::format("{:.0f} ms of the client thread for a picture", client->haptics_ms));
  return out;
}

std::string issue_table(const Comparison& c) {
  std::string text = "| algorithm | issues |\n|---|---|\n";
  for (const AlgorithmKind& kind : c.kinds) {
    const std::string issues = joined(issues_of(c, kind.name), "; ");
    text += fmt::format("| {} | {} |\n", kind.title, issues.empty() ? "none observed" : issues);
  }
  return text;
}

}  // namespace trephine::peers
