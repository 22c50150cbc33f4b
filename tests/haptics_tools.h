// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tools, and how they lie in a volume.
#include "haptics_scene.h"

namespace trephine::tools {

using namespace haptic_scenes;

inline constexpr const char* kinds[] = {"needle", "catheter", "burr", "craniotome", "jamshidi"};

inline haptics::ToolParams params_of(const char* kind, double diameter = 0, double length = 0, double spacing = 0) {
  haptics::ToolParams p;
  p.tool = kind;
  p.tool_diameter_mm = diameter;
  p.tool_length_mm = length;
  p.tool_spacing_mm = spacing;
  return p;
}

/// What friction is tested with.
inline std::vector<std::pair<const char*, haptics::ToolParams>> held_tools() {
  return {{"point", {}},
          {"burr", params_of("burr", 3, 6)},
          {"ball", params_of("ball", 3)},
          {"catheter", params_of("catheter", 2.5, 8, 1)}};
}

inline haptics::HapticInput pose(Vec3 tip_mm, Vec3 axis) {
  haptics::HapticInput in;
  in.tip_mm = tip_mm;
  in.axis = normalized(axis);
  return in;
}

// Points of the tool that lie in one of the shapes.
inline int points_in(const haptics::Proxy& proxy, const contact::ContactVolume& contact, std::uint64_t shapes) {
  const haptics::ToolBody& b = *proxy.tool_body();
  int n = 0;
  for (int i = 0; i < b.count(); ++i) n += shapes >> contact.shape_at(b.at_mm(i)) & 1;
  return n;
}

// Filled as voxelize does, with a ramp of a voxel to each side.
inline void fill_wide(voxel::HapticVolume& v, int number, const std::function<double(Vec3)>& level) {
  fill(v, number, [&](Vec3 p) { return 0.5 * level(p); });
}

inline voxel::HapticVolume floor_volume(int n = 40) {
  voxel::HapticVolume v = empty(n, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return -p.z; });
  return v;
}

}  // namespace trephine::tools
