// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/pi.h"
#include "base/refusal.h"
#include "base/text.h"
#include "boolean/cutter.h"
#include "boolean/cutter_shape.h"

namespace trephine::boolean {
namespace {

constexpr int max_corners = 8192, max_splits = 128;

[[noreturn]] void too_fine(double max_deviation_mm) {
  throw refusal("cutter", "a deviation of " + to_text(max_deviation_mm) + " mm needs too many facets for its size",
                {"raise `cutter_deviation_mm`"});
}

/// How much further out the corners lie than the circle whose area the polygon has.
double corner_factor(int n) { return std::sqrt(2 * pi / n / std::sin(2 * pi / n)); }

int corners_for(double radius, double max_deviation_mm) {
  for (int n = 16; n <= max_corners; n += n < 64 ? 4 : n / 8) {
    const double f = corner_factor(n);
    if (radius * (f - 1) <= max_deviation_mm && radius * (1 - f * std::cos(pi / n)) <= max_deviation_mm) return n;
  }
  too_fine(max_deviation_mm);
}

surface::TriMesh frustum(const Cutter& c, double max_deviation_mm, double turn_ratio) {
  const double r0 = start_radius_mm(c), r1 = far_radius_mm(c);
  const auto n = std::uint32_t(corners_for(std::max(r0, r1), max_deviation_mm));
  const double f = corner_factor(int(n));
  const Mat3 frame = frame_of(c);
  surface::TriMesh m;
  m.origin_mm = c.position_mm;
  const auto ring = [&](double radius, double s) {
    if (radius > 0)
      for (std::uint32_t i = 0; i < n; ++i) {
        const double a = 2 * pi * (i + turn_ratio) / n;
        m.points_mm.push_back(frame * Vec3{f * radius * std::cos(a), f * radius * std::sin(a), s});
      }
    m.points_mm.push_back(frame * Vec3{0, 0, s});
  };
  ring(r0, -c.above_mm);
  ring(r1, c.depth_mm);
  const bool pointed = r1 == 0;
  const std::uint32_t second = n + 1, end = pointed ? second : second + n;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    m.triangles.push_back({n, j, i});
    if (pointed) {
      m.triangles.push_back({i, j, end});
      continue;
    }
    m.triangles.push_back({i, j, second + j});
    m.triangles.push_back({i, second + j, second + i});
    m.triangles.push_back({end, second + i, second + j});
  }
  return m;
}

/// The icosahedron with each edge in `splits` parts, on the unit sphere.
surface::TriMesh geodesic(int splits) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const Vec3 corners[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                            {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const int faces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                            {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                            {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  surface::TriMesh m;
  // A point by the weights of the corners that it lies between; those within a face are the face's own.
  std::map<std::array<int, 4>, std::uint32_t> shared;
  std::vector<std::uint32_t> own;
  constexpr std::uint32_t none = 0xffffffffu;
  const auto point = [&](const int* face, int a, int b) {
    const int c = splits - a - b;
    std::uint32_t* known = &own[std::size_t(a) * (splits + 1) + b];
    if (*known != none) return *known;
    if (a == 0 || b == 0 || c == 0) {
      std::array<int, 4> key{-1, -1, -1, -1};
      std::array<std::pair<int, int>, 3> w{{{face[0], c}, {face[1], a}, {face[2], b}}};
      std::sort(w.begin(), w.end());
      int k = 0;
      for (const auto& [corner, weight] : w)
        if (weight > 0) {
          key[k++] = corner;
          key[k++] = weight;
        }
      const auto [it, fresh] = shared.try_emplace(key, std::uint32_t(m.points_mm.size()));
      *known = it->second;
      if (!fresh) return *known;
    }
    *known = std::uint32_t(m.points_mm.size());
    m.points_mm.push_back(normalized(corners[face[0]] * c + corners[face[1]] * a + corners[face[2]] * b));
    return *known;
  };
  for (const auto& face : faces) {
    own.assign(std::size_t(splits + 1) * (splits + 1), none);
    for (int a = 0; a < splits; ++a)
      for (int b = 0; a + b < splits; ++b) {
        m.triangles.push_back({point(face, a, b), point(face, a + 1, b), point(face, a, b + 1)});
        if (a + b + 1 < splits)
          m.triangles.push_back({point(face, a + 1, b), point(face, a + 1, b + 1), point(face, a, b + 1)});
      }
  }
  return m;
}

surface::TriMesh ball(const Cutter& c, double max_deviation_mm, double turn_ratio) {
  const auto r = semi_axes_mm(c);
  const double largest = std::max({r[0], r[1], r[2]});
  double off = 0;
  // The deviation falls with the square of the splits.
  for (int splits = 4; splits <= max_splits;
       splits = std::max(splits + 1, int(0.98 * splits * std::sqrt(std::min(1e6, off / max_deviation_mm))))) {
    surface::TriMesh m = geodesic(splits);
    const double f = std::cbrt(4 * pi / 3 / surface::volume_mm3(m));
    double within = 1;  // the nearest that a facet comes to the centre
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const Vec3 n = normalized(surface::triangle_normal(m, t));
      within = std::min(within, dot(n, m.points_mm[m.triangles[t][0]]));
    }
    off = largest * std::max(f - 1, 1 - f * within);
    if (off > max_deviation_mm) continue;
    const Mat3 frame = frame_of(c);
    const double a = turn_ratio * 1.1 / splits, co = std::cos(a), si = std::sin(a);
    for (Vec3& p : m.points_mm) {
      // About two axes, so that no facet stays where it is.
      const Vec3 q{co * p.x - si * p.y, si * p.x + co * p.y, p.z};
      const Vec3 s{q.x, co * q.y - si * q.z, si * q.y + co * q.z};
      p = frame * Vec3{f * r[0] * s.x, f * r[1] * s.y, f * r[2] * s.z};
    }
    m.origin_mm = c.position_mm;
    return m;
  }
  too_fine(max_deviation_mm);
}

}  // namespace

surface::TriMesh mesh_of(const Cutter& c, double max_deviation_mm, double turn_ratio, Vec3 shift_mm) {
  if (!(max_deviation_mm > 0)) throw Error(ExitCode::usage, "", "max_deviation_mm", "must be above 0");
  surface::TriMesh m;
  if (c.kind == Cutter::Kind::mesh) {
    m = *c.mesh;
    m.normals.clear();
  } else if (c.kind == Cutter::Kind::cylinder || c.kind == Cutter::Kind::cone) {
    m = frustum(c, max_deviation_mm, turn_ratio);
  } else {
    m = ball(c, max_deviation_mm, turn_ratio);
  }
  m.origin_mm += shift_mm;
  return m;
}

surface::TriMesh mesh_of(const Cutter& c, double max_deviation_mm) { return mesh_of(c, max_deviation_mm, 0, {}); }

}  // namespace trephine::boolean
