// SPDX-License-Identifier: GPL-3.0-or-later
// Slices between thick slices: surfaces without terraces, outlines where they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/shape_interpolate.h"
#include "meshing_shapes.h"
#include "report_of.h"
#include "surface/trimesh.h"

namespace trephine {
namespace {

using namespace shapes;

constexpr double radius_mm = 45;

double to_ball_mm(Vec3 p) { return radius_mm - norm(p); }

/// What a scanner's thin slices, 4 mm apart, show of a shape: HU above the threshold, with an edge of a millimetre.
grid::Field slices_of(const std::function<double(Vec3)>& inside_mm, double step_mm = 4, double half_height_mm = 50) {
  const int nz = int(2 * half_height_mm / step_mm);
  return sample(lattice(100, 104, nz, {1, 1, step_mm}, {-49.7, -51.6, -half_height_mm + 0.3}),
                [&](Vec3 p) { return 500 * std::clamp(inside_mm(p), -1.0, 1.0); });
}

grid::Field interpolated(const grid::Field& f, mask::ShapeInterpolateParams p = {}) {
  Report report;
  return *value_of(report, mask::shape_interpolate(std::make_shared<const grid::Field>(f), p));
}

struct Error_mm {
  double mean = 0, max = 0;
};

/// Of the surface's points from the ball's, both inwards and outwards.
Error_mm error_of(const grid::Field& f) {
  const surface::TriMesh mesh = contoured(f);
  Error_mm e;
  for (std::size_t i = 0; i < mesh.points_mm.size(); ++i) {
    const double d = std::abs(to_ball_mm(mesh.world_mm(i)));
    e.mean += d / double(mesh.points_mm.size());
    e.max = std::max(e.max, d);
  }
  return e;
}

TEST(ShapeInterpolate, ABallOfThickSlicesHasNoTerraces) {
  const grid::Field thick = slices_of(to_ball_mm);
  const Error_mm before = error_of(thick), after = error_of(interpolated(thick));
  EXPECT_GT(before.mean, 0.15);
  EXPECT_LT(after.mean, 0.05);
  // At the poles, where no outline leads on, the grey values alone say where the surface lies.
  EXPECT_LT(after.max, 1.5);
}

TEST(ShapeInterpolate, OutlinesOfTheGivenSlicesStay) {
  const grid::Field thick = slices_of(to_ball_mm), fine = interpolated(thick);
  const int n = int(std::lround(thick.spacing_mm.z / fine.spacing_mm.z));
  EXPECT_EQ(n, 3);
  int crossings = 0;
  for (int k = 0; k < fine.size[2]; ++k) {
    const Vec3 row = thick.to_index(fine.to_world_mm({0, 0, double(k)}));
    const int slice = int(std::lround(row.z));
    if (std::abs(row.z - slice) > 1e-6 || slice < 0 || slice >= thick.size[2]) continue;
    const int i0 = int(std::lround(row.x)), j0 = int(std::lround(row.y));
    for (int j = 0; j < fine.size[1]; ++j)
      for (int i = 0; i + 1 < fine.size[0]; ++i) {
        const float a = thick.at(i + i0, j + j0, slice), b = thick.at(i + i0 + 1, j + j0, slice);
        const float c = fine.at(i, j, k), d = fine.at(i + 1, j, k);
        ASSERT_EQ(a > 0, c > 0);
        if ((a > 0) == (b > 0)) continue;
        ++crossings;
        EXPECT_NEAR(a / (a - b), c / (c - d), 0.08) << i << ' ' << j << ' ' << k;
      }
  }
  EXPECT_GT(crossings, 1000);
}

TEST(ShapeInterpolate, ThinSlicesPassUnchanged) {
  const grid::Field thin = slices_of(to_ball_mm, 1.5);
  EXPECT_EQ(interpolated(thin), thin);
  mask::ShapeInterpolateParams p;
  p.thicker_than_mm = 1.2;
  EXPECT_EQ(mask::thick_axis(thin, p), 2);
  EXPECT_NE(interpolated(thin, p), thin);
}

// The volume of a case does not know which way its slices were taken.
TEST(ShapeInterpolate, AnyAxisMayBeTheThickOne) {
  const grid::Field thick = slices_of(to_ball_mm);
  const Error_mm along_z = error_of(interpolated(thick));
  for (int axis : {0, 1}) {
    grid::Lattice l = thick;
    const std::array<int, 3> from{(2 - axis) % 3, (3 - axis) % 3, (4 - axis) % 3};
    const double spacing[3] = {1, 1, 4};
    for (int c = 0; c < 3; ++c) {
      l.size[c] = thick.size[from[c]];
      l.direction.column[c] = thick.direction.column[from[c]];
    }
    l.spacing_mm = {spacing[from[0]], spacing[from[1]], spacing[from[2]]};
    grid::Field turned = sample(l, [](Vec3) { return 0; });
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 at = thick.to_index(l.to_world_mm({double(i), double(j), double(k)}));
          turned.at(i, j, k) = thick.at(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z)));
        }
    ASSERT_EQ(mask::thick_axis(turned, {}), axis);
    const Error_mm e = error_of(interpolated(turned));
    EXPECT_NEAR(e.mean, along_z.mean, 0.01);
    EXPECT_NEAR(e.max, along_z.max, 0.1);
  }
}

// A neck that the scan cuts ends half a slice beyond the last slice, as before.
TEST(ShapeInterpolate, AShapeThatTheScanCutsEndsWhereItDid) {
  const auto rod = [](Vec3 p) { return 20 - std::hypot(p.x, p.y); };
  const grid::Field thick = slices_of(rod, 5, 30);
  const surface::TriMesh before = contoured(thick), after = contoured(interpolated(thick));
  const auto ends = [](const surface::TriMesh& m) {
    const surface::Bounds b = surface::bounds_of(m);
    return std::array<double, 2>{b.min_mm.z, b.max_mm.z};
  };
  EXPECT_NEAR(ends(before)[0], ends(after)[0], 1e-3);
  EXPECT_NEAR(ends(before)[1], ends(after)[1], 1e-3);
}

// A plate of bone thinner than a step, oblique to the slices, is in places of its own in neighbouring slices: distances
// within the slice would tear it, grey values hold it together.
TEST(ShapeInterpolate, AThinObliquePlateIsNotTorn) {
  const auto plate = [](Vec3 p) { return std::min(1.5 - std::abs(p.x - 0.5 * p.z) / 1.118, 40 - std::abs(p.y)); };
  const grid::Field thick = slices_of(plate, 4, 30);
  mask::ShapeInterpolateParams torn;
  torn.thin_steps = 0;
  const auto pieces = [](const grid::Field& f) { return surface::topology_of(contoured(f)).components; };
  EXPECT_EQ(pieces(thick), 1);
  EXPECT_EQ(pieces(interpolated(thick)), 1);
  EXPECT_GT(pieces(interpolated(slices_of(
                                    [&](Vec3 p) {
                                      return plate({1.3 * p.x, p.y, 2.6 * p.z});
                                    },
                                    4, 30),
                                torn)),
            1);
}

TEST(ShapeInterpolate, TheSameBitsWhateverTheThreads) {
  const grid::Field thick = slices_of(to_ball_mm);
  set_thread_count(1);
  const grid::Field one = interpolated(thick);
  set_thread_count(5);
  EXPECT_EQ(interpolated(thick), one);
  set_thread_count(0);
}

TEST(ShapeInterpolate, EmptyFullAndDamagedFields) {
  grid::Field f = slices_of([](Vec3) { return -1; });
  for (float v : interpolated(f).voxels) ASSERT_LT(v, 0);
  f = slices_of([](Vec3) { return 1; });
  for (float v : interpolated(f).voxels) ASSERT_GT(v, 0);
  f.at(3, 4, 5) = std::numeric_limits<float>::quiet_NaN();
  try {
    interpolated(f);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(int(e.code()), 65);
    EXPECT_EQ(e.field(), "voxel 3 4 5");
  }
}

}  // namespace
}  // namespace trephine
