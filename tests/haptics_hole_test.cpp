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
double drilled_mm(const char* kind, double diameter_mm) {
  voxel::HapticVolume volume = empty(32, {0.8, 0.8, 0.8});
  fill(volume, 1, [](Vec3 p) { return 0.5 * (6 - p.z); });
  contact::ContactVolume contact(volume);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.05};
  haptics::DrillingParams params;
  params.drill = true;
  const haptics::ToolParams tool = haptics::own_tool(params_of(kind, diameter_mm));
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, tool));
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), plain(), {},
                       haptics::make_tool(tool));
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
TEST(HapticsHole, AToolThatCutsWhereItIsIsFeltAsWideAsItCuts) {
  EXPECT_GT(drilled_mm("ball", 4), 14);
  EXPECT_GT(drilled_mm("craniotome", 4), 10);
}
