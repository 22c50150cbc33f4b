// SPDX-License-Identifier: GPL-3.0-or-later
// Distances from points to surfaces: against brute force and against analytic surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "base/parallel.h"
#include "surface/point_to_mesh.h"
#include "surface/point_triangle.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

double uniform(std::mt19937_64& rng, double lo, double hi) { return lo + (hi - lo) * double(rng() >> 11) * 0x1p-53; }
Vec3 somewhere(std::mt19937_64& rng, double r) {
  return {uniform(rng, -r, r), uniform(rng, -r, r), uniform(rng, -r, r)};
}

// The nearest point by refining a grid over the triangle: slow, and independent of the formula under test.
double by_search(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  double u0 = 0, v0 = 0, step = 0.25, best = 1e300, bu = 0, bv = 0;
  for (int round = 0; round < 40; ++round) {
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) {
        const double u = std::min(1.0, std::max(0.0, u0 + i * step)), v = std::min(1 - u, std::max(0.0, v0 + j * step));
        const double d = norm(p - (a + (b - a) * u + (c - a) * v));
        if (d < best) best = d, bu = u, bv = v;
      }
    u0 = bu, v0 = bv, step *= 0.6;
  }
  return best;
}

TEST(PointTriangle, AgreesWithASearch) {
  std::mt19937_64 rng(1);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 a = somewhere(rng, 1), b = somewhere(rng, 1), c = somewhere(rng, 1), p = somewhere(rng, 2);
    const surface::ClosestPoint q = surface::nearest_on_triangle(p, a, b, c);
    EXPECT_NEAR(std::sqrt(q.squared_mm2), by_search(p, a, b, c), 1e-6) << n;
    EXPECT_NEAR(norm(p - q.point), std::sqrt(q.squared_mm2), 1e-12);
  }
}

TEST(PointTriangle, DegenerateTrianglesAreSegmentsAndPoints) {
  const Vec3 a{1, 2, 3}, b{4, 2, 3};
  EXPECT_DOUBLE_EQ(surface::nearest_on_triangle({1, 2, 5}, a, a, a).squared_mm2, 4);
  EXPECT_DOUBLE_EQ(surface::nearest_on_triangle({2, 3, 3}, a, b, b).squared_mm2, 1);
  EXPECT_DOUBLE_EQ(surface::nearest_on_triangle({2, 3, 3}, a, b, a).squared_mm2, 1);
  EXPECT_DOUBLE_EQ(surface::nearest_on_triangle({7, 6, 3}, a, {2, 2, 3}, b).squared_mm2, 25);
  // Slivers: height 1e-13 and 1e-9 of the length; the truth is the segment's distance to that height.
  for (const double height : {1e-13, 1e-9, 1e-6})
    EXPECT_NEAR(std::sqrt(surface::nearest_on_triangle({5, 3, 0}, {0, 0, 0}, {10, 0, 0}, {5, height, 0}).squared_mm2),
                3 - height, 2e-9);
}

TEST(PointToMesh, AgreesWithBruteForceOnTriangleSoup) {
  std::mt19937_64 rng(2);
  for (const Vec3 origin : {Vec3{}, Vec3{1e6, -1e6, 1e6}})
    for (const double size : {0.02, 0.5, 1e-9}) {  // small, overlapping, and next to points
      surface::TriMesh m;
      m.origin_mm = origin;
      for (std::uint32_t t = 0; t < 700; ++t) {
        const Vec3 at = somewhere(rng, 1);
        m.points_mm.push_back(at);
        for (int corner = 0; corner < 2; ++corner) m.points_mm.push_back(at + somewhere(rng, size));
        if (t % 5 == 0) m.points_mm.back() = m.points_mm[3 * t + 1];                             // segment
        if (t % 7 == 0) m.points_mm.back() = (m.points_mm[3 * t] + m.points_mm[3 * t + 1]) / 2;  // sliver
        m.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
      }
      m.triangles.push_back({5, 5, 5});
      std::vector<Vec3> points;
      for (int i = 0; i < 500; ++i) points.push_back(origin + somewhere(rng, i % 2 ? 1.5 : 20));
      for (int i = 0; i < 50; ++i) points.push_back(m.world_mm(std::size_t(i)));
      const surface::PointToMesh to(m);
      const std::vector<double> d = to.distances_mm(points);
      double largest = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        double best = 1e300;
        for (const auto& t : m.triangles)
          best = std::min(best, surface::nearest_on_triangle(points[i] - origin, m.points_mm[t[0]], m.points_mm[t[1]],
                                                             m.points_mm[t[2]])
                                    .squared_mm2);
        ASSERT_DOUBLE_EQ(d[i], std::sqrt(best)) << i;
        ASSERT_DOUBLE_EQ(to.distance_mm(points[i]), std::sqrt(best)) << i;
        ASSERT_NEAR(norm(points[i] - to.closest_mm(points[i])), std::sqrt(best), 1e-9);
        largest = std::max(largest, d[i]);
      }
      EXPECT_EQ(to.largest_distance_mm(points, 0), largest);
      EXPECT_EQ(to.largest_distance_mm(points, largest * 0.99), largest);
      EXPECT_EQ(to.largest_distance_mm(points, largest + 1), largest + 1);
    }
}

TEST(PointToMesh, RepeatedAndExponentiallySpacedTriangles) {
  // What gives a tree no balance: 5,000 equal triangles, and sizes over 60 powers of two.
  surface::TriMesh m;
  for (std::uint32_t t = 0; t < 5000; ++t) {
    const double s = t < 4000 ? 1 : std::ldexp(1.0, int(t % 60) - 40);
    for (const Vec3 p : {Vec3{s, 0, 0}, Vec3{0, s, 0}, Vec3{0, 0, s}}) m.points_mm.push_back(p);
    m.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const surface::PointToMesh to(m);
  EXPECT_NEAR(to.distance_mm({1, 1, 1}), 1 / std::sqrt(3.0), 1e-12);  // to the planes x + y + z = 2 and 4
  EXPECT_NEAR(to.distance_mm({-1, 0, 0}), 1, 1e-9);
}

TEST(PointToMesh, SignsOfABoxAtFacesEdgesAndCorners) {
  const surface::TriMesh m = shapes::box({-1, -2, -3}, {1, 2, 3});
  const surface::PointToMesh to(m);
  std::mt19937_64 rng(3);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = somewhere(rng, 5);
    const Vec3 q{std::abs(p.x) - 1, std::abs(p.y) - 2, std::abs(p.z) - 3};
    const double outside = norm({std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
    const double expected = outside > 0 ? outside : std::max({q.x, q.y, q.z});
    ASSERT_NEAR(to.signed_distance_mm(p), expected, 1e-12);
  }
  // Exactly beyond corners and edges, where single triangles disagree.
  EXPECT_NEAR(to.signed_distance_mm({3, 4, 5}), std::sqrt(12.0), 1e-12);
  EXPECT_NEAR(to.signed_distance_mm({0, 5, 7}), 5, 1e-12);
}

TEST(PointToMesh, SignsAtASharpSpike) {
  // A thin tetrahedral spike: near its tip the nearest triangle alone gives the wrong sign for many points.
  surface::TriMesh m;
  m.points_mm = {{0, 0, 10}, {1, 0, 0}, {-0.5, 0.8, 0}, {-0.5, -0.8, 0}};
  m.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  const surface::PointToMesh to(m);
  std::mt19937_64 rng(4);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p{uniform(rng, -1.2, 1.2), uniform(rng, -1, 1), uniform(rng, -1, 11.5)};
    double largest = -1e300;  // a convex body: inside where no face's plane lies below
    for (std::size_t t = 0; t < 4; ++t)
      largest = std::max(largest, dot(normalized(surface::triangle_normal(m, t)), p - m.points_mm[m.triangles[t][0]]));
    if (std::abs(largest) < 1e-9) continue;
    ASSERT_EQ(to.signed_distance_mm(p) < 0, largest < 0) << p.x << " " << p.y << " " << p.z;
    inside += largest < 0;
  }
  EXPECT_GT(inside, 1000);
}

TEST(PointToMesh, ScaleAndOffsetDoNotMatter) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    surface::TriMesh m = shapes::sphere(4, scale, {1e6, 1e6, -1e6});
    surface::TriMesh at_home = shapes::sphere(4, scale);
    const surface::PointToMesh far(m), home(at_home);
    std::mt19937_64 rng(5);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p = somewhere(rng, 3 * scale);
      const Vec3 world = m.origin_mm + p;  // rounded: what the far mesh is asked for
      ASSERT_NEAR(far.signed_distance_mm(world), home.signed_distance_mm(world - m.origin_mm), 1e-12 * scale);
    }
  }
}

TEST(PointToMesh, SameAnswersWithOneAndTwoThreads) {
  const surface::TriMesh m = shapes::lumpy(5), other = shapes::sphere(6, 90);
  set_thread_count(1);
  const std::vector<double> one = surface::PointToMesh(m).signed_distances_mm(other.points_mm);
  set_thread_count(2);
  const std::vector<double> two = surface::PointToMesh(m).signed_distances_mm(other.points_mm);
  EXPECT_EQ(one, two);
}

TEST(PointToMesh, BadInputIsRefused) {
  const auto code = [](const surface::TriMesh& m) {
    try {
      surface::PointToMesh to(m);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code({}), ExitCode::bad_input);
  surface::TriMesh m = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(code(m), ExitCode::ok);
  EXPECT_THROW(surface::PointToMesh(m).distance_mm({std::nan(""), 0, 0}), Error);
  m.points_mm[2].z = std::nan("");
  EXPECT_EQ(code(m), ExitCode::bad_input);
  m.points_mm[2].z = 1e200;
  EXPECT_EQ(code(m), ExitCode::bad_input);
  m = shapes::box({0, 0, 0}, {1, 1, 1});
  m.triangles[0][0] = 8;
  EXPECT_EQ(code(m), ExitCode::bad_input);
}

TEST(PointToMesh, CancelIsHeard) {
  const surface::TriMesh m = shapes::lumpy(5);
  std::atomic<bool> stop{true};
  EXPECT_THROW(surface::PointToMesh(m, Progress({}, &stop)), Cancelled);
}

}  // namespace
}  // namespace trephine
