// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "drill/cutter.h"
#include "haptics/tool.h"

namespace trephine::haptics {

/// What a drill may hold, and how many edges it has, for what is heard.
struct Burr {
  drill::Cutter cutter;
  int flutes = 8;
};

/// Every kind that rotates in each of its usual sizes (ToolKind::sizes_mm), in the order of the kinds and ascending.
std::vector<ToolParams> burr_library();
/// Another of the burrs than the one in hand, by what was asked for: `smaller` or `larger`, the next size of its kind;
/// `kind`, the next kind, in the size nearest to it. -1 where there is none; 64 for another word.
int other_burr(const std::vector<ToolParams>& burrs, const ToolParams& in_hand, const std::string& asked);
/// The tool in hand with that burr of the library: how it is searched and locked stays, and within a kind also its tip,
/// length and spacing.
ToolParams with_burr(const ToolParams& in_hand, const ToolParams& burr);

}  // namespace trephine::haptics
