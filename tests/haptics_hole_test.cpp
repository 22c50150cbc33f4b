// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that drills must fit into the hole that it cuts.
#include <gtest/gtest.h>

#include "haptics/drilling.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

// How deep a hand comes that pushes a ball of 4 mm into bone, in voxels of 0.8 mm, and does not push on while the bone
// holds back more than 1 N. Its way is straight and no axis of the lattice.
double drilled_mm(haptics::DrillingParams::At cut_at, double clearance_voxels, const char* kind, double diameter_mm) {
  voxel::HapticVolume volume = empty(32, {0.8, 0.8, 0.8});
  fill(volume, 1, [](Vec3 p) { return 0.5 * (6 - p.z); });
  contact::ContactVolume contact(volume);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.05};
  haptics::DrillingParams params;
  params.drill = true;
  params.cut_at = cut_at;
  params.clearance_voxels = clearance_voxels;
  const haptics::ToolParams tool = haptics::own_tool(params_of(kind, diameter_mm));
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, tool));
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), plain(), {},
                       haptics::make_tool(haptics::felt_tool(params, tool, volume.voxels.spacing_mm)));
  const Vec3 axis = normalized({0.13, -0.07, 1}), begin = axis * 7.0;
  double way_mm = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    haptics::HapticInput in = pose(begin - axis * way_mm, axis);
    in.buttons = haptics::Drilling::pedal;
    in.extra_n = drilling.force_n();
    const haptics::HapticState& is = proxy.update(in);
    drilling.tick(in, is);
    if (norm(is.force_n) < 1) way_mm += 0.004;
  }
  return way_mm;
}

}  // namespace

// The hand may go 24 mm in this time, and is 13 mm deep when it is through the volume's middle.
TEST(HapticsHole, AToolThatIsFeltNarrowerIsNotHeldByItsOwnHole) {
  using At = haptics::DrillingParams::At;
  const double own = drilled_mm(At::device, 1.75, "ball", 4), jammed = drilled_mm(At::device, 0, "ball", 4);
  const double cylinder = drilled_mm(At::device, 1.75, "craniotome", 4);
  std::printf("  %.1f mm deep, %.1f without a clearance; a cylinder %.1f\n", own, jammed, cylinder);
  EXPECT_GT(own, 14);
  EXPECT_LT(jammed, 0.7 * own);
  EXPECT_GT(cylinder, 10);
}

// A cutter that is where the tool is needs no clearance.
TEST(HapticsHole, AToolThatCutsWhereItIsIsFeltAsWideAsItCuts) {
  const haptics::DrillingParams now;
  EXPECT_EQ(now.clearance_voxels, 0);
  EXPECT_GT(drilled_mm(now.cut_at, now.clearance_voxels, "ball", 4), 14);
  EXPECT_GT(drilled_mm(now.cut_at, now.clearance_voxels, "craniotome", 4), 10);
}

TEST(HapticsHole, OnlyWhatRotatesIsFeltNarrower) {
  haptics::DrillingParams params;
  params.drill = true;
  params.clearance_voxels = 1.75;
  const auto felt = [&](const char* kind, double spacing_mm) {
    return haptics::felt_tool(params, haptics::own_tool(params_of(kind)), {spacing_mm, 0.1, 0.1}).tool_diameter_mm;
  };
  EXPECT_DOUBLE_EQ(felt("ball", 0.8), 5 - 1.4);
  EXPECT_DOUBLE_EQ(felt("burr", 0.4), 5 - 0.7);
  EXPECT_DOUBLE_EQ(felt("ball", 4), 1.5) << "never thinner than 0.3 of what cuts";
  EXPECT_EQ(felt("scalpel", 0.8), haptics::own_tool(params_of("scalpel")).tool_diameter_mm);
  EXPECT_EQ(felt("catheter", 0.8), haptics::own_tool(params_of("catheter")).tool_diameter_mm);
  params.drill = false;
  EXPECT_EQ(felt("ball", 0.8), 5);
}
