// SPDX-License-Identifier: GPL-3.0-or-later
// What raw values mean: occupancies, windows of HU, and what is no haptic volume.
#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "report_of.h"
#include "voxel/decode.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

using shapes::uniform;

voxel::HapticVolume volume_of(std::array<int, 3> size, int shapes) {
  voxel::HapticVolume v;
  grid::Lattice l;
  l.size = size;
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  for (int n = 1; n <= shapes; ++n) v.shapes.push_back(voxel::occupancy_shape("shape_" + std::to_string(n), n));
  return v;
}

TEST(Decode, SharesOfAVoxel) {
  voxel::HapticVolume v = volume_of({5, 5, 5}, 3);
  const voxel::HapticDecoder d(v);
  v.voxels.at(2, 2, 2) = 1102;
  EXPECT_EQ(d.occupancy(1, 2, 2, 2), 102 / 255.0);
  EXPECT_EQ(d.occupancy(2, 2, 2, 2), 0);  // nobody is near
  v.voxels.at(3, 3, 3) = 2255;
  EXPECT_EQ(d.occupancy(2, 2, 2, 2), 153 / 255.0);
  EXPECT_EQ(d.occupancy(3, 2, 2, 2), 0);
  v.voxels.at(1, 1, 1) = 3255;  // as much as shape 2: the lower number
  EXPECT_EQ(d.occupancy(2, 2, 2, 2), 153 / 255.0);
  v.voxels.at(1, 1, 2) = 3301;  // bare, and counts like any other
  EXPECT_EQ(d.occupancy(3, 2, 2, 2), 153 / 255.0);
  EXPECT_EQ(d.occupancy(2, 2, 2, 2), 0);
  v.voxels.at(2, 2, 2) = 1402;  // bare
  EXPECT_EQ(d.occupancy(1, 2, 2, 2), 102 / 255.0);
  EXPECT_EQ(d.occupancy(3, 2, 2, 2), 0);
  EXPECT_EQ(d.shape_at(2, 2, 2), 1);
  EXPECT_EQ(d.shape_at(1, 1, 2), 3);
  EXPECT_EQ(d.shape_at(0, 0, 0), 0);
  EXPECT_EQ(d.shape_at(-1, 0, 0), 0);
  EXPECT_EQ(d.shape_at(0, 0, 5), 0);
  // Values of no shape are nobody's, whatever is beside them.
  for (const int raw : {-32768, -1, 1, 255, 1000, 1256, 1300, 1556, 1999, 32556, 32767}) {
    v.voxels.at(2, 2, 2) = std::int16_t(raw);
    EXPECT_EQ(d.shape_at(2, 2, 2), 0) << raw;
    for (int n = 0; n <= 33; ++n) EXPECT_EQ(d.occupancy(n, 2, 2, 2), 0) << raw;
  }
}

TEST(Decode, RawValuesAreNeverMixed) {
  // Shape 3 beside EMPTY, and beside shape 1: the mean of the raw values would be shapes 1 and 2.
  voxel::HapticVolume v = volume_of({6, 1, 1}, 3);
  for (int i = 0; i < 3; ++i) v.voxels.at(i, 0, 0) = 3255;
  v.voxels.at(3, 0, 0) = v.voxels.at(4, 0, 0) = 1255;
  const voxel::HapticDecoder d(v);
  for (double x = -1; x <= 6; x += 0.01) {
    EXPECT_EQ(d.trilinear(2, {x, 0, 0}), 0);
    EXPECT_NEAR(d.trilinear(3, {x, 0, 0}), x < 0 ? 1 + x : std::clamp(3 - x, 0.0, 1.0), 1e-12);
    EXPECT_NEAR(d.trilinear(1, {x, 0, 0}), std::clamp(std::min(x - 2, 5 - x), 0.0, 1.0), 1e-12);
  }
}

TEST(Decode, AgreesWithItsVoxels) {
  std::mt19937_64 rng(1);
  voxel::HapticVolume v = volume_of({7, 8, 9}, 4);
  v.voxels.spacing_mm = {0.4, 0.5, 0.95};
  v.voxels.direction = shapes::turned(rng);
  v.voxels.origin_mm = {5, -7, 30};
  for (auto& raw : v.voxels.voxels)
    raw = std::int16_t(rng() % 4 == 0 ? 0 : 1000 * (1 + rng() % 4) + 1 + rng() % 255 + 300 * (rng() % 2));
  voxel::check_haptic_volume(v);
  const voxel::HapticDecoder d(v);
  const grid::Lattice& l = v.voxels;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 index{uniform(rng, -2, 9), uniform(rng, -2, 10), uniform(rng, -2, 11)}, p = l.to_world_mm(index);
    const int number = 1 + int(rng() % 4);
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const int i = int(std::floor(index.x)) + (c & 1), j = int(std::floor(index.y)) + (c >> 1 & 1),
                k = int(std::floor(index.z)) + (c >> 2);
      sum += d.occupancy(number, i, j, k) * (1 - std::abs(index.x - i)) * (1 - std::abs(index.y - j)) *
             (1 - std::abs(index.z - k));
    }
    ASSERT_NEAR(d.trilinear(number, p), sum, 1e-9);
    ASSERT_EQ(d.nearest(number, p), d.occupancy(number, int(std::floor(index.x + 0.5)), int(std::floor(index.y + 0.5)),
                                                int(std::floor(index.z + 0.5))));
    for (int a = 0; a < 3; ++a) {
      const Vec3 step = l.direction.column[std::size_t(a)] * l.spacing_mm[a];
      ASSERT_NEAR(dot(d.gradient(number, p), l.direction.column[std::size_t(a)]),
                  (d.trilinear(number, p + step) - d.trilinear(number, p - step)) / (2 * l.spacing_mm[a]), 1e-6);
    }
  }
}

TEST(Decode, PositionsThatAreNone) {
  voxel::HapticVolume v = volume_of({3, 3, 3}, 1);
  for (auto& raw : v.voxels.voxels) raw = 1255;
  const voxel::HapticDecoder d(v);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e300, -1e300, 1e12})
    for (int a = 0; a < 3; ++a) {
      Vec3 p{1, 1, 1};
      p[a] = bad;
      EXPECT_EQ(d.trilinear(1, p), 0);
      EXPECT_EQ(d.nearest(1, p), 0);
      EXPECT_EQ(d.gradient(1, p), (Vec3{}));
    }
  EXPECT_EQ(d.trilinear(1, {1, 1, 1}), 1);
  for (const int number : {-1, 0, 2, 32, 33, 1000000}) EXPECT_EQ(d.trilinear(number, {1, 1, 1}), 0);
}

TEST(Decode, GradientPointsIntoTheShape) {
  std::mt19937_64 rng(2);
  const auto solid = shapes::ball(9, {}, 500, rng);
  Report report;
  const voxel::HapticVolume v = value_of(
      report,
      voxel::voxelize(shapes::lattice_around(surface::bounds_of(solid.mesh), {0.4, 0.4, 0.95}, shapes::turned(rng)),
                      {{"a", &solid.mesh}}));
  const voxel::HapticDecoder d(v);
  double worst = 1;
  for (const auto& s : solid.points) worst = std::min(worst, dot(normalized(d.gradient(1, s.point_mm)), -s.normal));
  EXPECT_GT(worst, 0.97);
}

// A ball of 300 HU within one of 40, in air, blurred as a scanner does.
struct SyntheticCt {
  grid::Grid<float> hu;
  static constexpr double outer = 12, inner = 7, blur = 0.7;
  SyntheticCt() {
    grid::Lattice l;
    l.size = {60, 60, 60};
    l.spacing_mm = {0.6, 0.6, 0.6};
    l.origin_mm = {-17.7, -17.7, -17.7};
    hu = grid::Grid<float>(l);
    const auto step = [](double d) { return 0.5 * std::erfc(d / (blur * std::sqrt(2.0))); };
    for (int k = 0; k < 60; ++k)
      for (int j = 0; j < 60; ++j)
        for (int i = 0; i < 60; ++i) {
          const double r = norm(l.to_world_mm({double(i), double(j), double(k)}));
          hu.at(i, j, k) = float(-1000 + 1040 * step(r - outer) + 260 * step(r - inner));
        }
  }
};

TEST(DecodeHu, SurfacesLieWhereTheHuCrossALowEnd) {
  const SyntheticCt ct;
  Report report;
  // On the CT's own raster: tissue of -300 to 169, bone of 170 on.
  const voxel::HapticVolume v =
      value_of(report, voxel::voxelize_hu(ct.hu, ct.hu, {{"skin", -300, 169}, {"bone", 170, 3071}}));
  EXPECT_EQ(std::get<std::int64_t>(*report.find("clamped_voxels_count")), 0);
  const voxel::HapticDecoder d(v);
  std::mt19937_64 rng(3);
  // Where the blurred HU cross -300 and 170.
  const auto radius_at = [&](double level) {
    double lo = 3, hi = 16;
    for (int n = 0; n < 60; ++n) {
      const double r = (lo + hi) / 2;
      const auto step = [](double x) { return 0.5 * std::erfc(x / (SyntheticCt::blur * std::sqrt(2.0))); };
      (-1000 + 1040 * step(r - SyntheticCt::outer) + 260 * step(r - SyntheticCt::inner) > level ? lo : hi) = r;
    }
    return lo;
  };
  std::vector<shapes::SurfacePoint> skin, bone;
  for (int n = 0; n < 1500; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    skin.push_back({u * radius_at(-300), u});
    bone.push_back({u * radius_at(170), u});
  }
  const auto towards_air = shapes::offsets_of(skin, 1.5, [&](Vec3 p) { return d.trilinear(1, p); });
  EXPECT_EQ(towards_air.missed, 0);
  EXPECT_LT(std::abs(towards_air.bias), 0.05 * 0.6);
  EXPECT_LT(towards_air.rms, 0.1 * 0.6);
  // And where bone begins, the same for both.
  const auto meeting = shapes::offsets_of(bone, 1.5, [&](Vec3 p) { return d.trilinear(2, p); });
  EXPECT_EQ(meeting.missed, 0);
  EXPECT_LT(std::abs(meeting.bias), 0.05 * 0.6);
  EXPECT_LT(meeting.rms, 0.1 * 0.6);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 p{uniform(rng, -13, 13), uniform(rng, -13, 13), uniform(rng, -13, 13)};
    const double s = d.trilinear(1, p), b = d.trilinear(2, p), r = norm(p);
    ASSERT_FALSE(s > 0.5 && b > 0.5);
    if (r < 10.5) {
      ASSERT_GE(std::max(s, b), 0.5 - 1e-9) << "a gap at " << r;
    }  // no air between the windows
    if (r > 8) {
      ASSERT_LE(b, 0.5) << "skin's partial volume read as bone at " << r;
    }
    if (r > 14) {
      ASSERT_LT(s, 0.5);
    }
  }
  // Towards the air nothing but the mean of the HU counts, so that the edge is where a contour's is.
  EXPECT_EQ(d.occupancy(1, 0, 0, 0), 0);
  EXPECT_EQ(d.shape_at(0, 0, 0), 0);
  EXPECT_EQ(d.shape_at(30, 30, 30), 2);
  EXPECT_EQ(d.occupancy(1, 30, 30, 30), 0);
}

TEST(DecodeHu, ValuesOfNoWindowAreNobodys) {
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  grid::Lattice l;
  l.size = {5, 1, 1};
  v.voxels = grid::Grid<std::int16_t>(l, 1500);
  v.shapes = {{"soft", 1, -200, 100}, {"hard", 2, 300, 2000}};
  voxel::check_haptic_volume(v);
  const voxel::HapticDecoder d(v);
  const std::int16_t raw[5] = {-1000, 40, 200, 1500, 2500};
  std::copy(raw, raw + 5, v.voxels.voxels.begin());
  const int expected[5] = {0, 1, 0, 2, 0};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(d.shape_at(i, 0, 0), expected[i]);
    for (int n = 1; n <= 2; ++n) EXPECT_EQ(d.occupancy(n, i, 0, 0) >= 0.5, expected[i] == n) << i;
  }
  EXPECT_EQ(d.occupancy(1, 0, 0, 0), 0);
  EXPECT_EQ(d.occupancy(1, 2, 0, 0), 0);
  EXPECT_NEAR(d.trilinear(1, {0.5, 0, 0}), 0.5 + (-480 + 200) / 1600.0, 1e-9);
  EXPECT_NEAR(d.trilinear(1, {1 + 60.5 / 160, 0, 0}), 0.5, 1e-9);
  EXPECT_NEAR(d.trilinear(2, {2 + 100.0 / 1300, 0, 0}), 0.5, 1e-9);
  EXPECT_NEAR(d.trilinear(2, {3.5005, 0, 0}), 0.5, 1e-9);
}

// Where the first window ends does not depend on what else a cell holds: the HU between the two are nobody's.
TEST(DecodeHu, AWindowEndsAtItsEndBeforeAGap) {
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  grid::Lattice l;
  l.size = {3, 2, 1};
  v.voxels = grid::Grid<std::int16_t>(l, 50);
  v.shapes = {{"soft", 1, 0, 100}, {"hard", 2, 170, 3000}};
  for (const int beside : {50, 300}) {
    v.voxels.at(1, 0, 0) = 130;
    v.voxels.at(0, 1, 0) = std::int16_t(beside);
    EXPECT_NEAR(voxel::HapticDecoder(v).trilinear(1, {50.5 / 80, 0, 0}), 0.5, 1e-9) << beside;
  }
}

TEST(VoxelizeHu, ResamplesAndCounts) {
  grid::Lattice l;
  l.size = {4, 4, 4};
  grid::Grid<float> ct(l);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) ct.at(i, j, k) = float(100 * i + 10 * j + k);
  grid::Lattice finer;
  finer.size = {17, 3, 3};
  finer.spacing_mm = {0.5, 1, 1};
  finer.origin_mm = {-2, 0.5, 1};
  Report report;
  const voxel::HapticVolume v = value_of(report, voxel::voxelize_hu(ct, finer, {{"a", 0, 1000}}));
  for (int i = 0; i < 17; ++i) {
    const double x = -2 + 0.5 * i;
    const double expected = x < -0.5 || x > 3.5 ? -1024 : 100 * std::clamp(x, 0.0, 3.0) + 10 * 0.5 + 1;
    EXPECT_EQ(v.voxels.at(i, 0, 0), int(std::floor(expected + 0.5))) << x;
  }
  ct.at(1, 1, 1) = 1e6f;
  report = printed(voxel::voxelize_hu(ct, ct, {{"a", 0, 1000}}));
  EXPECT_EQ(std::get<std::int64_t>(*report.find("clamped_voxels_count")), 1);
  for (const auto& windows : std::vector<std::vector<voxel::HuWindow>>{
           {}, {{"a", 5, 4}}, {{"a", 0, 100}, {"b", 100, 200}}, std::vector<voxel::HuWindow>(33, {"a", 0, 1})})
    EXPECT_THROW(value_of(report, voxel::voxelize_hu(ct, ct, windows)), Error);
  for (const int low : {-1024, -1025, -32768}) try {
      value_of(report, voxel::voxelize_hu(ct, ct, {{"bone", 300, 3071}, {"air", std::int16_t(low), -900}}));
      FAIL() << low;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_config);
      EXPECT_EQ(e.field(), "haptic.windows.air");
      EXPECT_NE(std::string(e.what()).find("above -1024"), std::string::npos) << e.what();
    }
  value_of(report, voxel::voxelize_hu(ct, ct, {{"air", -1023, 3071}}));
  const grid::Mask hard = voxel::haptic_hardness(ct, l, 100, 300);
  EXPECT_EQ(hard.at(0, 3, 3), 0);
  EXPECT_EQ(hard.at(2, 0, 0), 128);
  EXPECT_EQ(hard.at(3, 0, 0), 255);
  EXPECT_THROW(voxel::haptic_hardness(ct, l, 300, 300), Error);
}

TEST(CheckHapticVolume, NamesTheField) {
  const auto field_of = [](const std::function<void(voxel::HapticVolume&)>& spoil) -> std::string {
    voxel::HapticVolume v = volume_of({4, 4, 4}, 2);
    v.voxels.at(1, 1, 1) = 1001;
    v.voxels.at(1, 1, 2) = 2555;
    voxel::check_haptic_volume(v);
    spoil(v);
    try {
      voxel::check_haptic_volume(v);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field();
    }
    return "";
  };
  EXPECT_EQ(field_of([](voxel::HapticVolume&) {}), "");
  for (const int raw : {-1, 1, 1000, 1256, 1300, 1556, 3001, 32767})
    EXPECT_EQ(field_of([&](voxel::HapticVolume& v) { v.voxels.at(3, 3, 3) = std::int16_t(raw); }), "data") << raw;
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes.pop_back(); }), "data");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[1].number = 1; }), "shapes[1].number");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[1].number = 33; }), "shapes[1].number");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[1].name = "shape_1"; }), "shapes[1].name");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[0].name = "Skin"; }), "shapes[0].name");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[0].name = ""; }), "shapes[0].name");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.shapes[0].window_high = 1300; }), "shapes[0].window");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.spacing_mm.y = 0; }), "spacing");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.spacing_mm.y = NAN; }), "spacing");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.origin_mm.x = INFINITY; }), "origin");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.direction.column[0].x = 0.9; }), "direction");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.size[0] = -4; }), "sizes");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.size = {1 << 30, 1 << 30, 1 << 30}; }), "sizes");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.voxels.voxels.pop_back(); }), "sizes");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) {
              v.hardness = grid::Mask(grid::cropped(v.voxels, {{0, 0, 0}, {2, 2, 2}}));
            }),
            "hardness");
  EXPECT_EQ(field_of([](voxel::HapticVolume& v) { v.hardness = grid::Mask(v.voxels, 7); }), "");
  const auto in_hu = [](int low) {
    return [low](voxel::HapticVolume& v) {
      v.encoding = voxel::HapticEncoding::hu;
      v.shapes[1].window_low = std::int16_t(low);
      v.shapes[1].window_high = 1000;
    };
  };
  EXPECT_EQ(field_of(in_hu(-1024)), "shapes[1].window");
  EXPECT_EQ(field_of(in_hu(-32768)), "shapes[1].window");
  EXPECT_EQ(field_of(in_hu(-1023)), "");
}

}  // namespace
}  // namespace trephine
