// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/burrs.h"

#include <cmath>

#include "base/error.h"

namespace trephine::haptics {

std::vector<ToolParams> burr_library() {
  std::vector<ToolParams> all;
  for (const ToolKind& kind : all_tool_kinds())
    for (const double mm : kind.sizes_mm) {
      ToolParams burr;
      burr.tool = kind.name;
      burr.tool_diameter_mm = mm;
      all.push_back(own_tool(burr));
    }
  return all;
}

int other_burr(const std::vector<ToolParams>& burrs, const ToolParams& in_hand, const std::string& asked) {
  if (asked != "smaller" && asked != "larger" && asked != "kind")
    throw Error(ExitCode::usage, "", "burr", "must be smaller, larger or kind");
  const double mm = own_tool(in_hand).tool_diameter_mm;
  const auto off_mm = [&](std::size_t n) { return burrs[n].tool_diameter_mm - mm; };
  if (asked != "kind") {
    const double sign = asked == "larger" ? 1 : -1;
    int next = -1;
    for (std::size_t n = 0; n < burrs.size(); ++n)
      if (burrs[n].tool == in_hand.tool && sign * off_mm(n) > 1e-6 &&
          (next < 0 || sign * off_mm(n) < sign * off_mm(std::size_t(next))))
        next = int(n);
    return next;
  }
  // The kinds in the order of the list, round and round, from the one in hand.
  std::vector<std::string> kinds;
  for (const ToolParams& b : burrs)
    if (kinds.empty() || kinds.back() != b.tool) kinds.push_back(b.tool);
  std::size_t now = kinds.size() - 1;
  for (std::size_t n = 0; n < kinds.size(); ++n)
    if (kinds[n] == in_hand.tool) now = n;
  int next = -1;
  for (std::size_t n = 0; n < burrs.size(); ++n)
    if (burrs[n].tool == kinds[(now + 1) % kinds.size()] && burrs[n].tool != in_hand.tool &&
        (next < 0 || std::abs(off_mm(n)) < std::abs(off_mm(std::size_t(next)))))
      next = int(n);
  return next;
}

ToolParams with_burr(const ToolParams& in_hand, const ToolParams& burr) {
  ToolParams next = in_hand;
  next.tool_diameter_mm = burr.tool_diameter_mm;
  if (next.tool == burr.tool) return next;
  next.tool = burr.tool;
  next.tool_tip = burr.tool_tip;
  next.tool_length_mm = burr.tool_length_mm;
  next.tool_spacing_mm = burr.tool_spacing_mm;
  next.tool_points.clear();
  next.tool_points_sha256.clear();
  return next;
}

}  // namespace trephine::haptics
