// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/segment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/coarse.h"

namespace trephine {
namespace {

constexpr int rail = 69;

bool in_strut(int i, int j, int k) { return i >= 60 && i < rail && j >= 32 && j < 35 && k == 14; }

/// A ball of 40 HU with a cavity that a thin sheet parts, in air, a rail of 200 HU 3 mm beside it, and a strut of 1.5
/// mm between them; an oblique lattice whose sizes no cell divides.
grid::HuVolume scan() {
  grid::Lattice l;
  l.size = {91, 67, 29};
  l.spacing_mm = {0.5, 0.5, 1.2};
  l.origin_mm = {-11, 4, 100};
  const double c = std::cos(0.3), s = std::sin(0.3);
  l.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
  grid::Grid<std::int16_t> g(l, -1000);
  const Vec3 middle = l.to_world_mm({32, 33, 14});
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)}) - middle;
        if (norm(p) < 15.5) g.at(i, j, k) = 40;
        if (norm(p) < 5 && std::abs(p.x) > 0.5) g.at(i, j, k) = -900;
        if (i >= rail) g.at(i, j, k) = 200;
        if (in_strut(i, j, k)) g.at(i, j, k) = 200;
      }
  return g;
}

segmentation::SegmentParams params(double coarse_mm) {
  segmentation::SegmentParams p;
  p.lower_hu = -475;
  p.open_mm = 2;
  p.components = segmentation::SegmentComponents::largest;
  p.coarse_mm = coarse_mm;
  return p;
}

bool inside(const grid::Field& f, const grid::Box& at, int i, int j, int k) {
  const int x = i - at.begin[0], y = j - at.begin[1], z = k - at.begin[2];
  return f.contains(x, y, z) && f.at(x, y, z) > 0;
}

TEST(CoarseSegment, HoldsTheFineShapeAndNothingFurtherThanACell) {
  const grid::HuVolume volume = scan();
  const grid::Lattice& l = grid::lattice_of(volume);
  const grid::Field fine = segmentation::segment(volume, {}, params(0)).value;
  const grid::Box fine_at = grid::place_in(fine, l);
  for (const double cell_mm : {0.5, 1.0, 1.5, 2.0}) {
    const grid::Field coarse = segmentation::segment(volume, {}, params(cell_mm)).value;
    const grid::Box at = grid::place_in(coarse, l);
    const int reach = static_cast<int>(cell_mm / 0.5), up = std::max(1, static_cast<int>(cell_mm / 1.2));
    int missing = 0, far = 0;
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          if (i > 60 && i < rail) continue;  // the strut is cut somewhere
          const bool has = inside(coarse, at, i, j, k);
          missing += inside(fine, fine_at, i, j, k) && !has;
          if (!has) continue;
          bool near = false;
          for (int c = -up; c <= up; ++c)
            for (int b = -reach; b <= reach; ++b)
              for (int a = -reach; a <= reach; ++a) near |= inside(fine, fine_at, i + a, j + b, k + c);
          far += !near;
        }
    EXPECT_EQ(missing, 0) << cell_mm;
    EXPECT_EQ(far, 0) << cell_mm;
  }
}

TEST(CoarseSegment, CellsAtTheExtremes) {
  grid::Lattice l;
  l.size = {91, 2, 1};
  l.spacing_mm = {double(0.3f), 0.5, 1e-9};
  const auto factor = [&](double cell_mm) { return mask::coarse_raster(l, cell_mm, true).factor; };
  EXPECT_EQ(factor(1.5), (std::array<int, 3>{5, 2, 1}));   // as in voxels of 0.3 mm
  EXPECT_EQ(factor(1e-6), (std::array<int, 3>{1, 1, 1}));  // never less than a voxel
  EXPECT_EQ(factor(1e12), (std::array<int, 3>{91, 2, 1}));
  const auto whole = mask::coarse_raster(l, 1e300);
  for (int a = 0; a < 3; ++a) EXPECT_EQ(whole.cells.size[a], 1);
  EXPECT_NEAR(norm(whole.cells.origin_mm - l.to_world_mm({45, 0.5, 0})), 0, 1e-9);
}

TEST(CoarseMean, IsThatOfTheKnownVoxelsOfEachCell) {
  grid::Lattice l;
  l.size = {7, 4, 3};
  grid::Grid<float> hu(l);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 7; ++i) hu.at(i, j, k) = float(i + 10 * j + 100 * k);
  const auto cells = mask::coarse_raster(l, std::array<int, 3>{3, 2, 2});
  EXPECT_EQ(cells.cells.size, (std::array<int, 3>{3, 2, 2}));
  const grid::Field all = mask::coarse_mean(hu, cells);
  EXPECT_EQ(all.at(0, 0, 0), 56);   // of 12 voxels
  EXPECT_EQ(all.at(2, 1, 1), 231);  // of the 2 that the last cell has
  mask::BitMask known(l);
  known.set(1, 0, 0);
  known.set(2, 1, 1);
  known.set(6, 3, 2);
  const grid::Grid<float> some = mask::coarse_mean(mask::HuView(hu), known, cells, -1);
  EXPECT_EQ(some.at(0, 0, 0), 56.5f);
  EXPECT_EQ(some.at(2, 1, 1), 236);
  EXPECT_EQ(some.at(1, 0, 0), -1);
}

// One layer of cells is a single slice, which is refused as one of voxels is.
TEST(CoarseSegment, OfAVolumeThinnerThanACell) {
  const auto whole = std::get<grid::Grid<std::int16_t>>(scan());
  grid::Lattice l = whole;
  l.size[2] = 3;
  grid::Grid<std::int16_t> slices(l);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) slices.at(i, j, k) = whole.at(i, j, 14);
  EXPECT_EQ(segmentation::segment(slices, {}, params(1.5)).value.size[2], 3);
  for (const double cell_mm : {3.6, 10.0, 1e9}) {
    try {
      segmentation::segment(slices, {}, params(cell_mm));
      FAIL() << cell_mm;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << cell_mm;
    }
  }
}

TEST(CoarseSegment, SameBytesWhateverTheThreads) {
  set_thread_count(1);
  const grid::Field one = segmentation::segment(scan(), {}, params(1.5)).value;
  for (const int threads : {2, 8}) {
    set_thread_count(threads);
    EXPECT_TRUE(segmentation::segment(scan(), {}, params(1.5)).value == one) << threads;
  }
  set_thread_count(0);
}

TEST(CoarseSegment, NoNumberIsRefused) {
  const auto whole = std::get<grid::Grid<std::int16_t>>(scan());
  grid::Grid<float> g(static_cast<const grid::Lattice&>(whole));
  for (std::size_t i = 0; i < g.voxels.size(); ++i) g.voxels[i] = whole.voxels[i];
  g.at(30, 30, 14) = std::numeric_limits<float>::quiet_NaN();
  try {
    segmentation::segment(g, {}, params(1.5));
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
  }
}

TEST(CoarseSegment, NotWithOtherAnatomies) {
  const grid::Field field = segmentation::segment(scan(), {}, params(1.5)).value;
  try {
    segmentation::segment(scan(), {&field, nullptr}, params(1.5));
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::usage);
    EXPECT_EQ(e.field(), "coarse_mm");
  }
}

}  // namespace
}  // namespace trephine
