// SPDX-License-Identifier: GPL-3.0-or-later
// Smoothing within its bound (M10), normals, and the validity check itself against meshes whose faults are known.
#include "meshing/smooth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/contour.h"
#include "meshing/normals.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace shapes;

Result smoothed(const surface::TriMesh& m, std::int64_t iterations, double bound, double band = 0.1,
                meshing::SmoothMethod method = meshing::SmoothMethod::windowed_sinc) {
  meshing::SmoothParams p;
  p.method = method;
  p.iterations_count = iterations;
  p.max_displacement_mm = bound;
  p.pass_band_ratio = band;
  Result r;
  r.mesh = value_of(r.report, meshing::smooth(m, p));
  const meshing::Validity v = meshing::check_validity(r.mesh);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  EXPECT_EQ(r.mesh.triangles, m.triangles);
  for (std::size_t i = 0; i < m.points_mm.size(); ++i)
    EXPECT_LE(norm(r.mesh.world_mm(i) - m.world_mm(i)), bound) << "point " << i;
  return r;
}

/// A sphere of binary voxels: the stair-steps of 1.2 mm that smoothing is for.
surface::TriMesh stairs(int voxels = 40) {
  grid::Field f = sphere(voxels, 20);
  for (float& v : f.voxels) v = v > 0 ? 0.5f : -0.5f;
  return contoured(f);
}

double roughness_mm(const surface::TriMesh& m) {  // RMS against the radius 20
  double s = 0;
  for (std::size_t i = 0; i < m.points_mm.size(); ++i) s += std::pow(norm(m.world_mm(i)) - 20, 2);
  return std::sqrt(s / double(m.points_mm.size()));
}

constexpr meshing::SmoothMethod every_method[] = {meshing::SmoothMethod::windowed_sinc,
                                                  meshing::SmoothMethod::laplacian, meshing::SmoothMethod::feature};

TEST(Smooth, AnyNumberOfIterations) {  // M10
  const surface::TriMesh m = stairs(16);
  for (const meshing::SmoothMethod method : every_method) {
    EXPECT_TRUE(smoothed(m, 0, 0.5, 0.1, method).mesh.points_mm == m.points_mm);
    for (const std::int64_t n : {1, 2, 10, 50, 10000}) {
      const Result r = smoothed(m, n, 0.5, 0.1, method);
      EXPECT_LE(r.number("displacement_max_mm"), 0.5);
      EXPECT_GT(r.number("displacement_max_mm"), 0);
      EXPECT_LE(std::abs(r.number("volume_change_percent")), 0.5) << n;
    }
  }
}

TEST(Smooth, VolumeStaysWhereTheFilterWouldEatIt) {
  // A thread and a sheet: without the limit each method takes percents of them.
  const surface::TriMesh thin = contoured(sample(lattice(40, 30, 12), [](Vec3 p) {
    const double thread = 1.2 - std::hypot(p.y - 5, p.z - 5), sheet = std::min(1.1 - std::abs(p.z - 5), p.y - 10);
    return std::min({std::max(thread, sheet), 18 - std::abs(p.x - 20), 27 - p.y});
  }));
  for (const meshing::SmoothMethod method : every_method)
    for (const std::int64_t n : {10, 1000}) {
      const Result r = smoothed(thin, n, 2, 0.02, method);
      EXPECT_LE(std::abs(r.number("volume_change_percent")), 0.5) << n;
    }
}

/// A cube of 20 mm with points moved by up to 0.15 mm along their normals; RMS distance of its points from the cube.
double cube_error_mm(const surface::TriMesh& m, bool near_edges) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < m.points_mm.size(); ++i) {
    const Vec3 p = m.world_mm(i);
    std::array<double, 3> d = {std::abs(p.x), std::abs(p.y), std::abs(p.z)};
    std::sort(d.begin(), d.end());
    if ((d[1] > 9) != near_edges) continue;
    const double out = std::abs(d[2] - 10);
    sum += out * out;
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(Smooth, FeaturesAreKept) {
  surface::TriMesh m = contoured(sample(lattice(30, 30, 30, {1, 1, 1}, {-14.5, -14.5, -14.5}), [](Vec3 p) {
    return 10 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }));
  surface::TriMesh shaken = m;
  meshing::compute_normals(shaken, meshing::NormalsParams());
  Random random(4);
  for (std::size_t i = 0; i < m.points_mm.size(); ++i) m.points_mm[i] += shaken.normals[i] * random(-0.15, 0.15);
  meshing::snap_to_float32(m);
  const Result feature = smoothed(m, 20, 1, 0.1, meshing::SmoothMethod::feature), sinc = smoothed(m, 20, 1, 0.1);
  EXPECT_LT(cube_error_mm(feature.mesh, false), 0.5 * cube_error_mm(m, false));
  EXPECT_LT(cube_error_mm(feature.mesh, true), 0.7 * cube_error_mm(sinc.mesh, true));
}

TEST(Smooth, TakesTheStairsAway) {
  const surface::TriMesh m = stairs();
  const Result r = smoothed(m, 40, 1.0);
  EXPECT_LT(roughness_mm(r.mesh), 0.5 * roughness_mm(m));
}

TEST(Smooth, LeavesASmoothSurfaceWhereItIs) {
  const surface::TriMesh m = contoured(sphere(60, 20));
  const Result r = smoothed(m, 20, 1.0);
  EXPECT_LT(r.number("displacement_max_mm"), 0.08);
  EXPECT_NEAR(surface::volume_mm3(r.mesh) / (4.0 / 3 * M_PI * 8000), 1, 0.005);
}

TEST(Smooth, PointsAreHeldBackRatherThanCrossed) {
  std::int64_t held = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Result r = smoothed(contoured(noise(12, seed, 0.3, true)), 200, 3.0, 0.02);
    held += std::get<std::int64_t>(*r.report.find("points_held_back_count"));
  }
  EXPECT_GT(held, 0);
}

TEST(Smooth, ScalesAndOffsets) {  // M6
  for (const meshing::SmoothMethod method : every_method) {
    const double unit = surface::volume_mm3(smoothed(contoured(sphere(20, 1)), 10, 0.02, 0.1, method).mesh);
    for (const double scale : {1e-6, 1e-3, 30.0, 1e6})
      for (const double offset : {0.0, 1e6}) {
        if (offset > 0 && scale < 1) continue;  // a lattice origin in doubles has no digits left for it
        const surface::TriMesh m = contoured(sphere(20, scale, {offset, -offset, offset}));
        const Result r = smoothed(m, 10, 0.02 * scale, 0.1, method);
        EXPECT_NEAR(surface::volume_mm3(r.mesh) / (unit * scale * scale * scale), 1, 1e-5) << scale << " " << offset;
      }
  }
}

TEST(Smooth, RefusesWhatIsNotFinite) {
  surface::TriMesh m = stairs();
  m.points_mm[5].x = std::numeric_limits<double>::infinity();
  meshing::SmoothParams p;
  Report r;
  try {
    value_of(r, meshing::smooth(m, p));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.field(), "point 5");
  }
}

TEST(Smooth, SameBytesWithAnyThreads) {
  const surface::TriMesh m = stairs();
  for (const meshing::SmoothMethod method : every_method) {
    set_thread_count(1);
    const Result one = smoothed(m, 30, 0.3, 0.1, method);
    set_thread_count(2);
    const Result two = smoothed(m, 30, 0.3, 0.1, method);
    set_thread_count(0);
    EXPECT_TRUE(one.mesh.points_mm == two.mesh.points_mm);
    EXPECT_EQ(one.report.figures, two.report.figures);
  }
}

TEST(Normals, LookOutwardsAndKeepTheMesh) {
  for (const meshing::NormalWeight weight : {meshing::NormalWeight::area, meshing::NormalWeight::angle}) {
    surface::TriMesh m = contoured(sphere(40, 20));
    const surface::TriMesh before = m;
    meshing::NormalsParams p;
    p.weight = weight;
    meshing::compute_normals(m, p);
    EXPECT_TRUE(m.points_mm == before.points_mm && m.triangles == before.triangles);
    ASSERT_EQ(m.normals.size(), m.points_mm.size());
    for (std::size_t i = 0; i < m.normals.size(); ++i) {
      EXPECT_NEAR(norm(m.normals[i]), 1, 1e-12);
      EXPECT_GT(dot(m.normals[i], normalized(m.world_mm(i))), 0.98);
    }
  }
}

// A flat triangle with an obtuse angle, turned by 90 degrees for a point that is off by 0.02 mm, makes no dark spot.
TEST(Normals, ASlenderTriangleTurnsNone) {
  surface::TriMesh m;
  m.points_mm = {{0, 0, 0.02}, {-2, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  m.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
  meshing::compute_normals(m, meshing::NormalsParams());
  EXPECT_GT(m.normals[0].z, 0.999);
}

TEST(Normals, AreNeverZero) {
  surface::TriMesh m;  // two triangles back to back, and a point of no triangle
  m.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}};
  m.triangles = {{0, 1, 2}, {0, 2, 1}};
  const auto normals = meshing::compute_normals(m, meshing::NormalsParams());
  for (const Vec3 n : m.normals) EXPECT_NEAR(norm(n), 1, 1e-12);
  EXPECT_EQ(normals.normals_replaced_count, 4);
}

surface::TriMesh tetrahedron(Vec3 at, double size) {
  surface::TriMesh m;
  m.points_mm = {at, at + Vec3{size, 0, 0}, at + Vec3{0, size, 0}, at + Vec3{0, 0, size}};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return m;
}

surface::TriMesh together(const surface::TriMesh& a, const surface::TriMesh& b) {
  surface::TriMesh m = a;
  const auto n = static_cast<std::uint32_t>(a.points_mm.size());
  m.points_mm.insert(m.points_mm.end(), b.points_mm.begin(), b.points_mm.end());
  for (const auto& t : b.triangles) m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return m;
}

TEST(Validity, FindsIntersections) {
  EXPECT_TRUE(meshing::check_validity(tetrahedron({}, 1)).valid());
  EXPECT_TRUE(meshing::check_validity(together(tetrahedron({}, 1), tetrahedron({2, 0, 0}, 1))).valid());
  EXPECT_TRUE(
      meshing::check_validity(together(tetrahedron({}, 9), tetrahedron({1, 1, 1}, 1))).valid());  // nested, apart
  EXPECT_GT(meshing::check_validity(together(tetrahedron({}, 1), tetrahedron({0.3, 0.3, 0.3}, 1))).self_intersections,
            0u);
  // They only touch, in a point, and in a face.
  EXPECT_GT(meshing::check_validity(together(tetrahedron({}, 1), tetrahedron({1, 0, 0}, 1))).self_intersections, 0u);
  EXPECT_GT(meshing::check_validity(together(tetrahedron({}, 1), tetrahedron({0, 0, -1}, 1))).self_intersections, 0u);
  // Gaps of one unit in the last place are gaps.
  const double just_beside = std::nextafter(1.0, 2.0);
  EXPECT_EQ(
      meshing::check_validity(together(tetrahedron({}, 1), tetrahedron({just_beside, 0, 0}, 1))).self_intersections,
      0u);
}

TEST(Validity, FindsFoldsAtSharedEdgesAndPoints) {
  surface::TriMesh m = contoured(sphere(12, 5));
  ASSERT_TRUE(meshing::check_validity(m).valid());
  // A point pulled across its ring of neighbours and through the far side.
  const std::uint32_t v = m.triangles[40][0];
  m.points_mm[v] = m.points_mm[v] * -1.2;
  EXPECT_GT(meshing::check_validity(m).self_intersections, 0u);
  // Two coplanar triangles on the same side of their common edge overlap.
  surface::TriMesh fold;
  fold.points_mm = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 2, 0}};
  fold.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(meshing::self_intersections(fold).size(), 1u);
  fold.points_mm[3] = {1, -2, 0};
  EXPECT_EQ(meshing::self_intersections(fold).size(), 0u);
  // Two triangles that share one point, one of which pierces the other.
  surface::TriMesh pierced;
  pierced.points_mm = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}};
  pierced.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(meshing::self_intersections(pierced).size(), 1u);
  EXPECT_EQ(meshing::self_intersections(pierced, {}, {1}).size(), 1u);
}

TEST(Validity, CountsDegenerateAndInsideOut) {
  surface::TriMesh flat = tetrahedron({}, 1);
  flat.points_mm[3] = {0.5, 0.5, 0};
  EXPECT_EQ(meshing::check_validity(flat).degenerate, 1u);
  EXPECT_FALSE(meshing::check_validity(flat).valid());
  surface::TriMesh inward = tetrahedron({}, 1);
  for (auto& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(meshing::check_validity(inward).text(), "looks inwards");
  EXPECT_FALSE(meshing::check_validity(surface::TriMesh()).valid());
}

TEST(Validity, SnappedPointsAreFloat32UnderEveryShift) {
  surface::TriMesh m = contoured(sphere(20, 90, {0.1, 0.2, 0.3}));
  ASSERT_TRUE(meshing::check_validity(m).float32);
  for (const Vec3 shift : {Vec3{100, -250, 333}, Vec3{-17, 1, 640}})
    for (const Vec3 p : m.points_mm)
      for (int a = 0; a < 3; ++a) EXPECT_EQ(p[a] + shift[a], static_cast<float>(p[a] + shift[a]));
}

}  // namespace
}  // namespace trephine
