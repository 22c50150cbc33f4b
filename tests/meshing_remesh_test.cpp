// SPDX-License-Identifier: GPL-3.0-or-later
// Even triangles within a bound.
#include "meshing/remesh.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace shapes;

Result remeshed(const surface::TriMesh& m, const meshing::RemeshParams& p) {
  Result r;
  r.mesh = value_of(r.report, meshing::remesh(m, p));
  const meshing::Validity v = meshing::check_validity(r.mesh);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  EXPECT_LE(r.number("deviation_max_mm"), p.max_deviation_mm);
  return r;
}

double mean_least_angle_deg(const surface::TriMesh& m) {
  double sum = 0;
  for (const auto& t : m.triangles) {
    double least = 180;
    for (int c = 0; c < 3; ++c) {
      const Vec3 a = normalized(m.points_mm[t[(c + 1) % 3]] - m.points_mm[t[c]]),
                 b = normalized(m.points_mm[t[(c + 2) % 3]] - m.points_mm[t[c]]);
      least = std::min(least, std::acos(std::min(1.0, dot(a, b))) * 180 / M_PI);
    }
    sum += least;
  }
  return sum / double(m.triangles.size());
}

TEST(Remesh, ASphereOfEvenTriangles) {
  const surface::TriMesh m = contoured(sphere(30, 20));
  meshing::RemeshParams p;
  p.edge_mm = 2;
  const Result r = remeshed(m, p);
  EXPECT_NEAR(r.number("edge_mean_mm"), 2, 0.2);
  EXPECT_GT(mean_least_angle_deg(r.mesh), 45);
  EXPECT_GT(mean_least_angle_deg(r.mesh), mean_least_angle_deg(m) + 10);
  EXPECT_NEAR(r.number("angle_min_deg"), mean_least_angle_deg(r.mesh), 1e-6);
  for (std::size_t i = 0; i < r.mesh.points_mm.size(); ++i) EXPECT_NEAR(norm(r.mesh.world_mm(i)), 20, 0.1);
  EXPECT_NEAR(surface::volume_mm3(r.mesh) / surface::volume_mm3(m), 1, 0.01);
}

TEST(Remesh, EdgesAreShortenedForTheBound) {
  const surface::TriMesh m = contoured(sphere(30, 20));
  meshing::RemeshParams p;
  p.edge_mm = 8;
  p.max_deviation_mm = 0.15;
  const Result r = remeshed(m, p);
  EXPECT_GT(std::get<std::int64_t>(*r.report.find("tries_count")), 1);
  EXPECT_LT(r.number("edge_mm"), 8);
  p.max_deviation_mm = 1e-5;
  Report refused;
  try {
    value_of(refused, meshing::remesh(m, p));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
  }
}

TEST(Remesh, SharpEdgesStayWhereAskedFor) {
  const surface::TriMesh m = contoured(sample(lattice(26, 26, 26, {1, 1, 1}, {-12.5, -12.5, -12.5}), [](Vec3 p) {
    return 10 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }));
  meshing::RemeshParams p;
  p.edge_mm = 2;
  p.max_deviation_mm = 1;
  p.feature_angle_deg = 40;
  const double kept = remeshed(m, p).number("deviation_max_mm");
  p.feature_angle_deg = 180;
  EXPECT_LT(kept, remeshed(m, p).number("deviation_max_mm"));
}

TEST(Remesh, BeyondItsTimeOrNotASurface) {  // M11
  meshing::RemeshParams p;
  p.edge_mm = 0.05;
  p.time_limit_s = 0.2;
  Report r;
  const auto code = [&](const surface::TriMesh& m) {
    try {
      value_of(r, meshing::remesh(m, p));
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code(contoured(sphere(30, 20))), ExitCode::internal);
  p = {};
  surface::TriMesh open = contoured(sphere(30, 20));
  open.triangles.pop_back();
  EXPECT_EQ(code(open), ExitCode::quality);
}

TEST(Remesh, SameBytesWithAnyThreads) {
  const surface::TriMesh m = contoured(sphere(16, 10));
  meshing::RemeshParams p;
  p.edge_mm = 1.5;
  set_thread_count(1);
  const Result one = remeshed(m, p);
  set_thread_count(2);
  const Result two = remeshed(m, p);
  set_thread_count(0);
  EXPECT_TRUE(one.mesh.points_mm == two.mesh.points_mm && one.mesh.triangles == two.mesh.triangles);
}

}  // namespace
}  // namespace trephine
