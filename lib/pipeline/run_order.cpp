// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_order.h"

#include <algorithm>

namespace trephine::pipeline {

RunOrder::RunOrder(const Graph& graph, const std::function<bool(int node)>& is_asked)
    : urgency_(graph.nodes.size()), group_(graph.nodes.size()) {
  std::vector<std::vector<int>> checks;  // each with all that it needs, itself the first
  for (std::size_t i = graph.nodes.size(); i-- > 0;) {
    const Node& node = graph.nodes[i];
    for (const auto& [port, source] : node.sources)
      urgency_[std::size_t(source)] = std::max(urgency_[std::size_t(source)], urgency_[i] + 1);
    const bool is_check = node.type->is_check() && node.output == stages::DataKind::nothing;
    const bool asked = node.output == stages::DataKind::landmarks && is_asked(int(i));
    if (is_check || asked || node.type->check.recognises) checks.push_back(graph.needs_of(int(i)));
  }
  std::sort(checks.begin(), checks.end(), [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.front() < b.front();
  });
  std::fill(group_.begin(), group_.end(), int(checks.size()));
  for (int c = int(checks.size()); c-- > 0;)
    for (const int n : checks[std::size_t(c)]) group_[std::size_t(n)] = c;
}

bool RunOrder::comes_before(int node, int other) const {
  const auto a = std::size_t(node), b = std::size_t(other);
  if (group_[a] != group_[b]) return group_[a] < group_[b];
  return urgency_[a] != urgency_[b] ? urgency_[a] > urgency_[b] : node < other;
}

}  // namespace trephine::pipeline
