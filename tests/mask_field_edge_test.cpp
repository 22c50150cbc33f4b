// SPDX-License-Identifier: GPL-3.0-or-later
// Where the scanned field ends within a body, on a ball of tissue in noisy air whose place is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/parallel.h"
#include "mask/field_edge.h"

namespace trephine::mask {
namespace {

constexpr double ball_mm = 40;

/// A ball of water in air, blurred by about a voxel, with noise of about 10 HU; `padding_hu` where `is_padding`.
grid::Grid<std::int16_t> scan(const std::function<bool(Vec3)>& is_padding, std::int16_t padding_hu = -1000,
                              bool clipped = false) {
  grid::Grid<std::int16_t> v;
  v.size = {110, 110, 60};
  v.spacing_mm = {1, 1, 2};
  v.origin_mm = {-54.5, -54.5, -59};
  unsigned state = 7;
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const Vec3 p = v.to_world_mm({double(i), double(j), double(k)});
        const double tissue = 1 / (1 + std::exp(3 * (norm(p) - ball_mm)));
        state = state * 1664525u + 1013904223u;
        const double hu = -1000 + 1040 * tissue + (double(state >> 16 & 0xff) / 255 - 0.5) * 35;
        v.voxels.push_back(is_padding(p) ? padding_hu : std::int16_t(std::lround(clipped ? std::max(hu, -960.0) : hu)));
      }
  return v;
}
bool nowhere(Vec3) { return false; }

/// Of the tissue found: how far, at most, it lies from where `depth_mm` is 0.
double farthest_mm(const FieldEdge& edge, const std::function<double(Vec3)>& depth_mm) {
  const grid::Lattice& l = edge.tissue.lattice();
  double most = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (edge.tissue.get(i, j, k))
          most = std::max(most, std::abs(depth_mm(l.to_world_mm({double(i), double(j), double(k)}))));
  return most;
}

TEST(FieldEdge, ARoundFieldThatCutsTheBody) {
  // The circle's middle lies 20 mm to the left, so that it cuts one side of the ball and leaves air at the other.
  const auto depth = [](Vec3 p) { return 50 - std::hypot(p.x - 20, p.y); };
  const auto v = scan([&](Vec3 p) { return depth(p) < 0; });
  const FieldEdge edge = field_edge(HuView(grid::HuVolume(v)));
  EXPECT_GT(edge.tissue.count(), 800u);
  EXPECT_LT(farthest_mm(edge, depth), 1.5);
  EXPECT_FALSE(edge.padding.get(55, 55, 30));
  EXPECT_TRUE(edge.padding.get(0, 0, 0));
}

TEST(FieldEdge, AnObliqueSideOfABlock) {
  const Vec3 out = normalized(Vec3{0.2, 0.1, -1});
  const auto depth = [&](Vec3 p) { return 25 - dot(p, out); };
  for (const std::int16_t padding_hu : {-1000, -1024, -2000}) {
    const auto v = scan([&](Vec3 p) { return depth(p) < 0; }, padding_hu);
    const FieldEdge edge = field_edge(HuView(grid::HuVolume(v)));
    // A disc of 31 mm has 3,040 mm2; a voxel has 1 mm2 below.
    EXPECT_NEAR(double(edge.tissue.count()), 3040, 300) << padding_hu;
    EXPECT_LT(farthest_mm(edge, depth), 2.5) << padding_hu;
  }
}

TEST(FieldEdge, NoneWithoutPaddingOrWherePaddingLiesApart) {
  EXPECT_FALSE(field_edge(HuView(grid::HuVolume(scan(nowhere)))).tissue.any());
  const auto apart = scan([](Vec3 p) { return std::hypot(p.x, p.y) > 50; });
  const FieldEdge edge = field_edge(HuView(grid::HuVolume(apart)));
  EXPECT_FALSE(edge.tissue.any());
}

TEST(FieldEdge, NoneWhereAllAirHasOneValue) {
  const FieldEdge edge = field_edge(HuView(grid::HuVolume(scan(nowhere, -1000, true))));
  EXPECT_FALSE(edge.padding.any());
  EXPECT_FALSE(edge.tissue.any());
  // Even where the body's surface has no voxel of mixed values.
  auto sharp = scan(nowhere, -1000, true);
  for (auto& hu : sharp.voxels) hu = hu < -500 ? -1000 : hu;
  EXPECT_FALSE(field_edge(HuView(grid::HuVolume(sharp))).tissue.any());
}

TEST(FieldEdge, NoneWhereAirWasClippedAndApparatusTakenOff) {
  // What stands in the place of apparatus (-1000 and -999 in turn) and foam that no side cuts are no measured air.
  auto clipped = scan(nowhere, -1000, true);
  for (int k = 0; k < clipped.size[2]; ++k)
    for (int j = 0; j < clipped.size[1]; ++j)
      for (int i = 0; i < clipped.size[0]; ++i) {
        auto& hu = clipped.at(i, j, k);
        if (hu < -500) hu = -1000;
        if (j > 98) hu = std::int16_t(-1000 + ((i + j + k) & 1));
        if (j < 12 && j > 4 && i > 30 && i < 80 && k > 4 && k < 55) hu = std::int16_t(-900 + (i * 7 + k) % 60);
      }
  const FieldEdge edge = field_edge(HuView(grid::HuVolume(clipped)));
  EXPECT_FALSE(edge.tissue.any()) << edge.tissue.count();
}

TEST(FieldEdge, OfRealNumbers) {
  const auto v = scan([](Vec3 p) { return std::hypot(p.x - 20, p.y) > 50; });
  grid::Grid<float> f{grid::Lattice(v), 0.f};
  std::copy(v.voxels.begin(), v.voxels.end(), f.voxels.begin());
  const FieldEdge one = field_edge(HuView(grid::HuVolume(v))), other = field_edge(HuView(grid::HuVolume(f)));
  EXPECT_GT(one.tissue.count(), 800u);
  EXPECT_EQ(one.tissue.count(), other.tissue.count());
}

TEST(FieldEdge, TheSameWithOneAndFourThreads) {
  const grid::HuVolume v = scan([](Vec3 p) { return std::hypot(p.x - 20, p.y) > 50; });
  set_thread_count(1);
  const FieldEdge one = field_edge(HuView(v));
  set_thread_count(4);
  const FieldEdge four = field_edge(HuView(v));
  set_thread_count(0);
  EXPECT_EQ(one.tissue.count(), four.tissue.count());
  EXPECT_FALSE(without(one.tissue, four.tissue).any());
  EXPECT_EQ(one.padding.count(), four.padding.count());
  EXPECT_FALSE(without(one.padding, four.padding).any());
}

}  // namespace
}  // namespace trephine::mask
