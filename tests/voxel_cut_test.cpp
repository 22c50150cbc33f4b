// SPDX-License-Identifier: GPL-3.0-or-later
// Cutting: the removed volume, the new surface, and that nobody gains by it.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "meshing/contour.h"
#include "report_of.h"
#include "surface/point_to_mesh.h"
#include "voxel/cut.h"
#include "voxel/decode.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

using shapes::Solid;
using shapes::uniform;

struct Tool {
  surface::DistanceFunction distance;
  surface::Bounds bounds;
};

surface::Bounds around(Vec3 centre, double reach) {
  return {centre - Vec3{reach, reach, reach}, centre + Vec3{reach, reach, reach}};
}

Tool ball_tool(Vec3 centre, double radius) {
  return {[=](Vec3 p) { return norm(p - centre) - radius; }, around(centre, radius)};
}

// From centre - half * axis to centre + half * axis.
Tool cylinder_tool(Vec3 centre, Vec3 axis, double radius, double half) {
  const auto distance = [=](Vec3 p) {
    const Vec3 q = p - centre;
    const double along = dot(q, axis), side = norm(q - along * axis) - radius, end = std::abs(along) - half;
    return side > 0 && end > 0 ? std::hypot(side, end) : std::max(side, end);
  };
  return {distance, around(centre, std::hypot(radius, half))};
}

Tool slab_tool(Vec3 centre, const Mat3& pose, Vec3 half) {
  const auto distance = [=](Vec3 p) {
    const Vec3 q = transpose_times(pose, p - centre);
    Vec3 beyond;
    double inside = -1e300;
    for (int a = 0; a < 3; ++a) {
      beyond[a] = std::max(0.0, std::abs(q[a]) - half[a]);
      inside = std::max(inside, std::abs(q[a]) - half[a]);
    }
    return inside > 0 ? norm(beyond) : inside;
  };
  return {distance, around(centre, norm(half))};
}

double removed(const Report& r, const std::string& name) { return std::get<double>(*r.find(name + ".removed_mm3")); }

TEST(CutVolume, RemovesTheExactVolume) {
  std::mt19937_64 rng(1);
  for (const Vec3 h : {Vec3{0.8, 0.8, 0.8}, Vec3{0.4, 0.4, 0.95}})
    for (int n = 0; n < 4; ++n) {
      const Mat3 pose = shapes::turned(rng);
      const Solid plate = shapes::block({14, 14, 4}, {}, pose, 0, 0, rng);
      const grid::Lattice l = shapes::lattice_around(surface::bounds_of(plate.mesh), h, shapes::turned(rng));
      Report made;
      voxel::HapticVolume v = value_of(made, voxel::voxelize(l, {{"bone", &plate.mesh}}));
      // A burr hole through the plate, and a ball within it.
      const Tool hole = cylinder_tool({}, pose.column[2], 6, 9);
      const double before = voxel::shape_volume_mm3(v, 1);
      voxel::HapticVolume w = v;
      Report report;
      value_of(report, voxel::cut_volume(w, hole.distance, hole.bounds, {}));
      const double exact = M_PI * 36 * 8;
      EXPECT_NEAR(removed(report, "bone"), exact, 0.01 * exact) << n << " at " << h.x;
      EXPECT_NEAR(before - voxel::shape_volume_mm3(w, 1), removed(report, "bone"), 1e-6);
      voxel::check_haptic_volume(w);
      const Solid block = shapes::block({9, 9, 9}, {}, pose, 0, 0, rng);
      voxel::HapticVolume b =
          value_of(made, voxel::voxelize(shapes::lattice_around(surface::bounds_of(block.mesh), h, shapes::turned(rng)),
                                         {{"bone", &block.mesh}}));
      const Tool ball = ball_tool({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)}, 7);
      report = printed(voxel::cut_volume(b, ball.distance, ball.bounds, {1}));
      const double of_ball = 4.0 / 3 * M_PI * 343;
      EXPECT_NEAR(removed(report, "bone"), of_ball, 0.01 * of_ball) << n << " at " << h.x;
    }
}

TEST(CutVolume, TheNewSurfaceIsTheTools) {
  std::mt19937_64 rng(2);
  for (const Vec3 h : {Vec3{0.8, 0.8, 0.8}, Vec3{0.4, 0.4, 0.95}}) {
    const Solid block = shapes::block({12, 12, 12}, {}, shapes::turned(rng), 0, 0, rng);
    Report report;
    voxel::HapticVolume v =
        value_of(report, voxel::voxelize(shapes::lattice_around(surface::bounds_of(block.mesh), h, shapes::turned(rng)),
                                         {{"bone", &block.mesh}}));
    const Tool ball = ball_tool({1, 2, 0}, 7);
    value_of(report, voxel::cut_volume(v, ball.distance, ball.bounds, {}));
    const voxel::HapticDecoder d(v);
    std::vector<shapes::SurfacePoint> points;
    for (int n = 0; n < 1500; ++n) {
      const Vec3 u = shapes::unit_vector(rng);
      points.push_back({Vec3{1, 2, 0} + 7 * u, -u});  // out of the bone is into the hole
    }
    const auto o = shapes::offsets_of(points, 1.5, [&](Vec3 p) { return d.trilinear(1, p); });
    EXPECT_EQ(o.missed, 0);
    EXPECT_LT(std::abs(o.bias), 0.03);
    EXPECT_LT(o.rms, 0.03);
    for (int n = 0; n < 2000; ++n)
      EXPECT_EQ(d.trilinear(1, Vec3{1, 2, 0} + uniform(rng, 0, 4.5) * shapes::unit_vector(rng)), 0);
  }
}

// Nested and touching shapes: ventricle, brain, skull, skin, and a block that touches the skin's side.
voxel::HapticVolume phantom(Vec3 h, std::mt19937_64& rng) {
  const Mat3 pose = shapes::turned(rng);
  const Solid a = shapes::ball(4, {1, 1, 0}, 0, rng, 4), b = shapes::ellipsoid({7, 9, 8}, {}, pose, 0, rng);
  const Solid c = shapes::ellipsoid({8.6, 10.8, 9.7}, {}, pose, 0, rng);
  const Solid e = shapes::ellipsoid({11, 13, 12}, {}, pose, 0, rng);
  const Solid f = shapes::block({5, 9, 9}, pose * Vec3{12, 0, 0}, pose, 0, 0, rng);
  Report report;
  return value_of(
      report,
      voxel::voxelize(
          shapes::lattice_around(surface::bounds_of(e.mesh), h, shapes::turned(rng)),
          {{"ventricles", &a.mesh}, {"brain", &b.mesh}, {"skull", &c.mesh}, {"skin", &e.mesh}, {"block", &f.mesh}}));
}

void expect_that_nobody_gains(int rounds, unsigned seed) {
  std::mt19937_64 rng(seed);
  int switched = 0;
  for (int n = 0; n < rounds; ++n) {
    const Vec3 h = n % 2 ? Vec3{0.8, 0.8, 0.8} : Vec3{0.5, 0.5, 0.95};
    const voxel::HapticVolume before = phantom(h, rng);
    voxel::HapticVolume after = before;
    std::vector<int> cut;
    for (int s = 1; s <= 5; ++s)
      if (n % 5 != 0 && rng() % 2) cut.push_back(s);  // every fifth time all of them
    std::vector<Tool> tools;
    for (int t = 0; t < 3; ++t) {
      const Vec3 centre{uniform(rng, -9, 9), uniform(rng, -9, 9), uniform(rng, -9, 9)};
      const double size = uniform(rng, 0.5, 6);
      tools.push_back(t == 0   ? ball_tool(centre, size)
                      : t == 1 ? cylinder_tool(centre, shapes::unit_vector(rng), size, uniform(rng, 1, 20))
                               : slab_tool(centre, shapes::turned(rng), {size, uniform(rng, 0.2, 6), 9}));
    }
    Report report;
    for (const Tool& t : tools) value_of(report, voxel::cut_volume(after, t.distance, t.bounds, cut));
    voxel::check_haptic_volume(after);
    const voxel::HapticDecoder was(before), is(after);
    const auto left_of = [&](Vec3 p) {
      double d = 1e300;
      for (const Tool& t : tools) d = std::min(d, t.distance(p));
      return d;
    };
    const auto is_cut = [&](int s) { return cut.empty() || std::count(cut.begin(), cut.end(), s) > 0; };
    const grid::Lattice& l = before.voxels;
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const double d = left_of(l.to_world_mm({double(i), double(j), double(k)}));
          for (int s = 1; s <= 5; ++s) {
            const double o = was.occupancy(s, i, j, k), now = is.occupancy(s, i, j, k);
            ASSERT_LE(now, o) << "shape " << s << " gained";
            if (is_cut(s) && d < -norm(h)) {
              ASSERT_EQ(now, 0);
            }
            // What the tool does not reach stays, but for slivers beside the cut that no voxel can hold any more.
            if (d > 3 * norm(h)) {
              ASSERT_EQ(now, o);
            }
            if (!is_cut(s) && o > 0.5 + 1e-9) {
              ASSERT_EQ(now, o);
            }
            if (d > norm(h) && o > 0.5 + 1e-9) {
              ASSERT_EQ(now, o);
            }
          }
          switched += was.shape_at(i, j, k) != is.shape_at(i, j, k) && is.shape_at(i, j, k) != 0;
        }
    for (int p = 0; p < 4000; ++p) {
      const Vec3 at =
          l.to_world_mm({uniform(rng, 0, l.size[0]), uniform(rng, 0, l.size[1]), uniform(rng, 0, l.size[2])});
      for (int s = 1; s <= 5; ++s) {
        ASSERT_LE(is.trilinear(s, at), was.trilinear(s, at) + 1e-12);
        ASSERT_LE(is.nearest(s, at), was.nearest(s, at));
      }
    }
  }
  EXPECT_GT(switched, 0);  // voxels whose larger share was cut keep their other one
}

TEST(CutVolume, NobodyGains) { expect_that_nobody_gains(4, 3); }
TEST(LongCutVolume, NobodyGains) { expect_that_nobody_gains(150, 4); }

TEST(CutVolume, CutTwiceIsCutOnce) {
  std::mt19937_64 rng(4);
  voxel::HapticVolume v = phantom({0.8, 0.8, 0.8}, rng);
  const Tool t = cylinder_tool({6, 0, 0}, {1, 0, 0}, 4, 9);
  Report first, second;
  value_of(first, voxel::cut_volume(v, t.distance, t.bounds, {}));
  const voxel::HapticVolume once = v;
  value_of(second, voxel::cut_volume(v, t.distance, t.bounds, {}));
  EXPECT_EQ(v.voxels, once.voxels);
  EXPECT_GT(std::get<std::int64_t>(*first.find("voxels_count")), 500);
  EXPECT_EQ(std::get<std::int64_t>(*second.find("voxels_count")), 0);
  EXPECT_EQ(removed(second, "skin"), 0);
}

TEST(CutVolume, ToolsThatMissOrAreNone) {
  std::mt19937_64 rng(5);
  const voxel::HapticVolume v = phantom({0.8, 0.8, 0.8}, rng);
  voxel::HapticVolume w = v;
  Report report;
  const Tool far = ball_tool({500, 0, 0}, 7);
  value_of(report, voxel::cut_volume(w, far.distance, far.bounds, {}));
  value_of(report, voxel::cut_volume(w, far.distance, surface::Bounds{}, {}));
  const auto nan = [](Vec3) { return std::nan(""); };
  value_of(report, voxel::cut_volume(w, nan, around({}, 9), {}));
  EXPECT_EQ(w.voxels, v.voxels);
  const std::string all_shapes = "removes nothing of ventricles, brain, skull, skin, block";
  EXPECT_EQ(report.warnings, std::vector<std::string>(3, all_shapes));
  const Tool inner = ball_tool({}, 2);  // in the brain, far from the skin
  report = printed(voxel::cut_volume(w, inner.distance, inner.bounds, {4}));
  EXPECT_EQ(report.warnings, std::vector<std::string>{"removes nothing of skin"});
  w = v;
  EXPECT_THROW(value_of(report, voxel::cut_volume(w, far.distance, far.bounds, {6})), Error);
  // Everything.
  const Tool all = ball_tool({}, 90);
  report = printed(voxel::cut_volume(w, all.distance, all.bounds, {}));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(std::count(w.voxels.voxels.begin(), w.voxels.voxels.end(), voxel::haptic_empty),
            std::ptrdiff_t(w.voxels.voxels.size()));
}

TEST(CutVolume, OfWindowsOfHu) {
  std::mt19937_64 rng(6);
  grid::Lattice l;
  l.size = {50, 50, 50};
  l.spacing_mm = {0.6, 0.6, 0.6};
  l.origin_mm = {-14.7, -14.7, -14.7};
  grid::Grid<float> ct(l);
  const auto step = [](double d) { return 0.5 * std::erfc(d / (0.7 * std::sqrt(2.0))); };
  for (int k = 0; k < 50; ++k)
    for (int j = 0; j < 50; ++j)
      for (int i = 0; i < 50; ++i) {
        const double r = norm(l.to_world_mm({double(i), double(j), double(k)}));
        ct.at(i, j, k) = float(-1000 + 1040 * step(r - 12) + 960 * step(r - 6));
      }
  Report report;
  const voxel::HapticVolume before =
      value_of(report, voxel::voxelize_hu(ct, l, {{"skin", -300, 299}, {"bone", 300, 3071}}));
  for (int n = 0; n < 12; ++n) {
    voxel::HapticVolume after = before;
    const Tool t = n % 2 ? ball_tool(uniform(rng, 0, 10) * shapes::unit_vector(rng), uniform(rng, 2, 5))
                         : cylinder_tool({}, shapes::unit_vector(rng), 3, 20);
    const std::vector<int> cut = n % 3 == 0 ? std::vector<int>{} : std::vector<int>{1 + n % 3 % 2};
    value_of(report, voxel::cut_volume(after, t.distance, t.bounds, cut));
    const voxel::HapticDecoder was(before), is(after);
    for (int k = 0; k < 50; ++k)
      for (int j = 0; j < 50; ++j)
        for (int i = 0; i < 50; ++i) {
          const double d = t.distance(l.to_world_mm({double(i), double(j), double(k)}));
          ASSERT_LE(after.voxels.at(i, j, k), before.voxels.at(i, j, k));
          const int s = is.shape_at(i, j, k);
          if (s != 0) {
            ASSERT_EQ(s, was.shape_at(i, j, k));
          }
          if (d < 0 && cut.empty()) {
            ASSERT_EQ(s, 0);
          }
          if (d < -1.1 && cut.empty()) {
            ASSERT_EQ(after.voxels.at(i, j, k), std::min<int>(-1024, before.voxels.at(i, j, k)));
          }
          if (d > 1.1) {
            ASSERT_EQ(after.voxels.at(i, j, k), before.voxels.at(i, j, k));
          }
        }
  }
  // In the skin alone, away from the bone, the new surface is the tool's.
  voxel::HapticVolume after = before;
  const Tool t = ball_tool({0, 0, 11}, 3);
  value_of(report, voxel::cut_volume(after, t.distance, t.bounds, {}));
  const voxel::HapticDecoder d(after);
  std::vector<shapes::SurfacePoint> points;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    const Vec3 p = Vec3{0, 0, 11} + 3 * u;
    if (norm(p) < 10.3) points.push_back({p, -u});
  }
  const auto o = shapes::offsets_of(points, 1.2, [&](Vec3 p) { return d.trilinear(1, p); });
  EXPECT_EQ(o.missed, 0);
  EXPECT_LT(std::abs(o.bias), 0.1 * 0.6);
  EXPECT_LT(o.rms, 0.15 * 0.6);
}

TEST(CutField, ContoursToTheCutSolid) {
  for (const double unit : {1.0, 400.0}) {  // mm, or HU a mm
    grid::Lattice l;
    l.size = {70, 70, 35};
    l.spacing_mm = {0.45, 0.45, 0.95};
    l.origin_mm = {-15.5, -15.5, -16.1};
    grid::Field field(l);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i)
          field.at(i, j, k) =
              float(unit * std::clamp(12 - norm(l.to_world_mm({double(i), double(j), double(k)})), -1.5, 1.5));
    const Tool t = cylinder_tool({0, 0, 8}, normalized({0.2, 0.1, 1}), 4, 9);
    Report report;
    value_of(report, voxel::cut_field(field, t.distance, t.bounds));
    EXPECT_NEAR(std::get<double>(*report.find("unit_per_mm")), unit, 0.1 * unit);
    for (const float f : field.voxels) ASSERT_TRUE(std::isfinite(f));
    const surface::TriMesh mesh = value_of(report, meshing::contour(field, meshing::ContourParams{}));
    double sum = 0, worst = 0;
    std::size_t on_tool = 0;
    for (std::size_t i = 0; i < mesh.points_mm.size(); ++i) {
      const Vec3 p = mesh.world_mm(i);
      const double d = std::max(norm(p) - 12, -t.distance(p));  // to the cut solid
      on_tool += std::abs(t.distance(p)) < 0.1;
      sum += d * d;
      worst = std::max(worst, std::abs(d));
    }
    EXPECT_GT(on_tool, 500u);
    EXPECT_LT(std::sqrt(sum / double(mesh.points_mm.size())), 0.05);
    EXPECT_LT(worst, 0.25 * 0.95);
    const double exact = 4.0 / 3 * M_PI * 1728 - M_PI * 16 * (std::sqrt(144.0 - 16) + 1);  // about: the cap is curved
    EXPECT_NEAR(surface::volume_mm3(mesh), exact, 0.01 * exact);
  }
}

TEST(CutField, ThatMissesChangesNothing) {
  grid::Lattice l;
  l.size = {9, 9, 9};
  grid::Field field(l, -1);
  field.at(4, 4, 4) = 1;
  const grid::Field before = field;
  Report report;
  const Tool far = ball_tool({99, 0, 0}, 3);
  value_of(report, voxel::cut_field(field, far.distance, far.bounds));
  EXPECT_EQ(field, before);
  EXPECT_EQ(report.warnings, std::vector<std::string>{"removes nothing of the field"});
  // Within what is outside already values fall, but nothing is removed.
  const Tool in_air = ball_tool({1, 1, 1}, 2);
  report = printed(voxel::cut_field(field, in_air.distance, in_air.bounds));
  EXPECT_EQ(report.warnings.size(), 1u);
  const Tool near = ball_tool({4, 4, 4}, 2);
  report = printed(voxel::cut_field(field, near.distance, near.bounds));
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_LE(field.at(4, 4, 4), 0);
}

}  // namespace
}  // namespace trephine
