// SPDX-License-Identifier: GPL-3.0-or-later
// A head that moved while it was scanned: the step of its skull between two slices.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "mask/motion.h"
#include "mask/scan_verdict.h"
#include "report_of.h"

using namespace trephine;

namespace {

struct Scan {
  double slice_mm = 2, step_z_mm = 70, left_mm = 0, back_mm = 0;
  double back_by_slice = 0.2;  // the whole head is inclined
  int only_slice = -1;         // this slice alone is moved
  bool upside_down = false;    // the slices are stored from the top
};

// A skull of 7 mm around an ellipsoid of 70, 90 and 80 mm, in air, seen from 20 to 130 mm of its height.
grid::HuVolume head_of(const Scan& is) {
  grid::Grid<std::int16_t> g;
  g.size = {120, 130, int(110 / is.slice_mm)};
  g.spacing_mm = {2, 2, is.slice_mm};
  g.origin_mm = {-120, -130, 20};
  if (is.upside_down) {
    g.direction.column[1].y = -1;
    g.direction.column[2].z = -1;
    g.origin_mm = {-120, 130, 20 + (g.size[2] - 1) * is.slice_mm};
  }
  g.voxels.assign(std::size_t(g.size[0]) * g.size[1] * g.size[2], -1000);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
        if (is.only_slice >= 0 ? k == is.only_slice : p.z > is.step_z_mm) p = p - Vec3{is.left_mm, is.back_mm, 0};
        p.y -= is.back_by_slice * (p.z - 60);
        const double inner = std::hypot(p.x / 70, p.y / 90, (p.z - 60) / 80);
        const double outer = std::hypot(p.x / 77, p.y / 97, (p.z - 60) / 87);
        g.voxels[g.index(i, j, k)] = inner < 1 ? 35 : outer < 1 ? 1100 : -1000;
      }
  return g;
}

}  // namespace

TEST(Motion, AStepOfTheHeadIsSeenWithItsPlaceAndDirection) {
  for (const bool upside_down : {false, true})
    for (const double slice : {1.0, 2.0, 3.0}) {
      const auto m = mask::find_motion(head_of({slice, 70.5, 4, -3, 0.2, -1, upside_down}));
      ASSERT_TRUE(m) << slice << upside_down;
      EXPECT_NEAR(m->by_mm.x, 4, 0.7) << slice << upside_down;
      EXPECT_NEAR(m->by_mm.y, -3, 0.7) << slice << upside_down;
      EXPECT_NEAR(m->by_mm.z, 0, 1e-9);
      EXPECT_NEAR(m->at_mm.z, 70.5, 1.5 * slice) << upside_down;
    }
}

TEST(Motion, NothingIsSaidOfAHeadThatLiesStill) {
  EXPECT_FALSE(mask::find_motion(head_of({}))) << "inclined";
  EXPECT_FALSE(mask::find_motion(head_of({2, 70, 0, 0, 0.9}))) << "more inclined";
  EXPECT_FALSE(mask::find_motion(head_of({2, 70, 0.7, 0}))) << "less than what is sure";
  EXPECT_FALSE(mask::find_motion(head_of({2, 70, 6, 0, 0.2, 25}))) << "one slice that is wrong is no motion";
  EXPECT_FALSE(mask::find_motion(head_of({4, 70, 6, 0}))) << "slices too far apart";
}

TEST(Motion, IsSaidByTheVerdictOnAScan) {
  Report moved, still;
  value_of(moved, mask::judge_scan(head_of({2, 70, 4, -3}), {}));
  ASSERT_NE(moved.find("motion_mm"), nullptr);
  EXPECT_NEAR(std::get<double>(*moved.find("motion_mm")), 5, 0.8);
  for (const char* name : {"skin", "skull", "brain"})
    EXPECT_EQ(std::get<std::string>(*moved.find(name)), "doubtful") << name;
  EXPECT_NE(std::get<std::string>(*moved.find("skull_because")).find("the head moved by"), std::string::npos);
  EXPECT_EQ(still.find("skull_because"), nullptr);
  ASSERT_FALSE(moved.warnings.empty());
  EXPECT_NE(moved.warnings.back().find("mm farther to the left"), std::string::npos) << moved.warnings.back();
  EXPECT_NE(moved.warnings.back().find("mm farther to the front"), std::string::npos) << moved.warnings.back();
  value_of(still, mask::judge_scan(head_of({2, 70, 0, 0}), {}));
  EXPECT_EQ(still.find("motion_mm"), nullptr);
}

TEST(Motion, HangsOnNoThreads) {
  const grid::HuVolume scan = head_of({2, 70, 3, 3});
  set_thread_count(1);
  const auto one = mask::find_motion(scan);
  set_thread_count(7);
  const auto many = mask::find_motion(scan);
  set_thread_count(0);
  ASSERT_TRUE(one && many);
  EXPECT_EQ(norm(one->by_mm - many->by_mm), 0);
  EXPECT_EQ(norm(one->at_mm - many->at_mm), 0);
}
