// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/tracking_file.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/rigid_fit.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::track {
namespace {

constexpr double unit_off = 1e-5;
constexpr std::size_t most_bytes = 1 << 20;

template <class T>
T read_declared(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, most_bytes);
    T out;
    json::JsonRules rules;
    rules.by_program = true;
    json::read_declared_json({bytes.data(), bytes.size()}, parameters_of<T>(), &out, rules);
    return out;
  });
}

}  // namespace

std::string TrackedTool::fault() const {
  if (body.empty()) return "body: is empty";
  return std::abs(norm(axis) - 1) < unit_off ? "" : "axis: is not of length 1";
}

std::string Tracking::fault() const {
  if (!is_rotation(map_of(reference_to_case).turn, unit_off)) return "reference_to_case: is no rotation with a shift";
  if (tools.empty()) return "tools: there are none";
  for (const TrackedTool& t : tools)
    if (const std::string fault = t.fault(); !fault.empty()) return "tools." + fault;
  for (const TrackedTool& t : tools)
    if (t.body == reference) return "tools: " + t.body + " is the reference";
  return "";
}

std::string to_json(const TrackedTool& tool) { return json::declared_json(AnyParams::make<TrackedTool>(tool)) + "\n"; }
std::string to_json(const Tracking& tracking) {
  return json::declared_json(AnyParams::make<Tracking>(tracking)) + "\n";
}

TrackedTool read_tool(const std::filesystem::path& file) { return read_declared<TrackedTool>(file); }
Tracking read_tracking(const std::filesystem::path& file) { return read_declared<Tracking>(file); }

int tool_for(const Tracking& tracking, const std::string& lesson_tool) {
  const auto named = [&](const std::string& name) {
    return std::find_if(tracking.tools.begin(), tracking.tools.end(),
                        [&](const TrackedTool& t) { return t.lesson_tool == name; });
  };
  const auto own = named(lesson_tool), any = named("");
  return own != tracking.tools.end()   ? int(own - tracking.tools.begin())
         : any != tracking.tools.end() ? int(any - tracking.tools.begin())
                                       : 0;
}

double place_error_mm(const Tracking& tracking) {
  double tip = 0;
  for (const TrackedTool& t : tracking.tools) tip = std::max(tip, t.tip_error_mm);
  return std::hypot(tracking.target_error_mm, tip);
}

}  // namespace trephine::track
