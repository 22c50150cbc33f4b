// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/slab.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/splitmix64.h"

namespace trephine::peers {
namespace {

constexpr double nearest_mm = 2;  // to the plate, where a poke begins
constexpr double behind_mm = 6;   // the plate, where it ends: a spring of 0.5 N/mm then presses with 3 N
constexpr int rests_ticks = 6;    // there, for algorithms that take a constraint a tick
constexpr double beyond_mm = 2;   // of the middle plane: then the proxy has passed

std::unique_ptr<Slab> oriented(double thickness_mm, double voxel_mm) {
  auto slab = std::make_unique<Slab>();
  slab->thickness_mm = thickness_mm;
  slab->voxel_mm = voxel_mm;
  slab->middle_mm = {13.37, -41.3, 87.71};
  slab->normal = normalized(Vec3{0.23, -0.31, 0.92});
  slab->along = normalized(cross(slab->normal, Vec3{0.3, 1, 0.1}));
  slab->across = cross(slab->normal, slab->along);
  return slab;
}

// The plate's two sides as grids of squares, and its rim.
surface::TriMesh plate(const Slab& s) {
  constexpr int n = 20;
  const double step = Slab::side_mm / n;
  surface::TriMesh m;
  m.origin_mm = s.middle_mm;
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto at = [](int side, int i, int j) { return std::uint32_t((side * (n + 1) + j) * (n + 1) + i); };
  for (int side = 0; side < 2; ++side)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        points.push_back(s.along * (i * step - Slab::side_mm / 2) + s.across * (j * step - Slab::side_mm / 2) +
                         s.normal * ((side == 0 ? 0.5 : -0.5) * s.thickness_mm));
  const auto square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      square(at(0, i, j), at(0, i + 1, j), at(0, i + 1, j + 1), at(0, i, j + 1));
      square(at(1, i, j), at(1, i, j + 1), at(1, i + 1, j + 1), at(1, i + 1, j));
    }
  for (int i = 0; i < n; ++i) {
    square(at(0, i + 1, 0), at(0, i, 0), at(1, i, 0), at(1, i + 1, 0));
    square(at(0, i, n), at(0, i + 1, n), at(1, i + 1, n), at(1, i, n));
    square(at(0, 0, i), at(0, 0, i + 1), at(1, 0, i + 1), at(1, 0, i));
    square(at(0, n, i + 1), at(0, n, i), at(1, n, i), at(1, n, i + 1));
  }
  m.points_mm = std::move(points);
  m.triangles = std::move(triangles);
  return m;
}

void fill(Slab& s, const std::function<double(Vec3)>& occupancy) {
  grid::Lattice l;
  const int n = int(std::ceil(1.5 * Slab::side_mm / s.voxel_mm));
  l.size = {n, n, n};
  l.spacing_mm = {s.voxel_mm, s.voxel_mm, s.voxel_mm};
  l.origin_mm = s.middle_mm - Vec3{1, 1, 1} * (0.5 * (n - 1) * s.voxel_mm);
  s.volume.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  s.volume.shapes = {voxel::occupancy_shape("plate", 1)};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 off = l.to_world_mm({double(i), double(j), double(k)}) - s.middle_mm;
        if (std::abs(dot(off, s.along)) > Slab::side_mm / 2 || std::abs(dot(off, s.across)) > Slab::side_mm / 2)
          continue;
        const int share = int(std::lround(voxel::haptic_full * std::clamp(occupancy(off), 0.0, 1.0)));
        if (share > 0)
          s.volume.voxels.at(i, j, k) = std::int16_t(voxel::haptic_base_step + share +
                                                     (share < voxel::haptic_full ? voxel::haptic_bare_offset : 0));
      }
  s.contact = std::make_unique<contact::ContactVolume>(s.volume);
}

}  // namespace

std::unique_ptr<Slab> make_slab(double thickness_mm, double voxel_mm) {
  auto slab = oriented(thickness_mm, voxel_mm);
  slab->mesh = std::make_unique<FeltMesh>(plate(*slab));
  fill(*slab, [&](Vec3 off) { return 0.5 + (0.5 * thickness_mm - std::abs(dot(off, slab->normal))) / voxel_mm; });
  return slab;
}

std::unique_ptr<Slab> make_voxel_wall(double voxel_mm) {
  auto slab = oriented(voxel_mm, voxel_mm);
  // Voxels below the middle plane of which a neighbour by a face is above it.
  const Vec3 n = slab->normal;
  const double steps[3] = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const double most = *std::max_element(steps, steps + 3) * voxel_mm;
  fill(*slab, [&](Vec3 off) {
    const double level = dot(off, n);
    return level < 0 && level + most >= 0 ? 1.0 : 0.0;
  });
  return slab;
}

int count_falls(ContactAlgorithm& algorithm, const Slab& slab, double mm_a_tick, int pokes, const PokeParams& params) {
  std::uint64_t count = 0;
  const auto between = [&](double low, double high) {
    return low + (high - low) * unit_of_bits(splitmix64_mixed(++count * splitmix64_step));
  };
  int falls = 0;
  for (int poke = 0; poke < pokes; ++poke) {
    const double tilt = between(0, params.max_tilt_rad), turn = between(0, 2 * M_PI);
    const Vec3 aside = slab.along * std::cos(turn) + slab.across * std::sin(turn);
    const Vec3 way = -slab.normal * std::cos(tilt) + aside * std::sin(tilt);
    // Aimed so that the proxy, which slides along, stays over the plate.
    const Vec3 aim = slab.middle_mm - aside * (0.5 * behind_mm * std::tan(tilt)) + slab.along * between(-2, 2) +
                     slab.across * between(-2, 2);
    const double begins = between(nearest_mm, params.farthest_mm), length = begins + behind_mm / std::cos(tilt);
    const int first_picture = 1 + int(between(0, params.ticks_a_picture));
    algorithm.reset();
    haptics::HapticInput in;
    in.dt_s = in.period_s = tick_s;
    in.tip_mm = aim - way * begins;
    algorithm.update(in);
    algorithm.client(in.tip_mm);
    Vec3 proxy = in.tip_mm;
    for (int n = 1, resting = 0; resting < rests_ticks; ++n) {
      const double gone = std::min(length, n * mm_a_tick);
      in.tip_mm = aim + way * (gone - begins);
      if (n >= first_picture && (n - first_picture) % params.ticks_a_picture == 0) algorithm.client(in.tip_mm);
      proxy = algorithm.update(in).proxy_mm;
      resting += gone >= length;
    }
    falls += dot(proxy - slab.middle_mm, slab.normal) < -beyond_mm;
  }
  return falls;
}

}  // namespace trephine::peers
