// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/expected_time.h"

#include <algorithm>

#include "base/parallel.h"
#include "pipeline/schedule.h"

namespace trephine::pipeline {
namespace {

constexpr double plane_pixels = 512.0 * 512.0;
constexpr double head_million_voxels = 30;  // 115 slices
// As long as the nodes that have run are worth less than these seconds, what was expected counts more than what they
// took.
constexpr double machine_held_s = 4, stage_held_s = 0.1;
// A stage that takes longer than this finds the scan hard, which says nothing of the others.
constexpr double most_by_machine_ratio = 3;

}  // namespace

ExpectedTime::ExpectedTime(const Graph& graph, const std::map<std::string, double>& seconds_before)
    : graph_(graph), before_(seconds_before), amounts_(graph.nodes.size()) {
  expect_amounts();
}

// The most of each that one of its sources hands it; what has none reads a head.
ExpectedTime::Amount ExpectedTime::read_by(const Node& node) const {
  if (node.sources.empty()) return {false, head_million_voxels, 1, 0};
  Amount a;
  for (const auto& [port, source] : node.sources) {
    const Amount& from = amounts_[std::size_t(source)];
    a.million_voxels = std::max(a.million_voxels, from.million_voxels);
    a.plane_ratio = std::max(a.plane_ratio, from.plane_ratio);
    a.million_triangles = std::max(a.million_triangles, from.million_triangles);
  }
  return a;
}

// A node comes after its sources.
void ExpectedTime::expect_amounts() {
  for (std::size_t i = 0; i < amounts_.size(); ++i) {
    Amount& a = amounts_[i];
    const Node& node = graph_.nodes[i];
    const stages::TypicalTime& typical = node.type->typical;
    if (!a.counted) a = read_by(node);
    if (node.output == stages::DataKind::mesh) continue;
    // Of a field: what its surface will have. A stage that only hands a field on says nothing of it.
    if (typical.surface_million > 0) {
      a.million_triangles = typical.surface_million * a.plane_ratio;
    } else if (a.counted) {
      a.million_triangles = read_by(node).million_triangles;
    }
  }
}

void ExpectedTime::learn(int node, const stages::StageData& output, double took_s) {
  const Node& n = graph_.nodes[std::size_t(node)];
  if (took_s > 0) {
    const auto take = [](Taken& t, double expected_s, double seconds) {
      t.expected_s += expected_s;
      t.took_s += seconds;
    };
    if (const auto before = before_.find(n.name); before != before_.end()) {
      take(by_earlier_, before->second, took_s);
    } else {
      const double expected_s = typical_s(n);
      take(by_typical_, expected_s, std::min(took_s, most_by_machine_ratio * expected_s));
      take(of_[n.type], expected_s, took_s);
    }
  }
  Amount a{true, 0, 0, 0};
  const auto count = [&](const grid::Lattice& lattice) {
    a.plane_ratio = double(lattice.size[0]) * lattice.size[1] / plane_pixels;
    a.million_voxels = double(lattice.size[0]) * lattice.size[1] * lattice.size[2] / 1e6;
  };
  if (const auto* volume = std::get_if<std::shared_ptr<const grid::HuVolume>>(&output); volume && *volume)
    std::visit([&](const auto& v) { count(v); }, **volume);
  else if (const auto* field = std::get_if<std::shared_ptr<const grid::Field>>(&output); field && *field)
    count(**field);
  else if (const auto* mesh = std::get_if<std::shared_ptr<const surface::TriMesh>>(&output); mesh && *mesh)
    a.million_triangles = double((*mesh)->triangles.size()) / 1e6;
  else
    return;
  amounts_[std::size_t(node)] = a;
  expect_amounts();
}

double ExpectedTime::typical_s(const Node& node) const {
  const stages::TypicalTime& t = node.type->typical;
  const Amount read = read_by(node);
  return t.base_s + t.per_million_voxels_s * read.million_voxels + t.per_million_triangles_s * read.million_triangles +
         t.per_input_s * double(node.sources.size());
}

double ExpectedTime::seconds_of(const Node& node) const {
  if (const auto before = before_.find(node.name); before != before_.end())
    return before->second * by_earlier_.ratio(machine_held_s, 1);
  const double machine = by_typical_.ratio(machine_held_s, 1);
  const auto of = of_.find(node.type);
  return typical_s(node) * (of == of_.end() ? machine : of->second.ratio(stage_held_s, machine));
}

std::vector<std::pair<std::string, double>> ExpectedTime::plan(const std::vector<char>& to_do) const {
  std::vector<int> planned(graph_.nodes.size(), -1);  // its place among the tasks
  std::vector<ScheduledTask> schedule;
  std::vector<std::pair<std::string, double>> expected_s;
  for (std::size_t i = 0; i < graph_.nodes.size(); ++i) {
    if (!to_do[i]) continue;
    const Node& node = graph_.nodes[i];
    planned[i] = int(schedule.size());
    schedule.push_back({seconds_of(node), {}});
    for (const auto& [port, source] : node.sources)
      if (planned[std::size_t(source)] >= 0) schedule.back().sources.push_back(planned[std::size_t(source)]);
    expected_s.emplace_back(node.name, 0);
  }
  const std::vector<double> shares = wall_shares_s(schedule, thread_count());
  for (std::size_t i = 0; i < shares.size(); ++i) expected_s[i].second = shares[i];
  return expected_s;
}

}  // namespace trephine::pipeline
