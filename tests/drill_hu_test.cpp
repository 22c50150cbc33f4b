// SPDX-License-Identifier: GPL-3.0-or-later
// A raw CT whose shapes are windows of HU: drawn where it is felt, and drilled by lowering its HU.
#include <gtest/gtest.h>

#include "drill_closed.h"
#include "drill_scene.h"
#include "voxel/cut.h"
#include "voxel/decode.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

constexpr int bone = 2, bone_low = 227;

voxel::HapticShape window(const char* name, int number, int low, int high) {
  voxel::HapticShape s;
  s.name = name;
  s.number = number;
  s.window_low = std::int16_t(low);
  s.window_high = std::int16_t(high);
  return s;
}

voxel::HapticVolume raw(int n, double spacing_mm, bool soft, int hu) {
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  v.voxels = grid::Grid<std::int16_t>(lattice(n, spacing_mm), std::int16_t(hu));
  if (soft) v.shapes.push_back(window("soft", 1, -200, bone_low - 1));
  v.shapes.push_back(window("bone", bone, bone_low, 3000));
  return v;
}

/// A ball in the middle, whose HU fall over two voxels from `inside` to `outside`.
voxel::HapticVolume raw_ball(double radius_mm, bool soft, int inside, int outside) {
  voxel::HapticVolume v = raw(32, 1, soft, outside);
  const Vec3 m = middle(v);
  for (int k = 0; k < 32; ++k)
    for (int j = 0; j < 32; ++j)
      for (int i = 0; i < 32; ++i) {
        const double depth = radius_mm - norm(v.voxels.to_world_mm({double(i), double(j), double(k)}) - m);
        v.voxels.at(i, j, k) =
            std::int16_t(std::lround(outside + (inside - outside) * std::clamp(0.5 + depth / 2, 0.0, 1.0)));
      }
  return v;
}

/// The distances of the drawn surface's corners from the middle.
std::vector<double> radii(const voxel::HapticVolume& v, const drill::LiveSurface& s) {
  std::vector<double> all;
  const grid::Lattice& l = v.voxels;
  for (std::size_t n = 0; n < s.layout().count(); ++n)
    for (const drill::LiveVertex& x : s.brick(n).vertices)
      all.push_back(
          norm(l.origin_mm + l.direction * Vec3{x.position_mm[0], x.position_mm[1], x.position_mm[2]} - middle(v)));
  return all;
}

}  // namespace

TEST(DrawnHu, ABallLiesWhereItsHuCrossTheThreshold) {
  for (const int inside : {1200, 2200}) {
    const voxel::HapticVolume v = raw_ball(9.3, false, inside, -1000);
    const drill::LiveSurface s(v, bone);
    const double radius = 9.3 + 2 * (0.5 - (bone_low + 1000.0) / (inside + 1000.0));
    const std::vector<double> drawn = radii(v, s);
    ASSERT_GT(drawn.size(), 500u);
    for (const double r : drawn) ASSERT_NEAR(r, radius, 0.1) << inside;
    const Closed closed = look_at(s);
    EXPECT_EQ(closed.open, 0u);
    EXPECT_NEAR(closed.volume_mm3, 4 * 3.14159265 / 3 * radius * radius * radius, 0.02 * closed.volume_mm3);
  }
}

// What the lattice cuts is drawn as far out as it is felt, where -1024 HU follow.
TEST(DrawnHu, TheLatticesBorderIsDrawnWhereItIsFelt) {
  voxel::HapticVolume v = raw_ball(100, true, 50, 50);
  const drill::LiveSurface s(v, 1);
  double most = -1;
  for (const drill::LiveVertex& x : s.brick(s.layout().count() - 1).vertices)
    most = std::max(most, double(x.position_mm[0]) / v.voxels.spacing_mm.x);
  const double low = v.shapes.front().number == 1 ? v.shapes.front().window_low : v.shapes.back().window_low;
  EXPECT_NEAR(most, v.voxels.size[0] - 1 + (50 - low) / (50.0 + 1024), 0.01);
}

TEST(DrawnHu, WhereWindowsMeetItIsDrawnAsItIsFelt) {
  const voxel::HapticVolume v = raw_ball(9.3, true, 1200, 40);
  const voxel::HapticDecoder felt(v);
  for (const int number : {1, bone}) {
    const drill::LiveSurface s(v, number);
    const grid::Lattice& l = v.voxels;
    std::size_t seen = 0, far = 0;
    for (std::size_t n = 0; n < s.layout().count(); ++n)
      for (const drill::LiveVertex& x : s.brick(n).vertices) {
        const Vec3 at = l.origin_mm + l.direction * Vec3{x.position_mm[0], x.position_mm[1], x.position_mm[2]};
        if (norm(at - middle(v)) > 13) continue;  // the border of the lattice
        const Vec3 out = l.direction * Vec3{x.normal[0], x.normal[1], x.normal[2]};
        ++seen;
        far += !(felt.trilinear(number, at - out * 0.05) > 0.5) || felt.trilinear(number, at + out * 0.05) > 0.5;
      }
    ASSERT_GT(seen, 500u);
    EXPECT_LT(double(far), 0.02 * double(seen)) << number;
    EXPECT_EQ(look_at(s).open, 0u);
  }
}

TEST(DrillHu, AWayThroughRemovesWhatTheBallSweepsAndNothingTurnsIntoAnotherShape) {
  constexpr double radius = 3, energy = 0.05;
  double spent[2] = {};
  for (const int denser : {0, 1}) {
    const int hu = bone_low + 1000 * (1 + denser);
    voxel::HapticVolume v = raw(64, 0.5, true, hu);
    const voxel::HapticVolume before = v;
    drill::DirtyBricks marks(v.voxels);
    drill::DrillParams params;
    params.power_w = 500;
    drill::Drill drill(v, only(bone, energy), ball(radius), params, &marks);
    drill::LiveSurface drawn(v, bone);
    std::int64_t units = 0;
    const Vec3 m = middle(v), along = v.voxels.direction.column[2];
    constexpr double half_mm = 7, step_mm = 0.05;
    std::vector<std::size_t> marked;
    for (double t = -half_mm; t < half_mm; t += step_mm) {
      const drill::Removal& r =
          drill.cut_way(centred(m + along * t, radius), centred(m + along * (t + step_mm), radius).tip_mm, 0, 0.01);
      units += r.units[bone];
      spent[denser] += r.energy_j;
      EXPECT_EQ(r.units[1], 0);
    }
    while (drill.late()) units += drill.cut_late(0.01).units[bone];
    std::size_t soft = 0, gone = 0;
    for (const std::int16_t x : v.voxels.voxels) {
      soft += x >= -200 && x < bone_low;
      gone += x < -200;
    }
    EXPECT_EQ(soft, 0u) << "drilled bone must not turn into soft tissue";
    EXPECT_EQ(std::int64_t(gone) * voxel::haptic_full, units) << "what is told is what is gone";
    const double swept = 3.14159265 * radius * radius * (2 * half_mm + 4 * radius / 3);
    EXPECT_NEAR(mm3(v, units), swept, 0.02 * swept) << hu;
    EXPECT_NEAR(voxel::shape_volume_mm3(before, bone) - voxel::shape_volume_mm3(v, bone), mm3(v, units), 1e-6);
    // The surface follows, closed, and lies where the ball went.
    marks.take(marked);
    drawn.update(marked);
    const Closed closed = look_at(drawn);
    EXPECT_EQ(closed.open, 0u);
    const drill::LiveSurface whole(before, bone);
    EXPECT_NEAR(look_at(whole).volume_mm3 - closed.volume_mm3, swept, 0.02 * swept);
    // All of it comes back.
    ASSERT_TRUE(drill.take_all_back(before.voxels));
    while (drill.putting_back()) drill.put_back();
    EXPECT_TRUE(v.voxels.voxels == before.voxels.voxels);
  }
  EXPECT_NEAR(spent[1] / spent[0], 2.1, 0.2)
      << "twice as far above the threshold is twice the energy, and more at the border";
}
