// SPDX-License-Identifier: GPL-3.0-or-later
// Voxelize: shapes kept clear of others, what is refused, the lattice, the same bytes whatever the thread count.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "report_of.h"
#include "surface/inside.h"
#include "surface/point_triangle.h"
#include "voxel/cut.h"
#include "voxel/decode.h"
#include "voxel/shape_occupancy.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

using shapes::Offsets;
using shapes::offsets_of;
using shapes::Solid;
using shapes::uniform;

// Each voxel's share by the nearest of all triangles, against the search of the program, which passes over most of
// them.
TEST(Voxelize, TheNearestTriangleIsFound) {
  std::mt19937_64 rng(40);
  surface::TriMesh mesh = shapes::sphere(3, 6);
  for (Vec3& p : mesh.points_mm) p = p * uniform(rng, 0.85, 1.15);  // bumps, and triangles of many sizes
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(mesh), {0.9, 0.7, 1.3});
  const grid::Grid<std::uint8_t> found = voxel::detail::solid_occupancy(mesh, l, {});
  const grid::Mask inside = surface::voxelize_inside(mesh, l);
  std::size_t ramps = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)}) - mesh.origin_mm;
        surface::ClosestPoint best;
        best.squared_mm2 = 1e300;
        for (const auto& t : mesh.triangles) {
          const auto n =
              surface::nearest_on_triangle(p, mesh.points_mm[t[0]], mesh.points_mm[t[1]], mesh.points_mm[t[2]]);
          if (n.squared_mm2 < best.squared_mm2) best = n;
        }
        const double d = std::sqrt(best.squared_mm2), ramp = voxel::detail::ramp_mm(l, normalized(p - best.point));
        const int share = voxel::detail::share_at(inside.at(i, j, k) ? -d : d, ramp);
        if (share == 0 || share == 255) continue;  // beyond its ramp: no triangle needs to have looked at it
        ++ramps;
        ASSERT_EQ(int(found.at(i, j, k)), share) << i << " " << j << " " << k;
      }
  EXPECT_GT(ramps, 1000u);
}

TEST(Voxelize, ClearOfASurface) {
  std::mt19937_64 rng(8);
  const Solid brain = shapes::ball(8, {}, 0, rng), skull = shapes::ball(14, {}, 0, rng);
  const Solid skull_hole = shapes::ball(11, {}, 0, rng), skin = shapes::ball(18, {}, 0, rng);
  // A shell, by parity: the skull's inner surface is a second shell within it.
  surface::TriMesh shell = skull.mesh;
  const auto offset = std::uint32_t(shell.points_mm.size());
  for (const Vec3 p : skull_hole.mesh.points_mm) shell.points_mm.push_back(p);
  for (const auto& t : skull_hole.mesh.triangles)
    shell.triangles.push_back({t[0] + offset, t[2] + offset, t[1] + offset});
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(skin.mesh), {0.8, 0.8, 0.8});
  Report report;
  std::vector<voxel::VoxelizeShape> list{
      {"brain", &brain.mesh}, {"skull", &shell}, {"skin", &skin.mesh, &brain.mesh, 4}};
  const voxel::HapticVolume volume = value_of(report, voxel::voxelize(l, list));
  const voxel::HapticDecoder decoder(volume);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    ASSERT_EQ(decoder.trilinear(3, u * 9.5), 0);  // the gap is nobody's
    ASSERT_LT(decoder.trilinear(1, u * 9.5) + decoder.trilinear(2, u * 9.5), 0.5);
    ASSERT_GT(decoder.trilinear(2, u * 12.5), 0.9);
    ASSERT_GT(decoder.trilinear(3, u * 16), 0.99);
  }
  list[2].clear_mm = 2;  // to a radius of 10: between there and the skull is skin again
  const voxel::HapticVolume thinner = value_of(report, voxel::voxelize(l, list));
  const voxel::HapticDecoder again(thinner);
  std::vector<shapes::SurfacePoint> points;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    points.push_back({u * 10, -u});
  }
  const Offsets o = offsets_of(points, 0.6, [&](Vec3 p) { return again.trilinear(3, p); });
  EXPECT_LT(o.missed, 10);
  EXPECT_LT(std::abs(o.bias), 0.1 * 0.8);
}

// The scalp outside a bone that is thinner than the clearance stays, the liquor within goes.
TEST(Voxelize, ClearOnlyAsFarAsTheWall) {
  std::mt19937_64 rng(12);
  const Solid brain = shapes::ball(8, {}, 0, rng), skin = shapes::ball(17, {}, 0, rng);
  surface::TriMesh shell = shapes::sphere(5, 12);
  const surface::TriMesh hole = shapes::sphere(5, 10);
  const auto offset = std::uint32_t(shell.points_mm.size());
  shell.points_mm.insert(shell.points_mm.end(), hole.points_mm.begin(), hole.points_mm.end());
  for (const auto& t : hole.triangles) shell.triangles.push_back({t[0] + offset, t[2] + offset, t[1] + offset});
  Report report;
  const voxel::HapticVolume volume = value_of(
      report, voxel::voxelize(shapes::lattice_around(surface::bounds_of(skin.mesh), {0.7, 0.7, 0.7}),
                              {{"brain", &brain.mesh}, {"skull", &shell}, {"skin", &skin.mesh, &brain.mesh, 6}}));
  const voxel::HapticDecoder decoder(volume);
  std::vector<shapes::SurfacePoint> outer;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    ASSERT_EQ(decoder.trilinear(3, u * 9), 0);
    ASSERT_GT(decoder.trilinear(3, u * 13.3), 0.9);  // within 6 mm of the brain
    outer.push_back({u * 12, -u});
  }
  const Offsets o = offsets_of(outer, 1, [&](Vec3 p) { return decoder.trilinear(3, p); });
  EXPECT_EQ(o.missed, 0);
  EXPECT_LT(o.rms, 0.03);
}

TEST(Voxelize, SameBytesWhateverTheThreadCount) {
  std::mt19937_64 rng(9);
  const Solid a = shapes::ball(9, {}, 0, rng);
  const Solid b = shapes::ellipsoid({10, 12, 14}, {}, shapes::turned(rng), 0, rng);
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(b.mesh), {0.4, 0.4, 0.95});
  std::vector<voxel::HapticVolume> made;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    Report report;
    made.push_back(value_of(report, voxel::voxelize(l, {{"a", &a.mesh}, {"b", &b.mesh, &a.mesh, 2.5}})));
    value_of(report, voxel::cut_volume(made.back(), a.distance, surface::bounds_of(a.mesh), {2}));
  }
  set_thread_count(0);
  EXPECT_EQ(made[0].voxels, made[1].voxels);
  EXPECT_EQ(made[0].voxels, made[2].voxels);
}

ExitCode code_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.code();
  }
  return ExitCode::ok;
}

TEST(Voxelize, RefusesWhatItCannotFill) {
  std::mt19937_64 rng(10);
  const Solid a = shapes::ball(5, {}, 0, rng, 3), far = shapes::ball(5, {100, 0, 0}, 0, rng, 3);
  const Solid within = shapes::ball(2, {}, 0, rng, 3);
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(a.mesh), {1, 1, 1});
  surface::TriMesh open = a.mesh;
  open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 200);
  Report r;
  EXPECT_EQ(code_of([&] { value_of(r, voxel::voxelize(l, {{"a", &a.mesh}, {"far", &far.mesh}})); }), ExitCode::quality);
  EXPECT_EQ(code_of([&] {
              value_of(r, voxel::voxelize(l, {{"a", &a.mesh}, {"within", &within.mesh}}));
            }),
            ExitCode::quality);
  EXPECT_EQ(code_of([&] { value_of(r, voxel::voxelize(l, {{"open", &open}})); }), ExitCode::bad_input);
  EXPECT_EQ(code_of([&] { value_of(r, voxel::voxelize(l, {})); }), ExitCode::bad_config);
  const surface::TriMesh none;
  EXPECT_EQ(code_of([&] { value_of(r, voxel::voxelize(l, {{"none", &none}})); }), ExitCode::bad_input);
}

// A membrane: what lies deeper than its thickness belongs to the shapes after it, and it is no wall to a clearance.
TEST(Voxelize, AShellOfAShape) {
  std::mt19937_64 rng(14);
  const Solid dura = shapes::ball(12, {}, 0, rng), brain = shapes::ball(8, {}, 0, rng);
  const Solid skin = shapes::ball(17, {}, 0, rng);
  std::vector<voxel::VoxelizeShape> list{
      {"dura", &dura.mesh}, {"brain", &brain.mesh}, {"skin", &skin.mesh, &brain.mesh, 6}};
  list[0].shell_mm = 2;
  Report report;
  const voxel::HapticVolume volume =
      value_of(report, voxel::voxelize(shapes::lattice_around(surface::bounds_of(skin.mesh), {0.7, 0.7, 0.7}), list));
  const voxel::HapticDecoder decoder(volume);
  std::vector<shapes::SurfacePoint> outer, inner;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 u = shapes::unit_vector(rng);
    ASSERT_GT(decoder.trilinear(1, u * 11), 0.7);
    ASSERT_LT(decoder.trilinear(1, u * 8.5), 0.05);
    ASSERT_GT(decoder.trilinear(2, u * 6.5), 0.9);
    ASSERT_EQ(decoder.trilinear(3, u * 9), 0);
    ASSERT_LT(decoder.trilinear(3, u * 12.9), 0.1);  // within 6 mm of the brain, and behind the membrane only
    ASSERT_GT(decoder.trilinear(3, u * 15.5), 0.9);
    outer.push_back({u * 12, u});
    inner.push_back({u * 10, -u});
  }
  for (const auto& points : {outer, inner}) {
    const Offsets o = offsets_of(points, 0.6, [&](Vec3 p) { return decoder.trilinear(1, p); });
    EXPECT_EQ(o.missed, 0);
    EXPECT_LT(std::abs(o.bias), 0.1 * 0.7);
    EXPECT_LT(o.rms, 0.2 * 0.7);
  }
  const double shell_mm3 = 4.0 / 3 * M_PI * (12 * 12 * 12 - 10 * 10 * 10);
  EXPECT_NEAR(voxel::shape_volume_mm3(volume, 1), shell_mm3, 0.02 * shell_mm3);
}

// A shape that has only slivers of voxels fills 0 ml and would be felt nowhere.
TEST(Voxelize, RefusesAShapeThatHasNoHalfOfAnyVoxel) {
  std::mt19937_64 rng(13);
  const Solid a = shapes::ball(5, {}, 0, rng);
  const Solid dot = shapes::ball(0.45, {0.5, 0.5, 0.5}, 0, rng, 3);  // between the voxel centres
  grid::Lattice l = shapes::lattice_around(surface::bounds_of(a.mesh), {1, 1, 1});
  l.origin_mm = {-9, -9, -9};
  l.size = {19, 19, 19};
  const auto refused = [&](const std::vector<voxel::VoxelizeShape>& list) -> std::string {
    Report r;
    try {
      const voxel::HapticVolume v = value_of(r, voxel::voxelize(l, list));
      for (const voxel::HapticShape& s : v.shapes) EXPECT_GT(voxel::shape_volume_mm3(v, s.number), 0) << s.name;
      return "";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
      return e.field() + ": " + e.what();
    }
  };
  const auto says = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(refused({{"a", &a.mesh}}), "");
  const std::string own = refused({{"a", &a.mesh, &a.mesh, 3}});
  EXPECT_TRUE(says(own, "haptic.a: ") && says(own, "keep clear")) << own;
  const std::string claimed = refused({{"a", &a.mesh}, {"again", &a.mesh}});
  EXPECT_TRUE(says(claimed, "haptic.again: ") && says(claimed, "shapes before it take all")) << claimed;
  const std::string thin = refused({{"dot", &dot.mesh}});
  EXPECT_TRUE(says(thin, "haptic.dot: ") && says(thin, "too thin")) << thin;
}

TEST(Lattice, CoversTheRegionOnTheAnchorsRaster) {
  std::mt19937_64 rng(11);
  voxel::VoxelizeParams params;
  for (int n = 0; n < 200; ++n) {
    params.spacing_mm = {uniform(rng, 0.3, 1), uniform(rng, 0.3, 1), uniform(rng, 0.3, 1)};
    const Mat3 axes = n % 2 ? shapes::turned(rng) : Mat3{};
    const Vec3 anchor{uniform(rng, -99, 99), uniform(rng, -99, 99), uniform(rng, -99, 99)};
    surface::Bounds region{{uniform(rng, -9, 0), uniform(rng, -9, 0), uniform(rng, -9, 0)},
                           {uniform(rng, 0, 9), uniform(rng, 0, 9), uniform(rng, 0, 9)}};
    const grid::Lattice l = voxel::haptic_lattice(region, axes, anchor, params);
    for (int c = 0; c < 8; ++c) {
      const Vec3 i = l.to_index({c & 1 ? region.min_mm.x : region.max_mm.x, c & 2 ? region.min_mm.y : region.max_mm.y,
                                 c & 4 ? region.min_mm.z : region.max_mm.z});
      for (int a = 0; a < 3; ++a) {
        ASSERT_GE(i[a], -0.5 - 1e-5);
        ASSERT_LE(i[a], l.size[std::size_t(a)] - 0.5 + 1e-5);
      }
    }
    const Vec3 at_anchor = l.to_index(anchor);
    for (int a = 0; a < 3; ++a) ASSERT_NEAR(at_anchor[a], std::round(at_anchor[a]), 1e-9);
    region.max_mm += Vec3{5, 5, 5};
    EXPECT_NO_THROW(grid::place_in(l, voxel::haptic_lattice(region, axes, anchor, params)));
  }
  params.spacing_mm = {1, 1, 1};
  // A region of whole voxels gets no more of them.
  EXPECT_EQ(voxel::haptic_lattice({{-0.5, -1.5, 0.5}, {1.5, 1.5, 3.5}}, {}, {}, params).size,
            (std::array<int, 3>{2, 3, 3}));
  params.max_voxels_millions = 0.001;
  EXPECT_EQ(code_of([&] { voxel::haptic_lattice({{0, 0, 0}, {10, 10, 10}}, {}, {}, params); }), ExitCode::bad_config);
  EXPECT_EQ(code_of([&] {
              voxel::haptic_lattice({{0, 0, 0}, {1e300, 10, 10}}, {}, {}, params);
            }),
            ExitCode::bad_config);
  EXPECT_EQ(code_of([&] { voxel::haptic_lattice({{0, 0, 0}, {NAN, 10, 10}}, {}, {}, params); }), ExitCode::bad_config);
}

}  // namespace
}  // namespace trephine
