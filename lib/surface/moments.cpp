// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/moments.h"

namespace trephine::surface {
namespace {

constexpr std::array<std::array<int, 2>, 6> axes{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

}  // namespace

Moments& Moments::add(const Moments& o, double factor) {
  volume += factor * o.volume;
  first += o.first * factor;
  for (std::size_t n = 0; n < second.size(); ++n) second[n] += factor * o.second[n];
  return *this;
}

std::array<double, 6> Moments::inertia() const {
  const Vec3 c = centre();
  std::array<double, 6> m{};  // second moments about the centre
  for (std::size_t n = 0; n < 6; ++n) m[n] = second[n] - volume * c[axes[n][0]] * c[axes[n][1]];
  return {m[1] + m[2], m[0] + m[2], m[0] + m[1], -m[3], -m[4], -m[5]};
}

Moments moments_of(const TriMesh& mesh) {
  Moments local;  // about the mesh's own origin, where the numbers are small
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points_mm[t[0]], b = mesh.points_mm[t[1]], c = mesh.points_mm[t[2]], sum = a + b + c;
    const double volume = dot(a, cross(b, c)) / 6;
    local.volume += volume;
    local.first += sum * (volume / 4);
    for (std::size_t n = 0; n < 6; ++n) {
      const int i = axes[n][0], j = axes[n][1];
      local.second[n] += volume / 20 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
    }
  }
  Moments world = local;
  const Vec3 o = mesh.origin_mm;
  world.first += o * local.volume;
  for (std::size_t n = 0; n < 6; ++n) {
    const int i = axes[n][0], j = axes[n][1];
    world.second[n] += o[i] * local.first[j] + o[j] * local.first[i] + local.volume * o[i] * o[j];
  }
  return world;
}

}  // namespace trephine::surface
