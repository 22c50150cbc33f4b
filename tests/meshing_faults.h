// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Shapes, the faults that foreign meshes have put into them on purpose, and their repair.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "meshing/repair.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"

namespace trephine::faults {

using namespace shapes;

/// Repaired, and checked to be valid.
inline Result repaired(const surface::TriMesh& m, const meshing::RepairParams& p = {}) {
  Result r;
  r.mesh = value_of(r.report, meshing::repair(m, p));
  const meshing::Validity v = meshing::check_validity(r.mesh);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  return r;
}

inline surface::TriMesh ball(double radius = 10, Vec3 centre = {}) { return contoured(sphere(18, radius, centre)); }

inline surface::TriMesh together(const surface::TriMesh& a, const surface::TriMesh& b) {
  surface::TriMesh m = a;
  const auto n = static_cast<std::uint32_t>(a.points_mm.size());
  for (std::size_t i = 0; i < b.points_mm.size(); ++i) m.points_mm.push_back(b.world_mm(i) - a.origin_mm);
  for (const auto& t : b.triangles) m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return m;
}

inline surface::TriMesh box(Vec3 lo, Vec3 hi) {
  surface::TriMesh m;
  for (int c = 0; c < 8; ++c) m.points_mm.push_back({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

inline surface::TriMesh torus() {
  grid::Lattice l = lattice(30, 30, 12, {1, 1, 1}, {-14.5, -14.5, -5.5});
  return contoured(sample(l, [](Vec3 p) { return 3 - std::hypot(std::hypot(p.x, p.y) - 9, p.z); }));
}

/// Each triangle with points of its own, as in an STL, moved by up to `jitter`.
inline void unmerge(surface::TriMesh& m, Random& random, double jitter = 0) {
  surface::TriMesh soup;
  soup.origin_mm = m.origin_mm;
  for (const auto& t : m.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.points_mm.size());
    for (const std::uint32_t v : t) soup.points_mm.push_back(m.points_mm[v] + random.direction() * (jitter * random()));
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  m = soup;
}

inline void flip(surface::TriMesh& m, Random& random, double share) {
  for (auto& t : m.triangles)
    if (random() < share) std::swap(t[0], t[1]);
}

inline void duplicate(surface::TriMesh& m, Random& random, double share) {
  const std::size_t n = m.triangles.size();
  for (std::size_t t = 0; t < n; ++t) {
    if (random() >= share) continue;
    auto copy = m.triangles[t];
    if (random() < 0.5) std::swap(copy[0], copy[1]);
    m.triangles.push_back(copy);
  }
}

inline void punch(surface::TriMesh& m, Random& random, int holes, double radius) {
  for (int h = 0; h < holes; ++h) {
    const Vec3 at = m.points_mm[std::size_t(random() * double(m.points_mm.size()))];
    m.triangles.erase(std::remove_if(m.triangles.begin(), m.triangles.end(),
                                     [&](const auto& t) { return norm(m.points_mm[t[0]] - at) < radius; }),
                      m.triangles.end());
  }
}

/// A third triangle on an edge.
inline void fin(surface::TriMesh& m, Random& random) {
  const auto t = m.triangles[std::size_t(random() * double(m.triangles.size()))];
  const auto n = static_cast<std::uint32_t>(m.points_mm.size());
  m.points_mm.push_back(m.points_mm[t[0]] * 1.3);
  m.triangles.push_back({t[0], t[1], n});
}

/// An edge of a triangle and its neighbour is split beside its end: two slivers, with their points 1e-9 apart.
inline void sliver(surface::TriMesh& m, Random& random) {
  const std::size_t at = std::size_t(random() * double(m.triangles.size()));
  const auto t = m.triangles[at];
  const Vec3 a = m.points_mm[t[0]], b = m.points_mm[t[1]];
  const auto n = static_cast<std::uint32_t>(m.points_mm.size());
  m.points_mm.push_back(a + (b - a) * (random() < 0.5 ? 1e-9 : 0.5) + random.direction() * 1e-9);
  for (std::size_t s = 0, end = m.triangles.size(); s < end; ++s)
    for (int c = 0; c < 3; ++c) {
      auto& v = m.triangles[s];
      const bool same = v[c] == t[0] && v[(c + 1) % 3] == t[1], turned = v[c] == t[1] && v[(c + 1) % 3] == t[0];
      if (!same && !turned) continue;
      auto half = v;
      half[c] = n;
      v[(c + 1) % 3] = n;
      m.triangles.push_back(half);
      break;
    }
}

/// A point is pulled through its surroundings.
inline void spike(surface::TriMesh& m, Random& random) {
  Vec3& p = m.points_mm[std::size_t(random() * double(m.points_mm.size()))];
  p = p + random.direction() * random(0.5, 3);
}

}  // namespace trephine::faults
