// SPDX-License-Identifier: GPL-3.0-or-later
// Bit masks and filters against their definitions, computed the slow way.
#include <gtest/gtest.h>

#include <cmath>

#include "mask/bits.h"
#include "mask/filters.h"
#include "mask/hu_view.h"

namespace trephine::segmentation {
namespace {

grid::Lattice anisotropic(int nx, int ny, int nz) {
  grid::Lattice l;
  l.size = {nx, ny, nz};
  l.spacing_mm = {0.5, 0.7, 1.25};
  l.origin_mm = {-10, 20, 5};
  return l;
}

/// A fixed scatter of voxels, about one in `one_in`.
mask::BitMask scatter(const grid::Lattice& l, unsigned one_in, unsigned state = 1) {
  mask::BitMask m(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        state = state * 1664525u + 1013904223u;
        if ((state >> 8) % one_in == 0) m.set(i, j, k);
      }
  return m;
}

template <class F>
void for_voxels(const grid::Lattice& l, F&& f) {
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) f(i, j, k);
}

double distance_by_search(const mask::BitMask& m, int i, int j, int k) {
  const Vec3 s = m.lattice().spacing_mm;
  double best = 1e6;
  for_voxels(m.lattice(), [&](int x, int y, int z) {
    if (m.get(x, y, z)) best = std::min(best, norm({(x - i) * s.x, (y - j) * s.y, (z - k) * s.z}));
  });
  return best;
}

TEST(SegmentationBits, DilationIsABallInMillimetres) {
  const grid::Lattice l = anisotropic(70, 15, 9);  // rows longer than a word
  const mask::BitMask m = scatter(l, 900);
  ASSERT_GT(m.count(), 3u);
  for (double radius : {0.4, 0.5, 1.3, 2.6}) {
    const mask::BitMask d = mask::dilated(m, radius);
    for_voxels(l, [&](int i, int j, int k) {
      ASSERT_EQ(d.get(i, j, k), distance_by_search(m, i, j, k) <= radius + 1e-6)
          << radius << " " << i << " " << j << " " << k;
    });
  }
}

// Rows that are empty or full are told from the others beforehand.
TEST(SegmentationBits, DilationOfEmptyFullAndMixedRows) {
  const grid::Lattice l = anisotropic(70, 12, 10);
  mask::BitMask m = scatter(l, 500);
  for_voxels(l, [&](int i, int j, int k) {
    if (k >= 3 && k <= 6) m.clear(i, j, k);
    if ((j == 2 && k == 4) || (j >= 9 && k >= 8) || (j == 7 && k == 5 && i < 64)) m.set(i, j, k);
  });
  m.clear(69, 11, 9);  // full but for its last voxel
  for (double radius : {0.4, 1.3, 2.6}) {
    const mask::BitMask d = mask::dilated(m, radius);
    for_voxels(l, [&](int i, int j, int k) {
      ASSERT_EQ(d.get(i, j, k), distance_by_search(m, i, j, k) <= radius + 1e-6)
          << radius << " " << i << " " << j << " " << k;
    });
    mask::BitMask beyond = d;
    EXPECT_EQ(beyond.invert().count(), l.count() - d.count());  // no bits lie beyond the rows' ends
  }
}

TEST(SegmentationBits, ErosionKeepsWhatTheEdgeCuts) {
  const grid::Lattice l = anisotropic(40, 12, 8);
  mask::BitMask m(l);
  for_voxels(l, [&](int i, int j, int k) {
    if (i < 20) m.set(i, j, k);
  });
  const mask::BitMask e = mask::eroded(m, 1.0);
  for_voxels(l, [&](int i, int j, int k) { ASSERT_EQ(e.get(i, j, k), i < 18) << i << " " << j << " " << k; });
}

TEST(SegmentationBits, ClosingBridgesGapsButNotToTheEdge) {
  const grid::Lattice l = anisotropic(80, 9, 9);
  mask::BitMask m(l);
  for_voxels(l, [&](int i, int j, int k) {
    if ((i >= 10 && i < 20) || (i >= 24 && i < 30) || (i >= 40 && i < 78)) m.set(i, j, k);
  });
  const mask::BitMask c =
      mask::closed(m, 1.2);  // closes 2.0 mm between 20 and 24, not the 5 mm, nor the last mm to the volume's edge
  for (int i = 0; i < 80; ++i) EXPECT_EQ(c.get(i, 4, 4), (i >= 10 && i < 30) || (i >= 40 && i < 78)) << i;
}

TEST(SegmentationBits, ComponentsByFacesAndByCorners) {
  mask::BitMask m(anisotropic(130, 4, 4));
  m.set(0, 0, 0);
  m.set(1, 1, 0);                                 // by an edge
  m.set(2, 2, 1);                                 // by a corner
  for (int i = 60; i < 130; ++i) m.set(i, 3, 3);  // across words
  const mask::Components faces = mask::components(m), corners = mask::components(m, true);
  ASSERT_EQ(faces.list.size(), 4u);
  ASSERT_EQ(corners.list.size(), 2u);
  EXPECT_EQ(corners.list[0].voxels, 3u);
  EXPECT_EQ(corners.list[1].voxels, 70u);
  EXPECT_EQ(corners.list[1].faces, 3);
  EXPECT_EQ(mask::largest(faces).count(), 70u);
  EXPECT_EQ(mask::select(corners, {1, 0}).count(), 3u);
  EXPECT_EQ(m.bounds().end[0], 130);
  const double ml = 3 * m.lattice().voxel_volume_mm3() / 1000;
  EXPECT_EQ(mask::at_least_ml(corners, ml).count(), 73u);
  EXPECT_EQ(mask::at_least_ml(corners, 1.01 * ml).count(), 70u);
}

TEST(SegmentationBits, CentreIsTheMeanOfTheSetVoxels) {
  const grid::Lattice l = anisotropic(130, 9, 7);
  const mask::BitMask m = scatter(l, 3, 11);
  Vec3 sum;
  for_voxels(l, [&](int i, int j, int k) {
    if (m.get(i, j, k)) sum += l.to_world_mm({double(i), double(j), double(k)});
  });
  EXPECT_LT(norm(m.centre_mm() - sum / double(m.count())), 1e-9);
  EXPECT_LT(norm(mask::BitMask(l).centre_mm() - l.origin_mm), 1e-9);
}

TEST(SegmentationBits, ComponentsOfNoiseAgreeWithAFloodFill) {
  const grid::Lattice l = anisotropic(67, 11, 7);
  const mask::BitMask m = scatter(l, 2, 7);
  grid::Grid<std::uint8_t> seen(l);
  std::size_t pieces = 0;
  for_voxels(l, [&](int i, int j, int k) {
    if (!m.get(i, j, k) || seen.at(i, j, k)) return;
    ++pieces;
    std::vector<std::array<int, 3>> todo{{i, j, k}};
    seen.at(i, j, k) = 1;
    while (!todo.empty()) {
      const auto [x, y, z] = todo.back();
      todo.pop_back();
      for (int a = 0; a < 6; ++a) {
        const int n[3] = {x + (a == 0) - (a == 1), y + (a == 2) - (a == 3), z + (a == 4) - (a == 5)};
        if (!m.at(n[0], n[1], n[2]) || seen.at(n[0], n[1], n[2])) continue;
        seen.at(n[0], n[1], n[2]) = 1;
        todo.push_back({n[0], n[1], n[2]});
      }
    }
  });
  EXPECT_EQ(mask::components(m).list.size(), pieces);
}

TEST(SegmentationBits, DistanceIsExact) {
  const grid::Lattice few = anisotropic(23, 17, 9), long_rows = anisotropic(70, 7, 5);
  for (const mask::BitMask& m : {scatter(few, 300), scatter(long_rows, 12)}) {
    const grid::Grid<float> d = mask::distance_mm(m);
    for_voxels(m.lattice(),
               [&](int i, int j, int k) { ASSERT_NEAR(d.at(i, j, k), distance_by_search(m, i, j, k), 1e-4); });
  }
  EXPECT_GT(mask::distance_mm(mask::BitMask(few)).voxels[0], 1e5);
}

// Also where the threshold lies between two floats, and in the last voxels of a row.
TEST(SegmentationBits, ThresholdsAreExact) {
  const grid::Lattice l = anisotropic(131, 2, 2);
  grid::Grid<std::int16_t> whole(l);
  grid::Grid<float> parts(l);
  const float about[3] = {std::nextafter(0.1f, 0.f), 0.1f, std::nextafter(0.1f, 1.f)};
  for (std::size_t v = 0; v < whole.voxels.size(); ++v) {
    whole.voxels[v] = std::int16_t(int(v % 7) - 3);
    parts.voxels[v] = about[v % 3];
  }
  for (const grid::HuVolume& volume : {grid::HuVolume(whole), grid::HuVolume(parts)})
    for (const double threshold : {-1.5, -1.0, 0.0, 0.1, double(0.1f), 2.0}) {
      const mask::HuView hu(volume);
      const mask::BitMask found = mask::above(hu, threshold);
      for_voxels(l, [&](int i, int j, int k) {
        ASSERT_EQ(found.get(i, j, k), double(hu(i, j, k)) > threshold) << threshold << " " << i;
      });
    }
}

TEST(SegmentationBits, GaussianKeepsTheSumAndHasItsWidth) {
  grid::Lattice l = anisotropic(81, 61, 41);
  grid::Grid<float> g(l);
  g.at(40, 30, 20) = 1000;
  mask::gaussian(g, 2.0);
  double sum = 0, x2 = 0, z2 = 0;
  for_voxels(l, [&](int i, int j, int k) {
    sum += g.at(i, j, k);
    x2 += g.at(i, j, k) * std::pow((i - 40) * 0.5, 2);
    z2 += g.at(i, j, k) * std::pow((k - 20) * 1.25, 2);
  });
  EXPECT_NEAR(sum, 1000, 1);
  EXPECT_NEAR(std::sqrt(x2 / sum), 2.0, 0.05);
  EXPECT_NEAR(std::sqrt(z2 / sum), 2.0, 0.1);  // the voxel's own width adds a little
}

TEST(SegmentationBits, MaskedGaussianDoesNotLetBoneBleedIn) {
  const grid::Lattice l = anisotropic(40, 20, 12);
  grid::Grid<float> v(l, 30);
  mask::BitMask soft(l);
  for_voxels(l, [&](int i, int j, int k) {
    if (i >= 20)
      v.at(i, j, k) = 1400;
    else
      soft.set(i, j, k);
  });
  const grid::Grid<float> s = mask::masked_gaussian(v, soft, 1.0, -1000);
  EXPECT_NEAR(s.at(19, 10, 6), 30, 1e-3);
  EXPECT_NEAR(s.at(21, 10, 6), 30, 1e-3);
  EXPECT_EQ(s.at(39, 10, 6), -1000);
}

TEST(SegmentationBits, FloodPartsAtTheNarrowestPlace) {
  // Two chambers joined by a channel that is narrowest at i = 30.
  grid::Lattice l;
  l.size = {60, 21, 21};
  mask::BitMask space(l);
  for_voxels(l, [&](int i, int j, int k) {
    const double half = std::min(9.0, 2.0 + 0.4 * std::abs(i - 30));
    if (std::hypot(j - 10, k - 10) <= half) space.set(i, j, k);
  });
  mask::BitMask wall = space;
  wall.invert();
  grid::Mask seeds(l);
  seeds.at(2, 10, 10) = 1;
  seeds.at(57, 10, 10) = 2;
  const grid::Mask labels = mask::flood(mask::distance_mm(wall), space, seeds);
  for_voxels(l, [&](int i, int j, int k) {
    const int label = labels.at(i, j, k);
    if (!space.get(i, j, k)) {
      ASSERT_EQ(label, 0);
    } else if (i <= 27 || i >= 33) {
      ASSERT_EQ(label, i <= 27 ? 1 : 2) << i;
    }
  });
}

TEST(SegmentationBits, HolesWithNarrowAndWideWaysOut) {
  // A block with three chambers: closed; open by a channel of 2 mm; open by a channel of 8 mm.
  grid::Lattice l;
  l.size = {90, 40, 40};
  mask::BitMask m(l);
  for_voxels(l, [&](int i, int j, int k) {
    if (i < 5 || i >= 85 || j < 5 || j >= 35 || k < 5 || k >= 35) return;
    for (int c : {18, 45, 72}) {
      if (std::abs(i - c) < 8 && std::abs(j - 20) < 8 && std::abs(k - 20) < 8) return;
      const int half = c == 18 ? 0 : c == 45 ? 1 : 4;
      if (j < 20 && std::abs(i - c) < half && std::abs(k - 20) < half) return;
    }
    m.set(i, j, k);
  });
  const mask::BitMask simple = mask::holes(m, {0, 1000, false}), closing = mask::holes(m, {2, 1000, false});
  EXPECT_TRUE(simple.get(18, 20, 20));
  EXPECT_FALSE(simple.get(45, 20, 20));
  EXPECT_TRUE(closing.get(18, 20, 20));
  EXPECT_TRUE(closing.get(45, 20, 20));
  EXPECT_FALSE(closing.get(45, 5, 20)) << "the mouth stays open as deep as the closing";
  EXPECT_FALSE(closing.get(72, 20, 20));
  EXPECT_FALSE(mask::holes(m, {0, 3, false}).get(18, 20, 20)) << "larger than 3 ml";
  // Cut open by one face of the volume.
  const mask::BitMask half = mask::crop(m, {{0, 0, 20}, {90, 40, 40}});
  EXPECT_FALSE(mask::holes(half, {0, 1000, false}).get(18, 20, 0));
  EXPECT_TRUE(mask::holes(half, {0, 1000, true}).get(18, 20, 0));
}

}  // namespace
}  // namespace trephine::segmentation
