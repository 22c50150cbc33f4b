// SPDX-License-Identifier: GPL-3.0-or-later
// How wide a craniotome of an elliptical cylinder cuts, in voxels as coarse as it is thin, wherever it stands in them.
#include <gtest/gtest.h>

#include "drill_scene.h"
#include "voxel/decode.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

struct Width {
  double mean_ratio = 0, min_ratio = 1e9, max_ratio = 0;  ///< of the hole to the cutter's, across its thin side
};

// Plunged into the block at random places and turns; the hole is where less than half of bone is felt.
Width width_of(double semi_a_mm, double semi_b_mm, double voxel_mm) {
  std::mt19937_64 rng(7);
  Width out;
  constexpr int holes = 12;
  for (int n = 0; n < holes; ++n) {
    voxel::HapticVolume volume = full(int(14 / voxel_mm), voxel_mm);
    drill::Cutter c;
    c.kind = drill::Cutter::Kind::cylinder;
    c.semi_a_mm = semi_a_mm;
    c.semi_b_mm = semi_b_mm;
    c.height_mm = 6;
    drill::DrillParams law;
    law.power_w = 1000;
    law.max_rate_per_s = 10000;
    drill::Drill d(volume, only(1, 0.1), c, law);
    drill::ToolPose pose;
    const double turn = uniform(rng, 0, M_PI);
    const Mat3 frame = volume.voxels.direction;
    pose.frame.column[0] = frame.column[0] * std::cos(turn) + frame.column[1] * std::sin(turn);
    pose.frame.column[1] = frame.column[1] * std::cos(turn) - frame.column[0] * std::sin(turn);
    pose.frame.column[2] = frame.column[2];
    const Vec3 middle_mm =
        middle(volume) + Vec3{uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5)};
    pose.tip_mm = middle_mm - pose.frame.column[2] * 3;
    for (int tick = 0; tick < 60; ++tick) cut(d, pose, 0.001);
    const voxel::HapticDecoder decoder(volume);
    double width = 0;
    constexpr double step = 0.02;
    for (double at = -3; at < 3; at += step)
      width += decoder.trilinear(1, middle_mm + pose.frame.column[1] * at) < 0.5 ? step : 0;
    const double ratio = width / (2 * semi_b_mm);
    out.mean_ratio += ratio / holes;
    out.min_ratio = std::min(out.min_ratio, ratio);
    out.max_ratio = std::max(out.max_ratio, ratio);
  }
  std::printf("  %.2f x %.2f mm, voxels of %.1f mm: %.2f of the width, %.2f to %.2f\n", 2 * semi_a_mm, 2 * semi_b_mm,
              voxel_mm, out.mean_ratio, out.min_ratio, out.max_ratio);
  return out;
}

}  // namespace

TEST(DrillEllipse, CutsAsWideAsItIs) {
  for (const double voxel_mm : {0.4, 0.8})
    for (const double semi_b_mm : {1.15, 0.8, 0.575, 0.4}) {
      const Width is = width_of(1.15, semi_b_mm, voxel_mm);
      // What is thinner than a voxel and a half cannot be held everywhere by voxels that are half full.
      const bool held = 2 * semi_b_mm > 1.4 * voxel_mm;
      EXPECT_NEAR(is.mean_ratio, 1, held ? 0.1 : 0.4);
      if (held) {
        EXPECT_GT(is.min_ratio, 0.85);
      }
    }
}
