// SPDX-License-Identifier: GPL-3.0-or-later
// Where a way or a line meets surfaces, against brute force.
#include <gtest/gtest.h>

#include "surface/point_triangle.h"
#include "touch_meshes.h"

namespace trephine::touched {
namespace {

using walls::uniform;
using walls::unit_vector;

constexpr double skin = 1e-4;

TEST(Touch, AWayEndsAtTheSkinOfTheFirstFacetFromEitherSide) {
  const surface::TriMesh organ = round_mesh(24, organ_mm);
  const touch::MeshSurfaces surfaces({{organ, mesh}}, skin);
  std::mt19937_64 rng(3);
  int met = 0, behind = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 from = unit_vector(rng) * uniform(rng, 1, 35), to = unit_vector(rng) * uniform(rng, 1, 35);
    double first = 2;
    bool front = true;
    for (std::size_t t = 0; t < organ.triangles.size(); ++t) {  // without any skin
      const auto& v = organ.triangles[t];
      const Vec3 a = organ.points_mm[v[0]], e = organ.points_mm[v[1]] - a, f = organ.points_mm[v[2]] - a,
                 way = to - from;
      const Vec3 p = cross(way, f);
      const double det = dot(e, p);
      if (std::abs(det) < 1e-12) continue;
      const Vec3 s = from - a, q = cross(s, e);
      const double u = dot(s, p) / det, w = dot(way, q) / det, along = dot(f, q) / det;
      if (u < 0 || w < 0 || u + w > 1 || along < 0 || along > 1 || along >= first) continue;
      first = along;
      front = det > 0;
    }
    const auto m = surfaces.first_met(from, to, ~0ull);
    if (first > 1) {
      // A way that only grazes a skin may end there.
      if (m.shape != 0) {
        EXPECT_LE(m.distance_mm, skin * 1.001);
      }
      continue;
    }
    ASSERT_EQ(m.shape, mesh) << n;
    ++met;
    behind += !m.front;
    // The skin is met before the facet, and no more than the way through it before.
    EXPECT_LE(m.along, first + 1e-12);
    if (m.front == front && std::abs(dot(m.normal, normalized(to - from))) > 0.05) {
      EXPECT_LT((first - m.along) * norm(to - from), 60 * skin);
    }
    EXPECT_LT(dot(m.normal, to - from), 0);
    EXPECT_LE(m.distance_mm, skin * 1.001);
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(behind, 300);
}

// No way that ends just before a skin, as a proxy's does, comes through: at sides and corners neither.
TEST(Touch, NoWayComesThroughASideOrACorner) {
  const surface::TriMesh organ = round_mesh(12, organ_mm);
  const touch::MeshSurfaces surfaces({{organ, mesh}}, skin);
  std::mt19937_64 rng(5);
  for (int n = 0; n < 4000; ++n) {
    const auto& t = organ.triangles[std::size_t(rng() % organ.triangles.size())];
    const double share = n % 2 == 0 ? 0 : uniform(rng, 0, 1);  // a corner, or a place on a side
    const Vec3 place = organ.points_mm[t[0]] * (1 - share) + organ.points_mm[t[1]] * share;
    const Vec3 out = normalized(place), aside = normalized(cross(out, unit_vector(rng)));
    const Vec3 from = place + out * uniform(rng, 0.01, 2) + aside * uniform(rng, -1, 1) * 1e-4;
    EXPECT_EQ(surfaces.first_met(from, place * 0.9 + aside * 0.1, ~0ull).shape, mesh) << n;
    EXPECT_EQ(surfaces.first_met(place * 0.9, from, ~0ull).shape, mesh) << n;
  }
}

TEST(Touch, ALinesDistanceIsThatOfItsNearestPlace) {
  const surface::TriMesh organ = round_mesh(10, organ_mm);
  const touch::MeshSurfaces surfaces({{organ, mesh}}, skin);
  std::mt19937_64 rng(7);
  for (int n = 0; n < 300; ++n) {
    const bool point = n % 3 == 0;
    const Vec3 from = unit_vector(rng) * uniform(rng, 21, 30),
               to = point ? from : from + unit_vector(rng) * uniform(rng, 0, 25);
    constexpr int places = 400;
    double least = 1e9;
    for (int k = 0; k <= places; ++k) {
      const Vec3 at = from + (to - from) * (double(k) / places);
      for (const auto& t : organ.triangles)
        least = std::min(least, norm(at - surface::closest_on_triangle(at, organ.points_mm[t[0]], organ.points_mm[t[1]],
                                                                       organ.points_mm[t[2]])));
    }
    const auto m = surfaces.nearest(from, to, 40, ~0ull);
    ASSERT_EQ(m.shape, mesh);
    EXPECT_LE(m.distance_mm, least + 2e-6);
    EXPECT_GE(m.distance_mm, least - norm(to - from) / places);
    EXPECT_NEAR(norm(from + (to - from) * m.along - m.point_mm), m.distance_mm, 1e-9);
  }
}

// What is gathered around a line that moves little, and what is known to be far, change no distance.
TEST(Touch, WhatIsRememberedChangesNoDistance) {
  const touch::MeshSurfaces surfaces({{round_mesh(30, organ_mm), mesh}}, skin);
  std::mt19937_64 rng(11);
  touch::NearFacets near;
  Vec3 at{30, 0, 0};
  int met = 0;
  for (int n = 0; n < 4000; ++n) {
    at += unit_vector(rng) * 0.2 - normalized(at) * (n % 2000 < 1000 ? 0.02 : -0.01);
    const Vec3 tail = at + Vec3{0, 0, 8};
    const auto a = surfaces.nearest(at, tail, 2, 2, ~0ull, near), b = surfaces.nearest(at, tail, 2, ~0ull);
    ASSERT_EQ(a.shape, b.shape);
    ASSERT_NEAR(a.distance_mm, b.distance_mm, 1e-5);
    met += a.shape != 0;
  }
  EXPECT_GT(met, 400);
  EXPECT_LT(met, 3600);
}

TEST(Touch, OnlyAClosedSurfaceHasAnInside) {
  const touch::MeshSurfaces closed({{round_mesh(12, organ_mm), mesh}}, skin),
      open({{sheet({}, {1, 0, 0}, {0, 1, 0}, 20, 4), mesh}}, skin);
  EXPECT_TRUE(closed.inside({1, 2, 3}, ~0ull));
  EXPECT_FALSE(closed.inside({1, 2, 3}, 1));  // of no wanted shape
  EXPECT_FALSE(closed.inside({30, 2, 3}, ~0ull));
  EXPECT_FALSE(open.inside({0.1, 0.2, -1}, ~0ull));
}

}  // namespace
}  // namespace trephine::touched
