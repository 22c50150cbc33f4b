// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "boolean/cutter.h"
#include "meshing/validity.h"
#include "random.h"
#include "surface/point_to_mesh.h"
#include "surface_shapes.h"

using namespace trephine;
using Kind = boolean::Cutter::Kind;

namespace {

/// One of each kind, in any pose.
std::vector<boolean::Cutter> cutters(Random& r) {
  std::vector<boolean::Cutter> all;
  for (const Kind k : {Kind::cylinder, Kind::cone, Kind::cone, Kind::ellipsoid, Kind::sphere, Kind::mesh}) {
    boolean::Cutter c;
    c.kind = k;
    c.position_mm = {100 * r(), -50 * r(), 200 * r() - 100};
    c.direction = r.direction();
    c.across = normalized(cross(c.direction, r.direction()));
    c.radius_mm = 1 + 9 * r();
    c.end_radius_mm = all.size() == 1 ? 0 : 1 + 2 * r();
    c.depth_mm = 10 + 10 * r();
    c.above_mm = 5 * r();
    c.radii_mm = {1 + 9 * r(), 1 + 9 * r(), 1 + 9 * r()};
    if (k == Kind::mesh) c.mesh = std::make_shared<surface::TriMesh>(shapes::sphere(3, 6, c.position_mm));
    all.push_back(c);
  }
  return all;
}

}  // namespace

TEST(Cutter, TheMeshIsValidHasTheVolumeAndLiesWithinTheDeviation) {
  Random r(1);
  for (int i = 0; i < 10; ++i)
    for (const boolean::Cutter& c : cutters(r)) {
      const double dev = i % 2 ? 0.02 : 0.1;
      boolean::check_cutter(c, ExitCode::bad_input);
      const surface::TriMesh m = boolean::mesh_of(c, dev);
      EXPECT_TRUE(meshing::check_validity(m).valid()) << int(c.kind) << " " << meshing::check_validity(m).text();
      EXPECT_NEAR(surface::volume_mm3(m) / boolean::volume_mm3(c), 1, 1e-9);
      const surface::DistanceFunction d = boolean::distance_to(c);
      const surface::Bounds b = boolean::bounds_of(c);
      for (const auto& t : m.triangles)
        for (int k = 0; k < 4; ++k) {
          const Vec3 p = k < 3 ? m.world_mm(t[k]) : (m.world_mm(t[0]) + m.world_mm(t[1]) + m.world_mm(t[2])) / 3;
          EXPECT_LE(std::abs(d(p)), dev + 1e-9);
          for (int a = 0; a < 3; ++a) {
            EXPECT_GE(p[a], b.min_mm[a] - dev);
            EXPECT_LE(p[a], b.max_mm[a] + dev);
          }
        }
    }
}

TEST(Cutter, BoundsAreTight) {
  Random r(2);
  for (const boolean::Cutter& c : cutters(r)) {
    const surface::Bounds b = boolean::bounds_of(c), m = surface::bounds_of(boolean::mesh_of(c, 0.002));
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(b.min_mm[a], m.min_mm[a], 0.02) << int(c.kind);
      EXPECT_NEAR(b.max_mm[a], m.max_mm[a], 0.02) << int(c.kind);
    }
  }
}

TEST(Cutter, DistancesAgreeWithThoseToAFineMesh) {
  Random r(3);
  for (const boolean::Cutter& c : cutters(r)) {
    const surface::TriMesh fine = boolean::mesh_of(c, 0.002);
    const surface::PointToMesh tree(fine);
    const surface::DistanceFunction d = boolean::distance_to(c);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = c.position_mm + r.direction() * (25 * r());
      EXPECT_NEAR(d(p), tree.signed_distance_mm(p), 0.0021) << int(c.kind);
    }
  }
}

TEST(Cutter, EllipsoidDistanceIsThatOfItsNearestPoint) {
  // Points along the normal of a surface point, within the least radius of curvature, have it as their nearest.
  Random r(4);
  for (int i = 0; i < 2000; ++i) {
    boolean::Cutter c;
    c.kind = Kind::ellipsoid;
    c.position_mm = {10, 20, 30};
    c.direction = {0, 0, 1};
    c.radii_mm = {0.5 + 20 * r(), 0.5 + 20 * r(), i % 3 ? 0.5 + 20 * r() : 5};
    if (i % 3 == 0) c.radii_mm[1] = 5;
    const auto& e = c.radii_mm;
    Vec3 u = r.direction();
    if (i % 5 == 0) u[i / 5 % 3] = 0;
    if (i % 7 == 0) u = {double(i % 2), double((i + 1) % 2), 0};
    u = normalized(u);
    const Vec3 on{e[0] * u.x, e[1] * u.y, e[2] * u.z};
    const Vec3 n = normalized({on.x / (e[0] * e[0]), on.y / (e[1] * e[1]), on.z / (e[2] * e[2])});
    const double least = std::min({e[0], e[1], e[2]}), most = std::max({e[0], e[1], e[2]});
    const double h = (2 * r() - 1) * least * least / most;
    EXPECT_NEAR(boolean::distance_to(c)(c.position_mm + on + n * h), h, 1e-9 * most);
  }
}

TEST(Cutter, WhatIsWrongIsNamed) {
  const auto field_of = [](const boolean::Cutter& c) -> std::string {
    try {
      boolean::check_cutter(c, ExitCode::bad_config);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_config);
      return e.field();
    }
    return "";
  };
  const double nan = std::nan("");
  boolean::Cutter c;
  EXPECT_EQ(field_of(c), "");
  for (const double bad : {0.0, -1.0, 1e5, nan, HUGE_VAL}) {
    boolean::Cutter d;
    d.radius_mm = bad;
    EXPECT_EQ(field_of(d), "radius_mm");
    d = c;
    d.depth_mm = bad;
    EXPECT_EQ(field_of(d), "depth_mm");
    d.kind = Kind::ellipsoid;
    d.radii_mm[1] = bad;
    EXPECT_EQ(field_of(d), "radii_mm");
  }
  c.direction = {0, 0, 2};
  EXPECT_EQ(field_of(c), "direction");
  c = {};
  c.position_mm.y = nan;
  EXPECT_EQ(field_of(c), "position_mm");
  c = {};
  c.kind = Kind::cone;
  c.radius_mm = 5;
  c.end_radius_mm = 20;
  EXPECT_EQ(field_of(c), "above_mm");
  c = {};
  c.kind = Kind::ellipsoid;
  c.across = c.direction;
  EXPECT_EQ(field_of(c), "across");
  c = {};
  c.kind = Kind::mesh;
  EXPECT_EQ(field_of(c), "mesh");
  surface::TriMesh open = shapes::sphere(2, 5);
  open.triangles.pop_back();
  c.mesh = std::make_shared<surface::TriMesh>(open);
  EXPECT_EQ(field_of(c), "mesh");
}

TEST(Cutter, JsonComesBackAsItWas) {
  Random r(5);
  auto all = cutters(r);
  all[0].name = "burr_hole_1";
  all.back().mesh_file = "meshes/bit.stl";
  const std::string json = boolean::cutters_json(all);
  const auto back = boolean::parse_cutters_json(json);
  ASSERT_EQ(back.size(), all.size());
  EXPECT_EQ(boolean::cutters_json(back), json);
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    EXPECT_EQ(back[i].kind, all[i].kind);
    EXPECT_EQ(boolean::volume_mm3(back[i]), boolean::volume_mm3(all[i]));
    EXPECT_TRUE(back[i].position_mm == all[i].position_mm);
  }
  EXPECT_EQ(back[0].name, "burr_hole_1");
  EXPECT_EQ(back.back().mesh_file, "meshes/bit.stl");

  const auto field_of = [](const std::string& text) -> std::string {
    try {
      boolean::parse_cutters_json(text);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field();
    }
    return "none";
  };
  EXPECT_EQ(field_of("{"), "cutters");
  EXPECT_EQ(field_of("[]"), "cutters");
  EXPECT_EQ(field_of(R"({"cutters": []})"), "none");
  EXPECT_EQ(field_of(R"({"cutters": [{"kind": "cube"}]})"), "cutters[0].kind");
  EXPECT_EQ(field_of(R"({"cutters": [{"kind": "sphere", "position_mm": [0, 0, 0]}]})"), "cutters[0].radius_mm");
  EXPECT_EQ(field_of(R"({"cutters": [{"kind": "sphere", "position_mm": [0, 0], "radius_mm": 1}]})"),
            "cutters[0].position_mm");
  EXPECT_EQ(field_of(R"({"cutters": [{"kind": "sphere", "position_mm": [0, 0, 0], "radius_mm": -1}]})"),
            "cutters[0]: radius_mm");
  EXPECT_EQ(field_of(R"({"cutters": [{"kind": "sphere", "position_mm": [0, 0, 0], "radius_mm": 1, "x": 1}]})"),
            "cutters[0]");
}
