// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/expected_time.h"

#include "base/parallel.h"
#include "pipeline/schedule.h"

namespace trephine::pipeline {

ExpectedTime::ExpectedTime(const Graph& graph, const std::map<std::string, double>& seconds_before)
    : graph_(graph), before_(seconds_before), triangles_(graph.nodes.size()) {}

bool ExpectedTime::learn(int node, const stages::StageData& output) {
  if (const auto* mesh = std::get_if<std::shared_ptr<const surface::TriMesh>>(&output); mesh && *mesh)
    triangles_[std::size_t(node)] = double((*mesh)->triangles.size());
  return triangles_[std::size_t(node)] > 0;
}

double ExpectedTime::seconds_of(const Node& node) const {
  if (const auto before = before_.find(node.name); before != before_.end()) return before->second;
  for (const auto& [port, source] : node.sources)
    if (const double triangles = triangles_[std::size_t(source)]; node.type->typical_s_per_million > 0 && triangles > 0)
      return node.type->typical_s_per_million * triangles / 1e6;
  return node.type->typical_s;
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
