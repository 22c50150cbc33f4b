// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Walls of one voxel in haptic volumes, and a brute-force answer to where a segment meets them.
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "contact/contact.h"

namespace trephine::walls {

inline double uniform(std::mt19937_64& rng, double lo, double hi) {
  return lo + (hi - lo) * double(rng() >> 11) * 0x1p-53;
}
inline Vec3 unit_vector(std::mt19937_64& rng) {
  const double z = uniform(rng, -1, 1), a = uniform(rng, 0, 2 * M_PI), r = std::sqrt(1 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

/// A lattice of n^3 voxels of those sides, turned and shifted.
inline grid::Lattice lattice(int n, Vec3 spacing_mm, Vec3 origin_mm = {-31.7, 12.3, 8.9}) {
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = spacing_mm;
  l.origin_mm = origin_mm;
  const Vec3 z = normalized(Vec3{0.2, -0.3, 0.9});
  l.direction.column[2] = z;
  l.direction.column[0] = normalized(cross(Vec3{0.1, 1, 0.3}, z));
  l.direction.column[1] = cross(z, l.direction.column[0]);
  return l;
}

struct Wall {
  std::string name;
  voxel::HapticVolume volume;
  std::vector<std::array<int, 3>> voxels;  ///< of the wall
  std::vector<int> side;                   ///< by voxel: 0 wall, 1 and 2 the two sides
};

/// The wall between the voxels whose centres (index less the middle) have level < 0 and the others, made of those that
/// touch the others' side by a face, so that no way from face to face avoids it.
inline Wall make_wall(const std::string& name, const grid::Lattice& l, voxel::HapticEncoding encoding,
                      const std::function<double(Vec3)>& level) {
  Wall w;
  w.name = name;
  const bool hu = encoding == voxel::HapticEncoding::hu;
  w.volume.encoding = encoding;
  w.volume.voxels = grid::Grid<std::int16_t>(l, hu ? std::int16_t(-1000) : voxel::haptic_empty);
  w.volume.shapes = {hu ? voxel::HapticShape{"wall", 3, 300, 2000} : voxel::occupancy_shape("wall", 3)};
  w.side.assign(l.count(), 0);
  const Vec3 middle{0.5 * (l.size[0] - 1), 0.5 * (l.size[1] - 1), 0.5 * (l.size[2] - 1)};
  const auto below = [&](int i, int j, int k) { return level(Vec3{double(i), double(j), double(k)} - middle) < 0; };
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const bool edge = below(i, j, k) && !(below(i + 1, j, k) && below(i - 1, j, k) && below(i, j + 1, k) &&
                                              below(i, j - 1, k) && below(i, j, k + 1) && below(i, j, k - 1));
        w.side[l.index(i, j, k)] = edge ? 0 : below(i, j, k) ? 1 : 2;
        if (!edge) continue;
        w.voxels.push_back({i, j, k});
        w.volume.voxels.at(i, j, k) = std::int16_t(hu ? 1400 : 3 * voxel::haptic_base_step + voxel::haptic_full);
      }
  return w;
}

inline std::vector<Wall> all_walls(const grid::Lattice& l, voxel::HapticEncoding encoding) {
  const auto plane = [](Vec3 n, double at) { return [=](Vec3 p) { return dot(n, p) - at; }; };
  std::vector<Wall> out;
  out.push_back(make_wall("flat", l, encoding, plane({0, 0, 1}, 0.3)));
  out.push_back(make_wall("tilted", l, encoding, plane(normalized(Vec3{0.2, -0.11, 1}), 0.3)));
  out.push_back(make_wall("diagonal of two", l, encoding, plane({1, 1, 0}, 0.3)));
  out.push_back(make_wall("diagonal of three", l, encoding, plane({1, 1, 1}, 0.3)));
  out.push_back(make_wall("diagonal of three, turned", l, encoding, plane({-1, 1, -1}, 0.3)));
  const double r = 0.36 * l.size[0];
  out.push_back(make_wall("curved", l, encoding, [=](Vec3 p) { return norm(p) - r; }));
  out.push_back(
      make_wall("wavy", l, encoding, [](Vec3 p) { return p.z - 2.5 * std::sin(0.7 * p.x) - 2 * std::cos(0.9 * p.y); }));
  return out;
}

/// Where on the segment the first of the wall's boxes begins, by testing each; and how deep (of the segment) the
/// deepest is pierced.
struct Truth {
  bool hit = false;
  double along = 2, depth = 0;
};
inline Truth brute_force(const Wall& w, Vec3 start_mm, Vec3 end_mm) {
  const Vec3 p = w.volume.voxels.to_index(start_mm), q = w.volume.voxels.to_index(end_mm), d = q - p;
  Truth t;
  for (const auto& v : w.voxels) {
    double t0 = 0, t1 = 1;
    for (int a = 0; a < 3 && t0 <= t1; ++a) {
      const double low = v[std::size_t(a)] - 0.5, high = low + 1;
      if (d[a] == 0) {
        if (p[a] < low || p[a] > high) t1 = -1;
        continue;
      }
      const double u = (low - p[a]) / d[a], x = (high - p[a]) / d[a];
      t0 = std::max(t0, std::min(u, x));
      t1 = std::min(t1, std::max(u, x));
    }
    if (t0 > t1) continue;
    t.hit = true;
    t.along = std::min(t.along, t0);
    t.depth = std::max(t.depth, t1 - t0);
  }
  return t;
}

/// The side of the wall on which a point lies; 0 in the wall, and at the lattice's border, where a way leads around it.
inline int side_of(const Wall& w, Vec3 world_mm) {
  const Vec3 i = w.volume.voxels.to_index(world_mm);
  for (int a = 0; a < 3; ++a)
    if (i[a] < 0 || i[a] > w.volume.voxels.size[std::size_t(a)] - 1) return 0;
  const int x = int(std::floor(i.x + 0.5)), y = int(std::floor(i.y + 0.5)), z = int(std::floor(i.z + 0.5));
  return w.volume.voxels.contains(x, y, z) ? w.side[w.volume.voxels.index(x, y, z)] : 0;
}

/// A segment of that length through a random point near the wall.
struct Way {
  Vec3 start_mm, end_mm;
};
inline Way random_way(const Wall& w, double length_mm, std::mt19937_64& rng) {
  const auto& v = w.voxels[rng() % w.voxels.size()];
  const Vec3 in{v[0] + uniform(rng, -1, 1), v[1] + uniform(rng, -1, 1), v[2] + uniform(rng, -1, 1)};
  const Vec3 at = w.volume.voxels.to_world_mm(in), way = unit_vector(rng) * length_mm;
  const double t = uniform(rng, 0, 1);
  return {at - way * t, at + way * (1 - t)};
}

}  // namespace trephine::walls
