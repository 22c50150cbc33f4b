// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation against analytic surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "metrics/deviation.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

double truth_of_sphere(Vec3 p, Vec3 centre, double radius) { return norm(p - centre) - radius; }

TEST(Deviation, SpheresOfDifferentRadius) {
  const Vec3 centre{10, -20, 500};
  const surface::TriMesh outer = shapes::sphere(6, 30.1, centre), inner = shapes::sphere(5, 30.0, centre);
  const metrics::Deviation d = metrics::measure_deviation(outer, inner);
  // Facets lie inside of their sphere: at level 5, the coarser, edges are up to 0.0414 rad, circumradii up to 0.0239.
  const double sag = 30 * 0.0239 * 0.0239 / 2;
  for (const metrics::DeviationStats* s : {&d.mesh_to_reference, &d.reference_to_mesh, &d.both}) {
    EXPECT_NEAR(s->max_mm, 0.1, sag);
    EXPECT_NEAR(s->p99_mm, 0.1, sag);
    EXPECT_NEAR(s->rms_mm, 0.1, sag);
    EXPECT_NEAR(s->mean_mm, 0.1, sag);
    EXPECT_NEAR(s->bias_mm, 0.1, sag);
    EXPECT_LE(s->mean_mm, s->rms_mm);
    EXPECT_LE(s->rms_mm, s->max_mm);
  }
  EXPECT_EQ(d.both.samples, 400000u);
  const metrics::Deviation back = metrics::measure_deviation(inner, outer);
  EXPECT_NEAR(back.both.bias_mm, -0.1, sag);
  EXPECT_NEAR(back.both.max_mm, d.both.max_mm, 1e-12);
}

TEST(Deviation, OffsetPlanesAreExact) {
  const surface::TriMesh a = shapes::plane(100, 0, 7), b = shapes::plane(100, 0.25, 3);
  const metrics::Deviation d = metrics::measure_deviation(b, a);
  EXPECT_NEAR(d.both.max_mm, 0.25, 1e-12);
  EXPECT_NEAR(d.both.p99_mm, 0.25, 1e-12);
  EXPECT_NEAR(d.both.rms_mm, 0.25, 1e-12);
  EXPECT_NEAR(d.both.bias_mm, 0.25, 1e-12);
}

TEST(Deviation, IsTwoSided) {
  // A second plate that the mesh lacks is seen only from the reference.
  const surface::TriMesh mesh = shapes::plane(100, 0, 4);
  surface::TriMesh reference = mesh;
  const surface::TriMesh second = shapes::plane(100, 7, 4);
  for (const Vec3& p : second.points_mm) reference.points_mm.push_back(p);
  for (auto t : second.triangles) {
    for (auto& v : t) v += std::uint32_t(mesh.points_mm.size());
    reference.triangles.push_back(t);
  }
  const metrics::Deviation d = metrics::measure_deviation(mesh, reference);
  EXPECT_EQ(d.mesh_to_reference.max_mm, 0);
  EXPECT_NEAR(d.reference_to_mesh.max_mm, 7, 1e-12);
  EXPECT_NEAR(d.reference_to_mesh.mean_mm, 3.5, 0.01);  // half of the area
  EXPECT_NEAR(d.both.mean_mm, 1.75, 0.01);
}

TEST(Deviation, StatisticsAreByAreaNotByVertex) {
  // Two plates of 100 x 100 mm, 1 mm and 3 mm off, one with 10,000 times as many triangles.
  surface::TriMesh mesh = shapes::plane(100, 1, 100);
  const surface::TriMesh coarse = shapes::plane(100, 3, 1);
  const auto shift = std::uint32_t(mesh.points_mm.size());
  for (Vec3 p : coarse.points_mm) mesh.points_mm.push_back(p + Vec3{200, 0, 0});
  for (auto t : coarse.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  const surface::TriMesh reference = shapes::plane(300, 0, 1);
  const metrics::DeviationStats s = metrics::measure_deviation(mesh, reference).mesh_to_reference;
  EXPECT_NEAR(s.mean_mm, 2, 0.001);
  EXPECT_NEAR(s.rms_mm, std::sqrt(5.0), 0.001);
}

TEST(Deviation, ASingleVertexOffIsInTheMax) {
  surface::TriMesh mesh = shapes::plane(100, 0, 200);
  const surface::TriMesh reference = mesh;
  mesh.points_mm[100 * 201 + 77].z = 2.5;
  metrics::DeviationParams params;
  params.sample_count = 1000;
  EXPECT_NEAR(metrics::measure_deviation(mesh, reference, params).mesh_to_reference.max_mm, 2.5, 1e-12);
  // An unused point is none of the surface.
  mesh = reference;
  mesh.points_mm.push_back({0, 0, 1000});
  EXPECT_EQ(metrics::measure_deviation(mesh, reference, params).both.max_mm, 0);
}

TEST(Deviation, QuantileIsTheNearestRank) {
  // 1.2 % of the area lies 5 mm off, then 0.8 %: p99 is 5 or 0.
  for (const auto& [side, p99] : {std::pair{0.12, 5.0}, std::pair{0.08, 0.0}}) {
    surface::TriMesh mesh = shapes::plane(1, 0, 1);
    const surface::TriMesh lifted = shapes::plane(1, 5, 1);
    for (Vec3 p : lifted.points_mm) mesh.points_mm.push_back({p.x * side, p.y * 0.1, p.z});
    for (auto t : lifted.triangles) mesh.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
    EXPECT_NEAR(metrics::measure_deviation(mesh, shapes::plane(1, 0, 1)).mesh_to_reference.p99_mm, p99, 1e-12);
  }
}

TEST(Deviation, ToTheTruthFromBothSides) {
  const Vec3 centre{1, 2, 3};
  const double radius = 40;
  const surface::DistanceFunction truth = [&](Vec3 p) { return truth_of_sphere(p, centre, radius); };
  const surface::TriMesh truth_mesh = shapes::sphere(6, radius, centre);
  // A sphere 0.3 mm off to +x: distances are 0.3 |cos|, of which RMS 0.3 / sqrt 3, mean 0.15, bias 0.
  const surface::TriMesh mesh = shapes::sphere(6, radius, centre + Vec3{0.3, 0, 0});
  const metrics::Deviation d = metrics::measure_deviation_to_truth(mesh, truth, truth_mesh);
  for (const metrics::DeviationStats* s : {&d.mesh_to_reference, &d.reference_to_mesh}) {
    EXPECT_NEAR(s->max_mm, 0.3, 0.006);
    EXPECT_NEAR(s->rms_mm, 0.3 / std::sqrt(3.0), 0.006);
    EXPECT_NEAR(s->mean_mm, 0.15, 0.006);
    EXPECT_NEAR(s->bias_mm, 0, 0.006);
    EXPECT_NEAR(s->p99_mm, 0.297, 0.006);
  }
}

TEST(Deviation, PointsOutsideOfWhereTheTruthIsKnownAreLeftOut) {
  // The lower half of a sphere with a lid: the lid is no part of the truth, and lies up to 40 mm from it.
  const double radius = 40;
  const surface::DistanceFunction truth = [&](Vec3 p) { return truth_of_sphere(p, {}, radius); };
  const surface::TriMesh truth_mesh = shapes::sphere(6, radius);
  surface::TriMesh mesh = truth_mesh;
  for (Vec3& p : mesh.points_mm) p.z = std::min(p.z, 0.0);
  const auto below = [](double z_mm) { return [z_mm](Vec3 p) { return p.z <= z_mm; }; };
  const metrics::Deviation all = metrics::measure_deviation_to_truth(mesh, truth, truth_mesh);
  EXPECT_NEAR(all.mesh_to_reference.max_mm, 40, 0.01);
  const metrics::Deviation seen = metrics::measure_deviation_to_truth(mesh, truth, truth_mesh, {}, below(-1));
  EXPECT_LT(seen.both.max_mm, 0.01);
  EXPECT_LT(seen.both.samples, all.both.samples);
  EXPECT_GT(seen.both.samples, all.both.samples / 3);
  EXPECT_THROW(metrics::measure_deviation_to_truth(mesh, truth, truth_mesh, {}, below(-100)), Error);
}

TEST(Deviation, FarFromTheFramesOrigin) {
  const Vec3 far{1e6, -1e6, 1e6};
  const metrics::Deviation home = metrics::measure_deviation(shapes::lumpy(4), shapes::sphere(4, 90));
  const metrics::Deviation away = metrics::measure_deviation(shapes::lumpy(4, far), shapes::sphere(4, 90, far));
  EXPECT_NEAR(away.both.max_mm, home.both.max_mm, 1e-8);
  EXPECT_NEAR(away.both.rms_mm, home.both.rms_mm, 1e-8);
}

TEST(Deviation, SameWithOneAndTwoThreads) {
  const surface::TriMesh a = shapes::lumpy(5), b = shapes::lumpy(4);
  const auto flat = [&] {
    const metrics::Deviation d = metrics::measure_deviation(a, b);
    std::vector<double> v;
    for (const metrics::DeviationStats* s : {&d.mesh_to_reference, &d.reference_to_mesh, &d.both})
      v.insert(v.end(), {s->max_mm, s->p99_mm, s->rms_mm, s->mean_mm, s->bias_mm});
    return v;
  };
  set_thread_count(1);
  const auto one = flat();
  set_thread_count(2);
  EXPECT_EQ(one, flat());
}

TEST(Deviation, PointsLieEvenlyOnTheSurface) {
  const surface::TriMesh m = shapes::box({0, 0, 0}, {1, 2, 3});
  const std::vector<Vec3> points = metrics::points_on_surface(m, 22000);
  ASSERT_EQ(points.size(), 22000u);
  int on_top = 0, left_half = 0;
  for (const Vec3& p : points) {
    const double off = std::min({p.x, 1 - p.x, p.y, 2 - p.y, p.z, 3 - p.z});
    EXPECT_NEAR(off, 0, 1e-12);
    on_top += p.z > 3 - 1e-9;
    left_half += p.x < 0.5;
  }
  EXPECT_NEAR(on_top, 2000, 4);  // 2 of 22 mm2, stratified
  EXPECT_NEAR(left_half, 11000, 200);
  EXPECT_EQ(points, metrics::points_on_surface(m, 22000));
}

TEST(Deviation, BadInputIsRefused) {
  const surface::TriMesh good = shapes::box({0, 0, 0}, {1, 1, 1});
  surface::TriMesh nan = good, flat = good;
  nan.points_mm[0].x = std::nan("");
  for (Vec3& p : flat.points_mm) p = {};
  for (const surface::TriMesh& bad : {surface::TriMesh{}, nan, flat}) {
    for (const bool first : {true, false}) try {
        metrics::measure_deviation(first ? bad : good, first ? good : bad);
        ADD_FAILURE();
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::bad_input);
      }
  }
}

}  // namespace
}  // namespace trephine
