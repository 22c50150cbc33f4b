// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts whose volume is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "boolean/cut_surface.h"
#include "boolean/overlap.h"
#include "cut_surface_shapes.h"
#include "meshing/normals.h"
#include "report_of.h"

using namespace trephine;
using namespace trephine::shapes;
using Kind = boolean::Cutter::Kind;

namespace {

surface::TriMesh cut(const surface::TriMesh& m, const std::vector<boolean::Cutter>& c, Report& r,
                     boolean::CutSurfaceParams p = {}) {
  surface::TriMesh out = value_of(r, boolean::cut_surface(m, c, p));
  const meshing::Validity v = meshing::check_validity(out);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  return out;
}

ExitCode code_of(const surface::TriMesh& m, const std::vector<boolean::Cutter>& c, boolean::CutSurfaceParams p = {}) {
  try {
    Report r;
    value_of(r, boolean::cut_surface(m, c, p));
  } catch (const Error& e) {
    return e.code();
  }
  return ExitCode::ok;
}

/// removed_mm3 is the change of volume and lies within M9's bound of the exact one.
void expect_removed(const surface::TriMesh& before, const surface::TriMesh& after, const Report& r, double exact) {
  EXPECT_NEAR(surface::volume_mm3(before) - surface::volume_mm3(after),
              figure(r, "removed_mm3") + figure(r, "dropped_mm3"), 1e-6);
  EXPECT_NEAR(figure(r, "removed_mm3"), exact, std::max(0.5, 0.01 * exact));
}

}  // namespace

TEST(Overlap, OfTwoBoxesIsTheirBox) {
  Random r(1);
  for (int i = 0; i < 50; ++i) {
    const Vec3 a{r(-5, 0), r(-5, 0), r(-5, 0)}, b{r(1, 6), r(1, 6), r(1, 6)};
    const Vec3 c{r(-4, 0.9), r(-4, 0.9), r(-4, 0.9)}, d{r(1, 9), r(1, 9), r(1, 9)};
    double exact = 1;
    for (int k = 0; k < 3; ++k) exact *= std::min(b[k], d[k]) - std::max(a[k], c[k]);
    const Vec3 direction = i % 5 == 0 ? Vec3{0, 0, 1} : r.direction();
    surface::TriMesh second = box(c, d);
    second.origin_mm = {1, 2, 3};
    for (Vec3& p : second.points_mm) p = p - second.origin_mm;
    EXPECT_NEAR(boolean::overlap_mm3(box(a, b), second, direction), exact, 1e-9);
    EXPECT_NEAR(boolean::overlap_mm3(second, box(a, b), direction), exact, 1e-9);
  }
}

TEST(Overlap, OfASolidWithItselfAndWithNothing) {
  const surface::TriMesh m = vault(3);
  EXPECT_NEAR(boolean::overlap_mm3(m, m, {0.1, 0.2, 1}), surface::volume_mm3(m), 1e-6);
  EXPECT_NEAR(boolean::overlap_mm3(m, sphere(3, 20), {0, 0, 1}), 0, 1e-6);                        // in its cavity
  EXPECT_NEAR(boolean::overlap_mm3(m, sphere(3, 20, {100, 0, 0}), {1, 0, 0}), 0, 1e-6);           // beside it
  EXPECT_NEAR(boolean::overlap_mm3(m, sphere(3, 100), {1, 0, 0}), surface::volume_mm3(m), 1e-6);  // around it
}

TEST(Overlap, OfTwoBallsIsTheirLens) {
  const double a = 10, b = 7, d = 12;
  const double exact = pi * std::pow(a + b - d, 2) * (d * d + 2 * d * (a + b) - 3 * (a - b) * (a - b)) / (12 * d);
  boolean::Cutter s;
  s.kind = Kind::sphere;
  s.radius_mm = a;
  const surface::TriMesh ma = boolean::mesh_of(s, 0.003);
  s.radius_mm = b;
  s.position_mm = {4, -4, std::sqrt(d * d - 32)};
  EXPECT_NEAR(boolean::overlap_mm3(ma, boolean::mesh_of(s, 0.003), {0.3, 0.4, 1}), exact, 0.003 * exact);
}

TEST(CutSurface, ABurrHoleThroughAPlate) {
  for (const double tilt : {0.0, 0.2, 0.7}) {
    const surface::TriMesh m = plate(60, 6, 9);
    const boolean::Cutter c = cylinder({1.3, 0.4, 0}, {std::sin(tilt), 0, -std::cos(tilt)}, 7, 20, 20);
    Report r;
    const surface::TriMesh out = cut(m, {c}, r);
    expect_removed(m, out, r, pi * 49 * 6 / std::cos(tilt));
    EXPECT_EQ(surface::topology_of(out).genus, 1);
    EXPECT_EQ(figure(r, "cutters_count"), 1);
    EXPECT_EQ(figure(r, "triangles_count"), out.triangles.size());
    EXPECT_NEAR(boolean::free_radius_mm(out, c), 7, 0.06);
    EXPECT_GE(boolean::free_radius_mm(out, c), 6.5);
    EXPECT_EQ(boolean::free_radius_mm(m, c), 0);
  }
}

TEST(CutSurface, OtherKindsIntoAPlate) {
  const surface::TriMesh m = plate(60, 20, 7);
  Report r;
  boolean::Cutter c;
  c.kind = Kind::sphere;
  c.radius_mm = 8;
  c.position_mm = {2, 3, 3};  // a cap of height 5
  expect_removed(m, cut(m, {c}, r), r, pi * 25 * (3 * 8 - 5) / 3);

  c.kind = Kind::ellipsoid;
  c.position_mm.z = 0;
  c.direction = {0, 0, -1};
  c.radii_mm = {4, 9, 6};
  r = {};
  expect_removed(m, cut(m, {c}, r), r, 2 * pi / 3 * 4 * 9 * 6);

  c.kind = Kind::cone;
  c.radius_mm = 8;
  c.end_radius_mm = 0;
  c.depth_mm = 10;
  c.above_mm = 5;
  r = {};
  expect_removed(m, cut(m, {c}, r), r, pi * 64 * 10 / 3);

  c = {};
  c.kind = Kind::mesh;
  c.mesh = std::make_shared<surface::TriMesh>(box({-3.1, -4.2, -5.3}, {6.4, 7.5, 8.6}));
  r = {};
  expect_removed(m, cut(m, {c}, r), r, 9.5 * 11.7 * 5.3);
}

TEST(CutSurface, AHoleThroughASkullJoinsItsSurfaces) {
  const surface::TriMesh m = vault(4);
  ASSERT_EQ(surface::topology_of(m).components, 2);
  const boolean::Cutter c = cylinder({0, 0, 42}, {0, 0, -1}, 7, 10, 15);
  Report r;
  const surface::TriMesh out = cut(m, {c}, r);
  EXPECT_EQ(surface::topology_of(out).components, 1);
  EXPECT_EQ(surface::topology_of(out).genus, 0);
  EXPECT_GE(boolean::free_radius_mm(out, c), 6.5);
  // Through both walls: two holes, of one cutter.
  const boolean::Cutter both = cylinder({0, 0, 50}, {0, 0, -1}, 7, 10, 110);
  r = {};
  const surface::TriMesh twice = cut(m, {both}, r);
  EXPECT_EQ(surface::topology_of(twice).genus, 1);
  EXPECT_NEAR(figure(r, "removed_mm3"), boolean::overlap_mm3(m, boolean::mesh_of(both, 0.002), {0.1, 0.3, 1}), 5);
  // A blind hole is as free as it is wide, a hole that was not drilled is not.
  const boolean::Cutter blind = cylinder({42, 0, 0}, {-1, 0, 0}, 4, 10, 4);
  r = {};
  EXPECT_GE(boolean::free_radius_mm(cut(m, {blind}, r), blind), 3.5);
}

TEST(CutSurface, WhatTheCutDoesNotTouchStaysAsItIs) {
  surface::TriMesh m = vault(4);
  meshing::compute_normals(m, {});
  Report r;
  const boolean::Cutter c = cylinder({0, 0, 42}, {0, 0, -1}, 7, 10, 15);
  const surface::TriMesh out = cut(m, {c}, r);
  const auto corners = [](const surface::TriMesh& s, std::size_t t) {
    std::array<std::array<double, 3>, 3> k;
    for (int i = 0; i < 3; ++i) {
      const Vec3 p = s.world_mm(s.triangles[t][i]);
      k[i] = {p.x, p.y, p.z};
    }
    std::rotate(k.begin(), std::min_element(k.begin(), k.end()), k.end());
    return k;
  };
  std::set<std::array<std::array<double, 3>, 3>> after;
  for (std::size_t t = 0; t < out.triangles.size(); ++t) after.insert(corners(out, t));
  const surface::DistanceFunction d = boolean::distance_to(c);
  std::size_t far = 0;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto k = corners(m, t);
    const double least = std::min(
        {d(m.world_mm(m.triangles[t][0])), d(m.world_mm(m.triangles[t][1])), d(m.world_mm(m.triangles[t][2]))});
    if (least < 6) continue;  // longer than its edges
    ++far;
    EXPECT_TRUE(after.count(k));
  }
  EXPECT_GT(far, 9000u);
  ASSERT_EQ(out.normals.size(), out.points_mm.size());
  // At the rim of the bore no normal is left of what was there before.
  surface::TriMesh again = out;
  meshing::compute_normals(again, {});
  EXPECT_TRUE(std::equal(again.normals.begin(), again.normals.end(), out.normals.begin()));
}

TEST(CutSurface, TheSameWhateverTheThreadsAndTheRun) {
  const surface::TriMesh m = vault(4);
  const std::vector<boolean::Cutter> c{cylinder({0, 0, 42}, {0, 0, -1}, 7, 10, 15),
                                       cylinder({40, 3, 0}, {-1, 0, 0}, 3, 10, 15)};
  Report r;
  const int threads = thread_count();
  set_thread_count(1);
  const surface::TriMesh one = cut(m, c, r);
  set_thread_count(4);
  const surface::TriMesh four = cut(m, c, r);
  set_thread_count(threads);
  EXPECT_TRUE(one.points_mm == four.points_mm);
  EXPECT_TRUE(one.triangles == four.triangles);
}

TEST(CutSurface, DegeneratePoses) {
  const surface::TriMesh m = plate(60, 6, 6);
  const double r7 = pi * 49;
  struct Case {
    const char* name;
    boolean::Cutter cutter;
    double exact;
  };
  const Case cases[] = {
      {"bottom on the upper side", cylinder({1, 2, 0}, {0, 0, -1}, 7, 5, 1e-3), r7 * 1e-3},
      {"top on the upper side", cylinder({1, 2, 0}, {0, 0, -1}, 7, 0, 3), r7 * 3},
      {"bottom on the lower side", cylinder({1, 2, 0}, {0, 0, -1}, 7, 5, 6), r7 * 6},
      {"both on the sides, over a point of the mesh", cylinder({0, 0, 0}, {0, 0, -1}, 7, 0, 6), r7 * 6},
      {"lies on it, outside", cylinder({1, 2, 7}, {1, 0, 0}, 7, 5, 6), 0},
      {"lies in it, tangent", cylinder({1, 2, -3}, {1, 0, 0}, 3, 5, 6), pi * 9 * 11},
      {"beside it, tangent", cylinder({37, 2, -3}, {0, 0, -1}, 7, 20, 20), 0},
      {"inside it", cylinder({1, 2, -2}, {0, 0, -1}, 1, 1, 2), pi * 3},
      {"far off", cylinder({100, 200, 300}, {0, 0, -1}, 7, 20, 20), 0},
      {"on its edge", cylinder({30, 0, 0}, {0, 0, -1}, 7, 20, 20), r7 * 3},
      {"on its corner", cylinder({30, 30, 0}, {0, 0, -1}, 7, 20, 20), r7 * 1.5},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    Report r;
    const surface::TriMesh out = cut(m, {c.cutter}, r);
    expect_removed(m, out, r, c.exact);
    EXPECT_LE(figure(r, "moved_mm"), 0.05);
    if (c.exact == 0 && figure(r, "removed_mm3") == 0) {
      EXPECT_TRUE(out.points_mm == m.points_mm);
      EXPECT_TRUE(out.triangles == m.triangles);
      EXPECT_EQ(r.warnings.size(), 1u);
    }
  }
  // A box with coplanar faces, and with the same faces.
  boolean::Cutter b;
  b.kind = Kind::mesh;
  b.mesh = std::make_shared<surface::TriMesh>(box({-10, -10, -6}, {10, 10, 0}));
  Report r;
  expect_removed(m, cut(m, {b}, r), r, 400 * 6);
  b.mesh = std::make_shared<surface::TriMesh>(box({-10, -10, 0}, {10, 10, 6}));
  r = {};
  expect_removed(m, cut(m, {b}, r), r, 0);
}

TEST(CutSurface, DrilledTwice) {
  const surface::TriMesh m = vault(4);
  const boolean::Cutter c = cylinder({1, 2, 42}, normalized({0.1, 0, -1}), 7, 10, 15);
  Report r;
  const surface::TriMesh once = cut(m, {c}, r);
  const double removed = figure(r, "removed_mm3");
  r = {};
  const surface::TriMesh twice = cut(once, {c}, r);
  EXPECT_NEAR(figure(r, "removed_mm3"), 0, 0.5);
  r = {};
  const surface::TriMesh both = cut(m, {c, c}, r);
  EXPECT_NEAR(figure(r, "removed_mm3"), removed, 0.5);
  EXPECT_NEAR(figure(r, "cutter_2.removed_mm3"), 0, 0.5);
  // Wider after narrower, with the same axis.
  boolean::Cutter wide = c;
  wide.radius_mm = 7.5;
  r = {};
  expect_removed(once, cut(once, {wide}, r), r, removed * (7.5 * 7.5 / 49 - 1));
}

TEST(CutSurface, LoosePiecesGo) {
  const surface::TriMesh m = plate(60, 6, 6);
  boolean::Cutter c;
  c.kind = Kind::mesh;
  c.mesh = std::make_shared<surface::TriMesh>(tube(2, 4, -10, 10, 48));
  const double core = 48.0 / 2 * std::sin(2 * pi / 48) * 4 * 6;
  boolean::CutSurfaceParams p;
  p.min_component_mm3 = 100;
  Report r;
  const surface::TriMesh without = cut(m, {c}, r, p);
  EXPECT_EQ(surface::topology_of(without).components, 1);
  EXPECT_EQ(figure(r, "dropped_count"), 1);
  EXPECT_NEAR(figure(r, "dropped_mm3"), core, 0.1);
  expect_removed(m, without, r, 3 * core);
  p.min_component_mm3 = 50;
  r = {};
  EXPECT_EQ(surface::topology_of(cut(m, {c}, r, p)).components, 2);
  EXPECT_EQ(figure(r, "dropped_count"), 0);
}

TEST(CutSurface, AnyOrderOfMagnitudeAndPlace) {
  for (const double scale : {1e-2, 1.0, 1e2}) {
    surface::TriMesh m = plate(60 * scale, 6 * scale, 5);
    m.origin_mm = {1e5, -2e5, 3e5};
    boolean::Cutter c =
        cylinder(m.origin_mm + Vec3{1.3, 0.4, 0} * scale, normalized({0.3, 0, -1}), 7 * scale, 20 * scale, 20 * scale);
    boolean::CutSurfaceParams p;
    p.cutter_deviation_mm = 0.01 * scale;
    p.min_component_mm3 = 0;
    Report r;
    cut(m, {c}, r, p);
    EXPECT_NEAR(figure(r, "removed_mm3") / (pi * 49 * 6 * std::sqrt(1.09) * std::pow(scale, 3)), 1, 0.01) << scale;
  }
}

TEST(CutSurface, WhatCannotBeCutIsRefused) {
  const surface::TriMesh m = vault(3);
  const boolean::Cutter c = cylinder({0, 0, 42}, {0, 0, -1}, 7, 10, 15);
  surface::TriMesh bad = m;
  bad.points_mm[5].x = std::nan("");
  EXPECT_EQ(code_of(bad, {c}), ExitCode::bad_input);
  bad = m;
  bad.triangles.pop_back();
  EXPECT_EQ(code_of(bad, {c}), ExitCode::quality);
  bad = m;
  bad.points_mm[bad.triangles[7][0]] = {0, 0, 0};  // through everything
  EXPECT_EQ(code_of(bad, {c}), ExitCode::quality);
  boolean::Cutter d = c;
  d.radius_mm = -1;
  EXPECT_EQ(code_of(m, {d}), ExitCode::bad_input);
  d = {};
  d.kind = Kind::sphere;
  d.radius_mm = 100;
  EXPECT_EQ(code_of(m, {d}), ExitCode::quality);  // nothing is left
  boolean::CutSurfaceParams hurried;
  hurried.time_limit_s = 1e-4;
  EXPECT_EQ(code_of(m, {c}, hurried), ExitCode::internal);  // M11
  EXPECT_EQ(code_of(m, {}), ExitCode::ok);
  const std::atomic<bool> cancel{true};
  Report r;
  EXPECT_THROW(value_of(r, boolean::cut_surface(m, {c}, {}, Progress(nullptr, &cancel))), Cancelled);
}
