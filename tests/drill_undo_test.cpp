// SPDX-License-Identifier: GPL-3.0-or-later
// What was cut is put back to the bit, step by step or all at once.
#include <gtest/gtest.h>

#include "drill/live_surface.h"
#include "drill/undo_log.h"
#include "drill_scene.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

// A winding stroke through bone, and an incision where `n` is 2.
void stroke(drill::Drill& d, const grid::Lattice& l, int n) {
  std::mt19937_64 rng(std::uint64_t(n) + 1);
  d.begin_step();
  const Vec3 from = l.to_world_mm({uniform(rng, 10, 30), uniform(rng, 10, 30), uniform(rng, 12, 28)}),
             to = l.to_world_mm({uniform(rng, 10, 30), uniform(rng, 10, 30), uniform(rng, 12, 28)});
  if (n == 2) {
    d.incise(to, 6);
    while (d.incising()) d.go_on();
    return;
  }
  drill::ToolPose pose;
  for (int tick = 0; tick <= 120; ++tick) {
    pose.tip_mm = from + (to - from) * (tick / 120.0);
    cut(d, pose, 0.001);
  }
  d.rest();
}

int put_back(drill::Drill& d) {
  int calls = 0;
  while (d.putting_back()) {
    d.put_back();
    ++calls;
  }
  return calls;
}

}  // namespace

// Strokes through shared voxels and an incision: each step taken back gives the voxels before it, and cutting the same
// again gives the same voxels, fractions and all.
TEST(DrillUndo, StepByStepToTheBit) {
  voxel::HapticVolume volume = layers(40, 0.5);
  const grid::Grid<std::int16_t> begin = volume.voxels;
  drill::DirtyBricks marks(volume.voxels);
  drill::Drill d(volume, of_layers(), ball(2), {}, &marks);
  d.keep_steps(8);
  drill::LiveSurface bone(volume, 2);
  std::vector<grid::Grid<std::int16_t>> stands;
  for (int n = 0; n < 5; ++n) {
    stands.push_back(volume.voxels);
    stroke(d, volume.voxels, n);
    EXPECT_NE(volume.voxels.voxels, stands.back().voxels) << n << ": nothing was cut";
  }
  const grid::Grid<std::int16_t> end = volume.voxels;
  for (int n = 4; n >= 1; --n) {
    ASSERT_TRUE(d.take_back());
    put_back(d);
    EXPECT_EQ(volume.voxels.voxels, stands[std::size_t(n)].voxels) << n;
  }
  for (int n = 1; n < 5; ++n) stroke(d, volume.voxels, n);
  EXPECT_EQ(volume.voxels.voxels, end.voxels) << "the same strokes again";
  EXPECT_TRUE(d.take_all_back(begin));
  put_back(d);
  EXPECT_EQ(volume.voxels.voxels, begin.voxels);
  EXPECT_FALSE(d.take_back()) << "nothing is left";
  EXPECT_FALSE(d.take_all_back(begin));
  for (int n = 0; n < 5; ++n) stroke(d, volume.voxels, n);
  EXPECT_EQ(volume.voxels.voxels, end.voxels);
  // The surface that follows is that of a volume made anew.
  std::vector<std::size_t> marked;
  marks.take(marked);
  bone.update(marked);
  ASSERT_TRUE(d.take_back());
  put_back(d);
  marked.clear();
  marks.take(marked);
  bone.update(marked);
  const drill::LiveSurface anew(volume, 2);
  for (std::size_t b = 0; b < anew.layout().count(); ++b) ASSERT_EQ(anew.brick(b).indices, bone.brick(b).indices) << b;
}

// What is put back in a call is bounded, however much a step cut.
TEST(DrillUndo, InPartsThatABusyTickCanBear) {
  voxel::HapticVolume volume = full(64, 0.4);
  const grid::Grid<std::int16_t> begin = volume.voxels;
  drill::DrillParams law;
  law.power_w = 1000;
  drill::Drill d(volume, only(1, 0.001), ball(8), law);
  d.keep_steps(3);
  stroke(d, volume.voxels, 0);
  std::size_t cut = 0;
  for (std::size_t n = 0; n < begin.voxels.size(); ++n) cut += begin.voxels[n] != volume.voxels.voxels[n];
  ASSERT_GT(cut, 20000u);
  ASSERT_TRUE(d.take_back());
  std::size_t most = 0, before = cut;
  while (d.putting_back()) {
    d.put_back();
    std::size_t left = 0;
    for (std::size_t n = 0; n < begin.voxels.size(); ++n) left += begin.voxels[n] != volume.voxels.voxels[n];
    most = std::max(most, before - left);
    before = left;
  }
  EXPECT_EQ(before, 0u);
  EXPECT_LE(most, 4000u);
}

// The log alone: the oldest steps make room, a step that is too large is forgotten with all before it.
TEST(DrillUndo, TheLogKeepsWhatItHasRoomFor) {
  drill::UndoLog log(100, 3, 10);
  const auto noted = [&](std::uint32_t from, std::uint32_t to) {
    log.begin_step();
    for (std::uint32_t n = from; n < to; ++n) {
      log.note({n, std::int16_t(n), 0});
      log.note({n, -1, 0});  // only the first counts
    }
  };
  noted(0, 4);
  noted(2, 6);
  noted(8, 11);  // eleven voxels: the first step goes
  EXPECT_EQ(log.steps(), 2);
  log.begin_step();
  log.begin_step();  // nothing was noted since
  EXPECT_EQ(log.steps(), 3);
  log.end_step();
  EXPECT_EQ(log.steps(), 2);
  std::vector<std::uint32_t> taken;
  for (bool last = false; !last;) {
    const drill::UndoLog::Part part = log.take(2);
    for (std::size_t n = 0; n < part.count; ++n) {
      taken.push_back(part.first[n].at);
      EXPECT_EQ(part.first[n].raw, std::int16_t(part.first[n].at));
    }
    last = part.last;
  }
  std::sort(taken.begin(), taken.end());
  EXPECT_EQ(taken, (std::vector<std::uint32_t>{8, 9, 10}));
  EXPECT_EQ(log.steps(), 1);
  noted(20, 40);  // more than there is room for
  EXPECT_EQ(log.steps(), 0);
  noted(50, 53);
  EXPECT_EQ(log.steps(), 1);
  drill::UndoLog none(100, 0, 10);
  none.begin_step();
  none.note({3, 3, 0});
  EXPECT_EQ(none.steps(), 0);
}
