// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/head_template.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace trephine::place {
namespace {

struct Ellipsoid {
  Vec3 centre, radii;
  double blend_mm;  ///< with those before it
};
// The synthetic head's vault on the left side: calvaria, posterior fossa, middle fossa, clivus.
constexpr Ellipsoid vault[] = {{{0, -2, 60}, {63.5, 82.5, 58}, 0},
                               {{18, 40, 15}, {31, 37, 31}, 20},
                               {{36, -16, 21}, {22, 28, 21}, 16},
                               {{0, 22, 8}, {22, 30, 23}, 8}};

struct Node {
  Vec3 at;
  double radius_mm;
};
// The lateral ventricle of the left side: the body from back to front is the synthetic head's, mean over its seeds.
constexpr Node horns[] = {{{12.5, -44, 56}, 3.4}, {{8.5, -30, 60}, 5.2}, {{6.5, -13, 61}, 5.0}, {{9, 4, 64}, 4.6},
                          {{17, 22, 62}, 5.0},    {{24.5, 34, 55}, 6.6}, {{24.5, 48, 49}, 4.0}, {{22.5, 58, 47}, 2.2}};
constexpr Node temporal[] = {{{24.5, 34, 55}, 6.6}, {{31, 26, 44}, 3.2}, {{34, 8, 31}, 2.5}, {{33, -8, 26}, 2.0}};

double ellipsoid_mm(Vec3 p, Vec3 centre, Vec3 r) {
  const Vec3 d = p - centre, u{d.x / r.x, d.y / r.y, d.z / r.z}, v{u.x / r.x, u.y / r.y, u.z / r.z};
  const double k = norm(u), slope = norm(v);
  return slope > 1e-9 ? k * (k - 1) / slope : -std::min({r.x, r.y, r.z});
}

double capsule_mm(Vec3 p, const Node& a, const Node& b) {
  const Vec3 ab = b.at - a.at;
  const double t = std::clamp(dot(p - a.at, ab) / std::max(dot(ab, ab), 1e-9), 0.0, 1.0);
  return norm(p - (a.at + t * ab)) - (a.radius_mm + t * (b.radius_mm - a.radius_mm));
}

template <std::size_t n>
double chain_mm(Vec3 p, const Node (&nodes)[n]) {
  double d = 1e9;
  for (std::size_t i = 0; i + 1 < n; ++i) d = std::min(d, capsule_mm(p, nodes[i], nodes[i + 1]));
  return d;
}

double slab_mm(Vec3 p, Vec3 centre, Vec3 half) {
  const Vec3 d = p - centre;
  const Vec3 q{std::abs(d.x) - half.x, std::abs(d.y) - half.y, std::abs(d.z) - half.z};
  const double outside = norm({std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
  return outside + std::min(0.0, std::max({q.x, q.y, q.z}));
}

double smooth_min(double a, double b, double k) {
  const double h = std::max(0.0, k - std::abs(a - b));
  return std::min(a, b) - (k > 0 ? h * h / (4 * k) : 0);
}

}  // namespace

double template_cavity_mm(Vec3 p) {
  const Vec3 m{std::sqrt(p.x * p.x + 2.25), p.y, p.z};
  double f = ellipsoid_mm(m, vault[0].centre, vault[0].radii);
  for (int n = 1; n < 4; ++n) f = smooth_min(f, ellipsoid_mm(m, vault[n].centre, vault[n].radii), vault[n].blend_mm);
  return f;
}

double horns_mm(Vec3 p) {
  p.x = std::abs(p.x);
  return std::min({chain_mm(p, temporal), capsule_mm(p, horns[5], horns[6]), capsule_mm(p, horns[6], horns[7])});
}

double place_mm(Place place, Vec3 p) {
  const Vec3 m{std::abs(p.x), p.y, p.z};
  const auto lateral = [&](Vec3 q) { return std::min(chain_mm(q, horns), chain_mm(q, temporal)); };
  switch (place) {
    case Place::lateral_left:
      return lateral(p);
    case Place::lateral_right:
      return lateral({-p.x, p.y, p.z});
    case Place::third:
      return slab_mm(p, {0, -5.5, 43.3}, {2.2, 16.5, 9.5});
    case Place::fourth:
      return ellipsoid_mm(p, {0, 27, 5}, {7.5, 8, 12});
    case Place::fissure:
      return std::max({std::abs(p.x) - 1.1, 30 + template_cavity_mm(p), 72 - p.z});
    case Place::quadrigeminal:
      return std::min(ellipsoid_mm(p, {0, 33, 33}, {8, 5, 6}), capsule_mm(m, {{13, 28, 30}, 2.4}, {{0, 33, 33}, 3.8}));
    case Place::basal:
      return std::min(ellipsoid_mm(p, {0, -14, 18}, {16, 9, 9}), capsule_mm(p, {{0, -14, 14}, 10}, {{0, -13, 0}, 11}));
    case Place::sylvian:
      return capsule_mm(m, {{34, -30, 40}, 3}, {{48, 0, 48}, 3});
  }
  return 1e9;
}

}  // namespace trephine::place
