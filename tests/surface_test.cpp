// SPDX-License-Identifier: GPL-3.0-or-later
// The plain mesh: what topology_of says of meshes whose faults are known, and the component helpers.
#include "surface/arc.h"
#include "surface/trimesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "base/pi.h"

namespace trephine {
namespace {

surface::TriMesh tetrahedron(Vec3 at = {}, double size = 1) {
  surface::TriMesh m;
  m.points_mm = {at, at + Vec3{size, 0, 0}, at + Vec3{0, size, 0}, at + Vec3{0, 0, size}};
  m.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return m;
}

void append(surface::TriMesh& to, const surface::TriMesh& from) {
  const auto base = static_cast<std::uint32_t>(to.points_mm.size());
  to.points_mm.insert(to.points_mm.end(), from.points_mm.begin(), from.points_mm.end());
  for (const auto& t : from.triangles) to.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
}

/// A torus of n x n quads.
surface::TriMesh torus(std::uint32_t n) {
  surface::TriMesh m;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double a = 2 * M_PI * i / n, b = 2 * M_PI * j / n;
      m.points_mm.push_back(
          {(10 + 3 * std::cos(b)) * std::cos(a), (10 + 3 * std::cos(b)) * std::sin(a), 3 * std::sin(b)});
    }
  const auto at = [n](std::uint32_t i, std::uint32_t j) { return (i % n) * n + j % n; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

TEST(Surface, TetrahedronIsClosedAndManifold) {
  const surface::TriMesh m = tetrahedron();
  const surface::Topology t = surface::topology_of(m);
  EXPECT_EQ(t.points, 4u);
  EXPECT_EQ(t.edges, 6u);
  EXPECT_TRUE(t.closed());
  EXPECT_TRUE(t.manifold());
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.euler_characteristic, 2);
  EXPECT_EQ(t.genus, 0);
  EXPECT_EQ(t.degenerate_triangles, 0u);
  EXPECT_NEAR(surface::volume_mm3(m), 1.0 / 6, 1e-15);
  EXPECT_NEAR(surface::area_mm2(m), 1.5 + std::sqrt(3) / 2, 1e-14);
}

TEST(Surface, GenusAndComponents) {
  surface::TriMesh m = torus(20);
  EXPECT_EQ(surface::topology_of(m).genus, 1);
  EXPECT_NEAR(surface::volume_mm3(m), 2 * M_PI * M_PI * 10 * 9, 0.05 * 2 * M_PI * M_PI * 90);
  append(m, torus(12));
  append(m, tetrahedron());
  const surface::Topology t = surface::topology_of(m);
  EXPECT_EQ(t.components, 3);
  EXPECT_EQ(t.genus, 2);
}

TEST(Surface, FaultsAreCounted) {
  surface::TriMesh open = tetrahedron();
  open.triangles.pop_back();
  EXPECT_EQ(surface::topology_of(open).boundary_edges, 3u);
  EXPECT_EQ(surface::topology_of(open).genus, -1);

  surface::TriMesh flipped = tetrahedron();
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_EQ(surface::topology_of(flipped).misoriented_edges, 3u);

  surface::TriMesh doubled = tetrahedron();
  doubled.triangles.push_back({2, 1, 0});
  EXPECT_EQ(surface::topology_of(doubled).duplicate_triangles, 1u);
  EXPECT_EQ(surface::topology_of(doubled).nonmanifold_edges, 3u);

  surface::TriMesh bow = tetrahedron();  // two tetrahedra that share one point
  append(bow, tetrahedron());
  for (std::size_t t = 4; t < 8; ++t)
    for (auto& v : bow.triangles[t])
      if (v == 4) v = 0;
  const surface::Topology b = surface::topology_of(bow);
  EXPECT_EQ(b.nonmanifold_points, 1u);
  EXPECT_EQ(b.unused_points, 1u);
  EXPECT_EQ(b.components, 2);
  EXPECT_FALSE(b.manifold());
  EXPECT_TRUE(b.closed());

  surface::TriMesh flat = tetrahedron();
  flat.points_mm[3] = {0.5, 0.5, 0};
  EXPECT_EQ(surface::topology_of(flat).degenerate_triangles, 1u);
  surface::TriMesh repeated = tetrahedron();
  repeated.triangles.push_back({1, 1, 2});
  EXPECT_EQ(surface::topology_of(repeated).degenerate_triangles, 1u);
  EXPECT_TRUE(surface::topology_of(repeated).closed());
}

TEST(Surface, ChecksWhatComesFromOutside) {
  const auto fault = [](const surface::TriMesh& m) -> std::string {
    try {
      surface::check_mesh(m);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field();
    }
    return "";
  };
  EXPECT_EQ(fault(tetrahedron()), "");
  surface::TriMesh m = tetrahedron();
  m.points_mm[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault(m), "point 2");
  m = tetrahedron();
  m.triangles[1][2] = 4;
  EXPECT_EQ(fault(m), "triangle 1");
  m = tetrahedron();
  m.normals.resize(3);
  EXPECT_EQ(fault(m), "normals");
  m.normals.resize(4);
  m.normals[0].x = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault(m), "normal 0");
  m = tetrahedron();
  m.origin_mm.x = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault(m), "origin");
}

TEST(Surface, ComponentsAreLabelledInOrderAndSmallOnesDropped) {
  surface::TriMesh m = tetrahedron({0, 0, 0}, 1);
  append(m, tetrahedron({5, 0, 0}, 3));
  append(m, tetrahedron({10, 0, 0}, 2));
  std::vector<int> label;
  EXPECT_EQ(surface::label_components(m, label), 3);
  EXPECT_EQ(label, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
  surface::TriMesh two = m;
  EXPECT_EQ(surface::keep_large_components(two, 1.0), 1);
  EXPECT_EQ(two.points_mm.size(), 8u);
  EXPECT_NEAR(surface::volume_mm3(two), 27.0 / 6 + 8.0 / 6, 1e-12);
  surface::TriMesh one = m;
  EXPECT_EQ(surface::keep_large_components(one, 1e9), 2);  // the largest always stays
  EXPECT_NEAR(surface::volume_mm3(one), 27.0 / 6, 1e-12);
  EXPECT_EQ(one.points_mm[0], (Vec3{5, 0, 0}));
}

TEST(Surface, BoundsAreOfTheWorld) {
  surface::TriMesh m = tetrahedron();
  m.origin_mm = {100, 200, 300};
  EXPECT_EQ(surface::bounds_of(m).min_mm, (Vec3{100, 200, 300}));
  EXPECT_EQ(surface::bounds_of(m).max_mm, (Vec3{101, 201, 301}));
}

// An outline of rays every 0.1 degrees with strands of 2 mm height and 4 mm width, every 15 mm, from `from_mm` on.
surface::Arc with_strands(double radius_mm, double from_mm, double height_mm) {
  surface::Arc arc;
  for (int i = 0; i <= 1800; ++i) {
    const double angle = i * 0.1 * pi / 180, along = radius_mm * angle;
    const bool strand = along > from_mm && std::fmod(along, 15) < 4;
    const double r = radius_mm + (strand ? height_mm : 0);
    arc.points_mm.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  return arc;
}

TEST(Arc, StrandsOnTheSkinDoNotLengthenAWay) {
  const surface::Arc smooth = with_strands(80, 0, 0), masked = with_strands(80, 45, 2);
  const Vec3 right = *surface::point_along(smooth, 110);
  EXPECT_GT(norm(*surface::point_along(masked, 110) - right), 6);
  EXPECT_LT(norm(*surface::point_along(surface::without_ridges(masked, {}, surface::brow_mm), 110) - right), 0.1);
  // What is smooth stays to the bit, and so does what is spared: the brow.
  const surface::Arc same = surface::without_ridges(smooth, {}, surface::brow_mm),
                     brow = surface::without_ridges(with_strands(80, 0, 2), {}, surface::brow_mm);
  for (std::size_t i = 0; i < smooth.points_mm.size(); ++i) EXPECT_EQ(norm(same.points_mm[i] - smooth.points_mm[i]), 0);
  EXPECT_EQ(norm(brow.points_mm[190]), norm(with_strands(80, 0, 2).points_mm[190]));
  EXPECT_TRUE(surface::without_ridges({}, {}, surface::brow_mm).points_mm.empty());
}

}  // namespace
}  // namespace trephine
