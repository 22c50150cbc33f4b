// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "pipeline/graph.h"

namespace trephine::pipeline {

/// The order in which one thread runs a graph's nodes: what a check reads, and the check, which may refuse the case,
/// the check that reads the least first; then the rest. Among these the earlier, the more nodes wait. Stages that
/// recognise a part of the body, and landmarks of which the case asks something (`is_asked`), count as checks. The
/// order depends on graph and case alone. The graph must outlive the constructor only.
class RunOrder {
 public:
  RunOrder(const Graph& graph, const std::function<bool(int node)>& is_asked);
  bool comes_before(int node, int other) const;

 private:
  std::vector<int> urgency_, group_;
};

}  // namespace trephine::pipeline
