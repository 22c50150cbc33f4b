// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign meshes made valid (M7): each fault alone with what is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing_faults.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace faults;

/// A surface that passes through itself: a tube along a figure of eight.
surface::TriMesh figure_of_eight() {
  surface::TriMesh m = torus();
  for (Vec3& p : m.points_mm) {
    const double angle = std::atan2(p.y, p.x), radius = std::hypot(p.x, p.y) - 9;
    const Vec3 centre{14 * std::sin(angle), 7 * std::sin(2 * angle), 1.5 * std::cos(angle)};
    const Vec3 tangent = normalized(Vec3{14 * std::cos(angle), 14 * std::cos(2 * angle), -1.5 * std::sin(angle)});
    const Vec3 across = normalized(cross(tangent, Vec3{0, 0, 1}));
    p = centre + across * radius + cross(across, tangent) * p.z;
  }
  return m;
}

TEST(Repair, AValidMeshStaysAsItIs) {
  const surface::TriMesh m = torus();
  const Result r = repaired(m);
  EXPECT_EQ(r.text("method"), "none");
  EXPECT_TRUE(r.mesh.points_mm == m.points_mm && r.mesh.triangles == m.triangles);
  EXPECT_LT(r.number("to_input_max_mm"), 1e-12);
}

TEST(Repair, BadIndicesAndNumbersAreRefused) {  // M5, M7
  const auto code = [](const surface::TriMesh& m) {
    try {
      Report r;
      value_of(r, meshing::repair(m, {}));
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  surface::TriMesh m = ball();
  m.triangles[7][1] = 1000000;
  EXPECT_EQ(code(m), ExitCode::bad_input);
  m = ball();
  m.points_mm[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(m), ExitCode::bad_input);
  EXPECT_EQ(code(surface::TriMesh()), ExitCode::bad_input);
  surface::TriMesh sheet;  // encloses nothing
  sheet.points_mm = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0}};
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
  EXPECT_EQ(code(sheet), ExitCode::quality);
}

TEST(Repair, OneFaultAtATime) {
  const surface::TriMesh whole = ball();
  const double volume = surface::volume_mm3(whole);
  const auto check = [&](const char* what, const surface::TriMesh& m, const char* counter, std::int64_t expected,
                         double tolerance = 1e-3) {
    const Result r = repaired(m);
    EXPECT_EQ(r.text("method"), "mended") << what;
    EXPECT_NEAR(surface::volume_mm3(r.mesh) / volume, 1, tolerance) << what;
    EXPECT_EQ(surface::topology_of(r.mesh).genus, 0) << what;
    if (expected < 0)
      EXPECT_GT(r.count(counter), 0) << what;
    else
      EXPECT_EQ(r.count(counter), expected) << what;
  };
  Random random(5);
  surface::TriMesh m = whole;
  unmerge(m, random);
  check("unmerged", m, "points_merged_count", std::int64_t(3 * whole.triangles.size() - whole.points_mm.size()));
  m = whole;
  unmerge(m, random, 1e-4);
  check("nearly merged", m, "points_merged_count", std::int64_t(3 * whole.triangles.size() - whole.points_mm.size()));
  m = whole;
  flip(m, random, 0.2);
  check("flipped", m, "flipped_count", -1);
  m = whole;
  flip(m, random, 1);
  check("inside out", m, "flipped_count", std::int64_t(m.triangles.size()));
  m = whole;
  duplicate(m, random, 0.1);
  const auto twice = std::int64_t(m.triangles.size() - whole.triangles.size());
  check("twice", m, "duplicates_dropped_count", twice);
  m = whole;
  for (int i = 0; i < 3; ++i) fin(m, random);
  check("fins", m, "fins_dropped_count", 3);
  m = whole;
  punch(m, random, 1, 2.5);
  check("hole", m, "holes_filled_count", 1, 0.02);
  m = whole;
  for (int i = 0; i < 8; ++i) sliver(m, random);
  check("slivers", m, "self_intersections_found_count", 0);
  m = whole;
  for (int i = 0; i < 3; ++i) spike(m, random);
  check("spikes", m, "self_intersections_found_count", -1, 0.05);
}

TEST(Repair, PiecesThatTouchOverlapOrLieWithin) {
  const surface::TriMesh a = box({0, 0, 0}, {10, 10, 10});
  // Two boxes that share an edge, with its two points in common.
  surface::TriMesh edge = together(a, box({10, 10, 0}, {20, 20, 10}));
  for (auto& t : edge.triangles)
    for (std::uint32_t& v : t)
      for (std::uint32_t w = 0; w < v; ++w)
        if (edge.points_mm[w] == edge.points_mm[v]) v = w;
  EXPECT_GT(surface::topology_of(edge).nonmanifold_edges, 0u);
  EXPECT_NEAR(surface::volume_mm3(repaired(edge).mesh), 2000, 0.1);
  // A whole face in common: the wall goes.
  EXPECT_NEAR(surface::volume_mm3(repaired(together(a, box({10, 0, 0}, {20, 10, 10}))).mesh), 2000, 0.1);
  // Overlapping: united.
  const Result both = repaired(together(ball(), ball(10, {9, 1, 2})));
  EXPECT_EQ(both.count("united_count"), 1);
  EXPECT_EQ(surface::topology_of(both.mesh).components, 1);
  // A cavity stays one, a shell about it is turned outwards.
  surface::TriMesh hollow = ball(5);
  for (auto& t : hollow.triangles) std::swap(t[0], t[1]);
  surface::TriMesh shell = together(ball(), hollow);
  for (auto& t : shell.triangles) std::swap(t[0], t[1]);
  const Result r = repaired(shell);
  EXPECT_EQ(surface::topology_of(r.mesh).components, 2);
}

TEST(Repair, LastResort) {
  const surface::TriMesh m = figure_of_eight();
  ASSERT_GT(meshing::check_validity(m).self_intersections, 0u);
  meshing::RepairParams p;
  p.recontour_voxels_count = 64;
  const Result r = repaired(m, p);
  EXPECT_EQ(r.text("method"), "recontoured");
  EXPECT_EQ(surface::topology_of(r.mesh).components, 1);
  EXPECT_EQ(surface::topology_of(r.mesh).genus, 2);
  EXPECT_LT(r.number("to_input_max_mm"), r.number("voxel_mm"));
  EXPECT_EQ(r.report.warnings.size(), 1u);
}

TEST(Repair, ScalesAndOffsets) {  // M6
  const auto soup = [](double scale, double offset) {
    Random random(2);
    surface::TriMesh m = contoured(sphere(18, scale, {offset, -offset, offset}));
    punch(m, random, 2, 0.2 * scale);
    unmerge(m, random);
    flip(m, random, 0.1);
    return m;
  };
  const double unit = surface::volume_mm3(repaired(soup(1, 0)).mesh);
  for (const double scale : {1e-6, 1e-3, 30.0, 1e6})
    for (const double offset : {0.0, 1e6}) {
      if (offset > 0 && scale < 1) continue;  // a lattice origin in doubles has no digits left for it
      const Result r = repaired(soup(scale, offset));
      EXPECT_EQ(r.text("method"), "mended");
      EXPECT_NEAR(surface::volume_mm3(r.mesh) / (unit * scale * scale * scale), 1, 1e-5) << scale << " " << offset;
    }
}

TEST(Repair, BeyondItsTimeTheLastResort) {  // M11
  surface::TriMesh m = contoured(sphere(120, 10));
  Random random(3);
  punch(m, random, 1, 2);
  meshing::RepairParams p;
  p.time_limit_s = 0.1;
  p.recontour_voxels_count = 32;
  EXPECT_EQ(repaired(m, p).text("method"), "recontoured");
  p.recontour_voxels_count = 0;
  Report r;
  try {
    value_of(r, meshing::repair(m, p));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::internal);
    EXPECT_NE(std::string(e.what()).find("limit"), std::string::npos) << e.what();
  }
}

TEST(Repair, SameBytesWithAnyThreads) {
  Random random(11);
  surface::TriMesh mended = torus();
  punch(mended, random, 2, 2);
  spike(mended, random);
  flip(mended, random, 0.1);
  unmerge(mended, random);
  meshing::RepairParams p;
  p.recontour_voxels_count = 48;
  for (const surface::TriMesh& m : {mended, figure_of_eight()}) {
    set_thread_count(1);
    const Result one = repaired(m, p);
    set_thread_count(2);
    const Result two = repaired(m, p);
    set_thread_count(0);
    EXPECT_TRUE(one.mesh.points_mm == two.mesh.points_mm && one.mesh.triangles == two.mesh.triangles)
        << one.text("method");
  }
}

}  // namespace
}  // namespace trephine
