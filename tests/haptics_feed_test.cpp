// SPDX-License-Identifier: GPL-3.0-or-later
// How a drill answers the hand: the harder it is pressed the faster it feeds, and it never stops without saying why.
#include <gtest/gtest.h>

#include "haptics_feed.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

constexpr double forces_n[] = {0.1, 0.25, 0.5, 1, 2, 3, 5};

// What the power that the force allows removes, by the hole's area: the law of removal without voxels.
double lawful_mm_per_s(const FeedRun& run, double energy_j_per_mm3) {
  const double radius = 0.5 * run.diameter_mm;
  const double rim_m_per_s = run.drilling.spindle_rpm / 60 * 2 * M_PI * radius / 1000;
  const double power_w = std::min(run.law.power_w, run.force_n * rim_m_per_s / run.drilling.reaction_ratio);
  return power_w / energy_j_per_mm3 / (M_PI * radius * radius);
}

}  // namespace

TEST(HapticsFeed, GrowsWithTheForce) {
  for (const double diameter_mm : {3.0, 5.0})
    for (const double voxel_mm : {0.5, 0.8}) {
      double most = 0;
      for (const double force_n : forces_n) {
        FeedRun run;
        run.diameter_mm = diameter_mm;
        run.voxel_mm = voxel_mm;
        run.force_n = force_n;
        const Feed is = feed_of(run);
        SCOPED_TRACE(testing::Message() << diameter_mm << " mm, voxels " << voxel_mm << ", " << force_n << " N");
        std::printf("  %g mm, voxels %g, %g N: %.1f mm/s, stalled %.3f s\n", diameter_mm, voxel_mm, force_n,
                    is.feed_mm_per_s, is.stalled_s);
        EXPECT_GT(is.depth_mm, 2);
        EXPECT_GT(is.late_mm, 0.2) << "it stopped";
        EXPECT_LT(is.stalled_s, 1e-9) << "not even where a hand of 5 N lands";
        // Of a ball of fewer than four voxels 0.89 was measured.
        EXPECT_GT(is.feed_mm_per_s, (diameter_mm < 4 * voxel_mm ? 0.85 : 0.9) * most) << "less than with less force";
        // The hand's own damping takes some of a small force.
        EXPECT_GT(is.feed_mm_per_s, 0.45 * lawful_mm_per_s(run, 0.1));
        EXPECT_LT(is.feed_mm_per_s, 1.1 * lawful_mm_per_s(run, 0.1));
        EXPECT_LT(is.max_step_n, 0.2) << "of the force, from tick to tick";
        most = std::max(most, is.feed_mm_per_s);
      }
    }
}

// In a narrow hole of coarse voxels the tool goes on within one tick between the walls that hold it, and what holds it
// is cut there and not all around.
TEST(HapticsFeed, OfAMatchstickInCoarseVoxels) {
  double most = 0;
  for (const double force_n : {1.0, 3.0, 5.0}) {
    FeedRun run;
    run.kind = "matchstick";
    run.voxel_mm = 1;
    run.force_n = force_n;
    const Feed is = feed_of(run);
    const double radius = 0.5 * run.diameter_mm, swept_mm3 = M_PI * radius * radius * (is.depth_mm - radius) +
                                                             2.0 / 3 * M_PI * radius * radius * radius;
    std::printf("  %g N: %.1f mm/s, %.2f of the tool's way\n", force_n, is.feed_mm_per_s, is.removed_mm3 / swept_mm3);
    EXPECT_GT(is.feed_mm_per_s, 0.9 * most) << force_n << " N";
    EXPECT_LT(is.removed_mm3 / swept_mm3, 1.2) << force_n << " N";
    most = std::max(most, is.feed_mm_per_s);
  }
}

TEST(HapticsFeed, AStallIsReported) {
  FeedRun run;
  run.drilling.stall_force_n = 2;
  run.force_n = 3;
  run.seconds = 1;
  const Feed is = feed_of(run);
  EXPECT_GT(is.stalled_s, 0.5);
  EXPECT_LT(is.depth_mm, 1);
}

// docs/validation/drilling.md has this table. Forces ascend, so `least` is how much of the largest feed of a smaller
// force is left: 0.9 at least; less where the hand lands aslant, slides off and mills its way back.
TEST(LongHapticsFeed, OfEveryToolVoxelAndForce) {
  struct Row {
    const char* kind;
    double tilt_deg, tremor_mm;
  };
  for (const Row& row :
       {Row{"ball", 0, 0}, Row{"ball", 0, 0.3}, Row{"ball", 30, 0.3}, Row{"ball", 60, 0.3}, Row{"round_burr", 0, 0},
        Row{"burr", 0, 0}, Row{"matchstick", 0, 0}, Row{"cylinder", 0, 0}, Row{"craniotome", 0, 0}})
    for (const double diameter_mm : {2.0, 3.0, 5.0, 7.0, 14.0})
      for (const double voxel_mm : {0.3, 0.5, 0.8, 1.0}) {
        if (diameter_mm >= 14 && (row.tilt_deg > 0 || std::string(row.kind) != "ball")) continue;
        std::printf(
            "%s %.0f degrees, tremor %.1f mm, %.0f mm in voxels of %.1f mm, mm/s and (mm after 0.25, 0.5, 1, 2 s):",
            row.kind, row.tilt_deg, row.tremor_mm, diameter_mm, voxel_mm);
        double most = 0, least = 1, step_n = 0;
        for (const double force_n : forces_n) {
          FeedRun run;
          run.kind = row.kind;
          run.diameter_mm = diameter_mm;
          run.voxel_mm = voxel_mm;
          run.force_n = force_n;
          run.tilt_deg = row.tilt_deg;
          run.tremor_mm = row.tremor_mm;
          if (diameter_mm >= 14) run.max_depth_mm = 4;
          const Feed is = feed_of(run);
          const double* at = is.depth_after_mm;
          std::printf(" %.1f (%.1f %.1f %.1f %.1f)%s", is.feed_mm_per_s, at[0], at[1], at[2], at[3],
                      is.late_mm > 0.05 ? "" : " stopped");
          if (row.tilt_deg > 45 && force_n >= 3) continue;  // such a hand slips over the surface
          EXPECT_GT(is.late_mm, 0.05) << "it stopped at " << is.depth_mm << " mm with " << force_n << " N";
          EXPECT_LT(is.stalled_s, force_n < 5 ? 1e-9 : 0.05);
          EXPECT_GT(is.feed_mm_per_s, (row.tilt_deg > 0 ? 0.8 : 0.9) * most) << force_n << " N";
          if (most > 0) least = std::min(least, is.feed_mm_per_s / most);
          most = std::max(most, is.feed_mm_per_s);
          step_n = std::max(step_n, is.max_step_n);
          if (is.stalled_s > 0) std::printf(" stalled %.3f s", is.stalled_s);
        }
        std::printf("; least %.2f, force steps at most %.3f N\n", least, step_n);
        std::fflush(stdout);
      }
}
