// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault of a surface, made on purpose, is counted and found where it is; far from the origin and tiny as well.
#include "meshing/validity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing_box.h"
#include "meshing_shapes.h"

namespace trephine {
namespace {

using shapes::box;
using Triangle = std::array<std::uint32_t, 3>;

surface::TriMesh together(const surface::TriMesh& a, const surface::TriMesh& b) {
  surface::TriMesh m = a;
  const auto n = static_cast<std::uint32_t>(a.points_mm.size());
  m.points_mm.insert(m.points_mm.end(), b.points_mm.begin(), b.points_mm.end());
  for (const auto& t : b.triangles) m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return m;
}

/// A plate of squares of 1 mm, 1 mm thick, with `holes` square holes in a row.
surface::TriMesh plate(int holes) {
  grid::Field f(shapes::lattice(4 * holes + 6, 8, 6));
  for (int k = 2; k < 4; ++k)
    for (int j = 1; j < 7; ++j)
      for (int i = 1; i < f.size[0] - 1; ++i)
        f.at(i, j, k) = holes > 0 && i % 4 == 3 && i < 4 * holes + 3 && (j == 3 || j == 4) ? -0.5f : 0.5f;
  for (float& v : f.voxels)
    if (v == 0) v = -0.5f;
  return shapes::contoured(f);
}

void expect_near(const std::vector<Vec3>& places, Vec3 at, double tolerance = 1e-9) {
  ASSERT_FALSE(places.empty());
  double nearest = 1e300;
  for (const Vec3 p : places) nearest = std::min(nearest, norm(p - at));
  EXPECT_LE(nearest, tolerance) << places[0].x << ", " << places[0].y << ", " << places[0].z;
}

std::size_t kinds(const meshing::Validity& v) {
  const surface::FaultPlaces& p = v.places;
  std::size_t n = 0;
  for (const auto* l : {&p.open_edges, &p.nonmanifold_edges, &p.nonmanifold_points, &p.misoriented_edges,
                        &p.duplicate_triangles, &p.degenerate, &p.slivers, &p.self_intersections})
    n += !l->empty();
  return n;
}

/// Each fault in a box of 8 mm (n = 4: squares of 2 mm) moved and scaled: the place moves and scales with it.
class Faults : public testing::TestWithParam<std::array<double, 2>> {
 protected:
  double scale() const { return GetParam()[0]; }
  Vec3 offset() const { return Vec3{1, -1, 1} * GetParam()[1]; }
  Vec3 at(Vec3 p) const { return offset() + p * scale(); }
  double tolerance() const { return 1e-9 * scale() + 4e-16 * norm(offset()); }
  /// As a mesh about its own origin, or with the offset in the points.
  surface::TriMesh placed(surface::TriMesh m) const {
    for (Vec3& p : m.points_mm) p = p * scale();
    m.origin_mm = offset();
    return m;
  }
  meshing::Validity of(const surface::TriMesh& m) const { return meshing::check_validity(placed(m)); }
};

TEST_P(Faults, None) {
  const meshing::Validity v = of(box({}, {8, 8, 8}, 4));
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.oriented());
  EXPECT_EQ(kinds(v), 0u);
  EXPECT_EQ(v.topology.genus, 0);
  EXPECT_EQ(v.topology.components, 1);
}

TEST_P(Faults, OpenEdges) {
  surface::TriMesh m = box({}, {8, 8, 8}, 4);
  const Triangle gone = m.triangles.back();
  m.triangles.pop_back();
  const meshing::Validity v = of(m);
  EXPECT_EQ(v.topology.boundary_edges, 3u);
  ASSERT_EQ(v.places.open_edges.size(), 3u);
  for (int c = 0; c < 3; ++c)
    expect_near(v.places.open_edges, at((m.points_mm[gone[c]] + m.points_mm[gone[(c + 1) % 3]]) / 2), tolerance());
  EXPECT_EQ(kinds(v), 1u);
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, NonManifoldEdge) {  // two boxes that share an edge of one square
  surface::TriMesh m = together(box({}, {2, 2, 2}), box({2, 2, 0}, {2, 2, 2}));
  const auto same = [&](Vec3 p, std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t i = from; i < to; ++i)
      if (m.points_mm[i] == p) return i;
    return 0u;
  };
  for (auto& t : m.triangles)
    for (std::uint32_t& p : t)
      if (p >= 8 && (m.points_mm[p] == Vec3{2, 2, 0} || m.points_mm[p] == Vec3{2, 2, 2}))
        p = same(m.points_mm[p], 0, 8);
  const meshing::Validity v = of(m);
  EXPECT_EQ(v.topology.nonmanifold_edges, 1u);
  expect_near(v.places.nonmanifold_edges, at({2, 2, 1}), tolerance());
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, BowTie) {  // two boxes that share a corner
  surface::TriMesh m = together(box({}, {2, 2, 2}), box({2, 2, 2}, {2, 2, 2}));
  std::uint32_t corner = 0;
  while (!(m.points_mm[corner] == Vec3{2, 2, 2})) ++corner;
  for (auto& t : m.triangles)
    for (std::uint32_t& p : t)
      if (m.points_mm[p] == Vec3{2, 2, 2}) p = corner;
  const meshing::Validity v = of(m);
  EXPECT_EQ(v.topology.nonmanifold_points, 1u);
  EXPECT_EQ(v.topology.boundary_edges + v.topology.nonmanifold_edges, 0u);
  EXPECT_EQ(v.self_intersections, 0u);
  ASSERT_EQ(v.places.nonmanifold_points.size(), 1u);
  expect_near(v.places.nonmanifold_points, at({2, 2, 2}), tolerance());
  EXPECT_EQ(v.topology.components, 2);
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, FlippedAndDuplicate) {
  surface::TriMesh m = box({}, {8, 8, 8}, 4);
  const Triangle t = m.triangles[10];
  const Vec3 middle = (m.points_mm[t[0]] + m.points_mm[t[1]] + m.points_mm[t[2]]) / 3;
  std::swap(m.triangles[10][0], m.triangles[10][1]);
  meshing::Validity v = of(m);
  EXPECT_EQ(v.topology.misoriented_edges, 3u);
  EXPECT_FALSE(v.oriented());
  for (int c = 0; c < 3; ++c)
    expect_near(v.places.misoriented_edges, at((m.points_mm[t[c]] + m.points_mm[t[(c + 1) % 3]]) / 2), tolerance());
  EXPECT_FALSE(v.valid());
  m.triangles[10] = t;
  m.triangles.push_back({t[1], t[2], t[0]});
  v = of(m);
  EXPECT_EQ(v.topology.duplicate_triangles, 1u);
  EXPECT_EQ(v.topology.nonmanifold_edges, 3u);
  ASSERT_EQ(v.places.duplicate_triangles.size(), 1u);
  expect_near(v.places.duplicate_triangles, at(middle), tolerance());
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, InsideOut) {
  surface::TriMesh m = box({}, {8, 8, 8});
  for (auto& t : m.triangles) std::swap(t[0], t[1]);
  const meshing::Validity v = of(m);
  EXPECT_FALSE(v.oriented());
  EXPECT_FALSE(v.valid());
  EXPECT_EQ(v.text(), "looks inwards");
}

TEST_P(Faults, DegenerateAndSliver) {
  surface::TriMesh m =
      box({}, {8, 8, 8});  // a point in the middle of an edge of two triangles: one of the three is flat
  const Triangle t = m.triangles[0];
  const auto p = std::uint32_t(m.points_mm.size());
  m.points_mm.push_back((m.points_mm[t[0]] + m.points_mm[t[1]]) / 2);
  m.triangles[0] = {t[0], p, t[2]};
  m.triangles.push_back({p, t[1], t[2]});
  m.triangles.push_back({t[0], t[1], p});
  meshing::Validity v = of(m);
  EXPECT_EQ(v.degenerate, 1u);
  ASSERT_EQ(v.places.degenerate.size(), 1u);
  expect_near(v.places.degenerate, at((m.points_mm[t[0]] + m.points_mm[t[1]] + m.points_mm[p]) / 3), tolerance());
  EXPECT_FALSE(v.valid());
  // A little within the face: thin, but allowed.
  m.points_mm[p] += (m.points_mm[t[2]] - m.points_mm[p]) / 4096;
  v = of(m);
  EXPECT_EQ(v.degenerate, 0u);
  EXPECT_EQ(v.slivers, 1u);
  expect_near(v.places.slivers, at((m.points_mm[t[0]] + m.points_mm[t[1]] + m.points_mm[p]) / 3), tolerance());
  EXPECT_TRUE(v.valid()) << v.text();
}

TEST_P(Faults, Crossing) {  // a spike of one box through the face of another
  const surface::TriMesh m = together(box({}, {8, 8, 8}), box({3, 3, 7}, {0.5, 0.5, 2}));
  const meshing::Validity v = of(m);
  EXPECT_GT(v.self_intersections, 3u);
  EXPECT_EQ(v.topology.components, 2);
  ASSERT_FALSE(v.places.self_intersections.empty());
  EXPECT_EQ(v.places.self_intersections.size(),
            std::min<std::size_t>(v.self_intersections, surface::FaultPlaces::limit));
  for (const Vec3 p : v.places.self_intersections) {  // on the face, at the spike's outline
    const Vec3 q = (p - offset()) / scale();
    EXPECT_NEAR(q.z, 8, 1e-6);
    EXPECT_NEAR(std::max(std::abs(q.x - 3.25), std::abs(q.y - 3.25)), 0.25, 1e-6);
  }
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, CoplanarOverlap) {  // two boxes that stand on each other, a corner of one in the face of the other
  const meshing::Validity v = of(together(box({}, {4, 4, 4}), box({1, 1, 4}, {2, 2, 2})));
  EXPECT_GT(v.self_intersections, 0u);
  for (const Vec3 p : v.places.self_intersections) {
    const Vec3 q = (p - offset()) / scale();
    EXPECT_NEAR(q.z, 4, 1e-6);
    EXPECT_TRUE(q.x > 1 - 1e-6 && q.x < 3 + 1e-6 && q.y > 1 - 1e-6 && q.y < 3 + 1e-6) << q.x << " " << q.y;
  }
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, TouchingCorner) {  // two points in one place, not one point
  const meshing::Validity v = of(together(box({}, {2, 2, 2}), box({2, 2, 2}, {2, 2, 2})));
  EXPECT_GT(v.self_intersections, 0u);
  EXPECT_EQ(v.topology.nonmanifold_points, 0u);
  for (const Vec3 p : v.places.self_intersections) EXPECT_LE(norm(p - at({2, 2, 2})), tolerance());
  EXPECT_FALSE(v.valid());
}

TEST_P(Faults, FoldAtASharedPointAndEdge) {
  surface::TriMesh m;  // they share point 0, and the second pierces the first at (1, 1, 0)
  m.points_mm = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, -2}, {2, 2, 2}, {1, 1, 0}};
  m.triangles = {{0, 1, 2}, {0, 3, 4}};
  meshing::Validity v = of(m);
  ASSERT_EQ(v.self_intersections, 1u);
  ASSERT_EQ(v.places.self_intersections.size(), 1u);
  const Vec3 q = (v.places.self_intersections[0] - offset()) / scale();
  EXPECT_NEAR(q.z, 0, 1e-6);  // along the diagonal, not at the shared point
  EXPECT_NEAR(q.x, q.y, 1e-6);
  EXPECT_TRUE(q.x > 0.5 && q.x < 2 + 1e-6) << q.x;
  m.points_mm = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 2, 0}};
  m.triangles = {{0, 1, 2}, {1, 0, 3}};
  v = of(m);
  ASSERT_EQ(v.self_intersections, 1u);
  const Vec3 r = (v.places.self_intersections[0] - offset()) / scale();
  EXPECT_NEAR(r.z, 0, 1e-6);
  EXPECT_TRUE(r.y > 1e-6 && r.y < 2 && std::abs(r.x - 1) < 1) << r.x << " " << r.y;
}

// At the origin; an offset of a kilometre; a millionth of a millimetre in size; both.
INSTANTIATE_TEST_SUITE_P(Placed, Faults,
                         testing::Values(std::array{1.0, 0.0}, std::array{1.0, 1e6}, std::array{1e-7, 0.0},
                                         std::array{1e6, -1e6}));

TEST(Validity, AnOffsetInThePointsThemselves) {
  surface::TriMesh m = together(box({}, {8, 8, 8}), box({3, 3, 7}, {0.5, 0.5, 2}));
  for (Vec3& p : m.points_mm) p += Vec3{1e6, 1e6, -1e6};
  const meshing::Validity v = meshing::check_validity(m);
  EXPECT_GT(v.self_intersections, 3u);
  for (const Vec3 p : v.places.self_intersections) EXPECT_NEAR(p.z, 8 - 1e6, 1e-6);
}

TEST(Validity, GenusAndComponents) {
  for (int holes = 0; holes < 4; ++holes) {
    const meshing::Validity v = meshing::check_validity(plate(holes));
    EXPECT_TRUE(v.valid()) << v.text();
    EXPECT_EQ(v.topology.genus, holes);
    EXPECT_EQ(v.topology.components, 1);
  }
  const meshing::Validity v = meshing::check_validity(together(box({}, {2, 2, 2}), box({9, 0, 0}, {2, 2, 2}, 3)));
  EXPECT_TRUE(v.valid());
  EXPECT_EQ(v.topology.components, 2);
  EXPECT_EQ(v.topology.genus, 0);
}

TEST(Validity, OneTriangleNoneAndNotANumber) {
  surface::TriMesh one;
  one.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  const meshing::Validity v = meshing::check_validity(one);
  EXPECT_EQ(v.topology.boundary_edges, 3u);
  EXPECT_EQ(v.places.open_edges.size(), 3u);
  EXPECT_EQ(v.text(), "3 open edges (the first at 0.5, 0, 0 mm)");
  EXPECT_EQ(meshing::check_validity(surface::TriMesh()).text(), "no triangles");
  EXPECT_EQ(kinds(meshing::check_validity(surface::TriMesh())), 0u);
  one.points_mm[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(meshing::check_validity(one), Error);
  one.points_mm[2].y = std::numeric_limits<double>::infinity();
  EXPECT_THROW(meshing::check_validity(one), Error);
  one.points_mm[2].y = 1;
  one.triangles[0][2] = 3;
  EXPECT_THROW(meshing::check_validity(one), Error);
}

TEST(Validity, ManyFaultsAreCountedAndTwentyOfThemPlaced) {
  surface::TriMesh m = box({}, {30, 30, 30}, 15);
  for (std::size_t t = 0; t < m.triangles.size(); t += 20) m.triangles[t] = m.triangles.back(), m.triangles.pop_back();
  const int threads = thread_count();
  set_thread_count(1);
  const meshing::Validity one = meshing::check_validity(m);
  set_thread_count(8);
  const meshing::Validity eight = meshing::check_validity(m);
  set_thread_count(threads);
  EXPECT_GT(one.topology.boundary_edges, 100u);
  EXPECT_EQ(one.places.open_edges.size(), surface::FaultPlaces::limit);
  EXPECT_EQ(one.places.open_edges, eight.places.open_edges);
  EXPECT_EQ(one.text(), eight.text());
}

}  // namespace
}  // namespace trephine
