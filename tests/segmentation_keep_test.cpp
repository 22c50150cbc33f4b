// SPDX-License-Identifier: GPL-3.0-or-later
// Segment by threshold: what each parameter keeps and drops, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "segmentation_samples.h"

namespace trephine {
namespace {

using namespace segment_test;

std::size_t inside(const grid::Field& f) {
  std::size_t n = 0;
  for (float v : f.voxels) n += v > 0;
  return n;
}

ExitCode code_of(const grid::HuVolume& volume, const segmentation::SegmentParams& params, std::string* what = nullptr,
                 const segmentation::SegmentMasks& masks = {}) {
  try {
    segmentation::segment(volume, masks, params);
  } catch (const Error& e) {
    if (what) *what = e.what();
    return e.code();
  }
  return ExitCode::ok;
}

/// Cubes of 4 mm half width with their HU, in 0.
struct Cube {
  Vec3 at;
  double half, hu;
};

grid::Grid<std::int16_t> cubes(const std::vector<Cube>& list, const grid::Lattice& l) {
  return rounded(sampled(l, [&](Vec3 p) {
    double hu = 0;
    for (const Cube& c : list) {
      const Vec3 d = p - c.at;
      if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= c.half) hu = c.hu;
    }
    return hu;
  }));
}

TEST(SegmentThreshold, HysteresisKeepsOnlyPiecesWithASeed) {
  const auto v = cubes({{{-8, 0, 0}, 3, 250}, {{8, 0, 0}, 3, 250}, {{8, 0, 0}, 1, 500}}, lattice(60, 30, 16));
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  EXPECT_TRUE(holds(run(v, p), {-8, 0, 0.5}));
  p.seed_lower_hu = 400;
  const grid::Field f = run(v, p);
  EXPECT_FALSE(holds(f, {-8, 0, 0.5}));
  EXPECT_TRUE(holds(f, {8, 0, 0.5}));
  EXPECT_LT(f.size[0], 22) << "cropped to what is left";
}

TEST(SegmentThreshold, UpperLimitComponentsAndSizes) {
  const auto v = cubes({{{-9, 0, 0}, 4, 300}, {{1, 0, 0}, 2, 300}, {{9, 0, 0}, 3, 900}}, lattice(70, 30, 16));
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.upper_hu = 600;
  grid::Field f = run(v, p);
  EXPECT_TRUE(holds(f, {-9, 0, 0.5}) && holds(f, {1, 0, 0.5}) && !holds(f, {9, 0, 0.5}));
  p.min_component_ml = 0.2;
  f = run(v, p);
  EXPECT_TRUE(holds(f, {-9, 0, 0.5}) && !holds(f, {1, 0, 0.5}));
  p.min_component_ml = 0;
  p.upper_hu = 100000;
  p.components = segmentation::SegmentComponents::largest;
  f = run(v, p);
  EXPECT_TRUE(holds(f, {-9, 0, 0.5}) && !holds(f, {1, 0, 0.5}) && !holds(f, {9, 0, 0.5}));
  EXPECT_EQ(inside(f), 16u * 16 * 8);
}

TEST(SegmentThreshold, OpeningPartsTheHolderAndKeepsTheEar) {
  // A head (ball), an ear (plate of 2 mm, 12 mm out), a holder (plate of 4 mm through the volume) that the head
  // touches.
  const grid::Lattice l = lattice(130, 150, 120, {1, 1, 1});
  const auto hu = [](Vec3 p) {
    const bool head = norm(p) < 45;
    const bool ear = std::abs(p.y) < 1.2 && p.x > 40 && p.x < 57 && std::abs(p.z) < 10;
    const bool holder = p.y > 45.5 && p.y < 49.6;
    const bool pad = std::hypot(p.x, p.z) < 2 && p.y > 40 && p.y < 47;
    return head || ear || holder || pad ? 40.0 : -1000.0;
  };
  segmentation::SegmentParams p;
  p.lower_hu = -475;
  p.components = segmentation::SegmentComponents::largest;
  const grid::HuVolume volume = rounded(sampled(l, hu));
  EXPECT_TRUE(holds(run(volume, p), {30, 47.5, 30})) << "without opening the holder hangs on";
  p.open_mm = 3;
  const grid::Field f = run(volume, p);
  EXPECT_FALSE(holds(f, {30, 47.5, 30}));
  EXPECT_FALSE(holds(f, {8, 47.5, 0}));
  EXPECT_TRUE(holds(f, {0, 40, 0}));
  EXPECT_TRUE(holds(f, {55, 0, 0.5}));
}

TEST(SegmentThreshold, RegionOfInterestInMillimetres) {
  const auto v = cubes({{{0, 0, 0}, 8, 300}}, lattice(60, 60, 30));
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.roi_min_mm = {-4, -100, -100};
  p.roi_max_mm = {100, 3, 100};
  const grid::Field f = run(v, p);
  EXPECT_TRUE(holds(f, {-3, 2, 0.5}));
  EXPECT_FALSE(holds(f, {-5, 2, 0.5}));
  EXPECT_FALSE(holds(f, {-3, 4, 0.5}));
  p.roi_min_mm = {500, 500, 500};
  p.roi_max_mm = {600, 600, 600};
  EXPECT_EQ(code_of(v, p), ExitCode::quality);
}

TEST(SegmentThreshold, FieldIsCroppedOnTheVolumesRaster) {
  const grid::Lattice l = lattice(60, 50, 30);
  const auto v = cubes({{{5, -2, 1}, 3, 300}}, l);
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  const grid::Field f = run(v, p);
  const grid::Box at = grid::place_in(f, l);  // throws where it is not the same raster
  std::size_t n = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const int a = i - at.begin[0], b = j - at.begin[1], c = k - at.begin[2];
        const bool in = f.contains(a, b, c) && f.at(a, b, c) > 0;
        ASSERT_EQ(in, v.at(i, j, k) > 226);
        if (!in) continue;
        ++n;
        EXPECT_TRUE(a >= 2 && b >= 2 && c >= 2 && a < f.size[0] - 2 && b < f.size[1] - 2 && c < f.size[2] - 2);
      }
  EXPECT_GT(n, 0u);
  EXPECT_LE(f.count(), n * 5);
}

TEST(SegmentThreshold, RefusesWhatIsNoShape) {
  const grid::Lattice l = lattice(20, 20, 10);
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  std::string what;
  EXPECT_EQ(code_of(grid::Grid<std::int16_t>(l, 0), p, &what), ExitCode::quality);
  EXPECT_NE(what.find("0 of 4000 voxels"), std::string::npos) << what;
  EXPECT_EQ(code_of(grid::Grid<std::int16_t>(l, 300), p, &what), ExitCode::quality);
  EXPECT_NE(what.find("4000"), std::string::npos) << what;
  grid::Grid<std::int16_t> slice(l, 0);
  for (int j = 5; j < 15; ++j)
    for (int i = 5; i < 15; ++i) slice.at(i, j, 4) = 300;
  EXPECT_EQ(code_of(slice, p, &what), ExitCode::quality);
  EXPECT_NE(what.find("single slice: 100 voxels"), std::string::npos) << what;
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    grid::Grid<float> g(l, 300);
    g.at(3, 3, 3) = bad;
    EXPECT_EQ(code_of(g, p), ExitCode::bad_input);
  }
  p.upper_hu = 100;
  EXPECT_EQ(code_of(grid::Grid<std::int16_t>(l, 300), p), ExitCode::usage);
  // A mask of another raster.
  p.upper_hu = 100000;
  const grid::Field other(lattice(20, 20, 10, {0.6, 0.5, 1}), 1.f);
  segmentation::SegmentMasks masks;
  masks.within = &other;
  EXPECT_EQ(code_of(slice, p, nullptr, masks), ExitCode::bad_input);
  // A region of interest whose corners are exchanged.
  segmentation::SegmentParams exchanged = p;
  exchanged.roi_min_mm = {0, 5, 0};
  exchanged.roi_max_mm = {9, 4, 9};
  EXPECT_EQ(code_of(slice, exchanged, &what), ExitCode::usage);
  EXPECT_NE(what.find("5 to 4 mm along y"), std::string::npos) << what;
}

}  // namespace
}  // namespace trephine
