// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "mask/filters.h"
#include "trunk/pedicle_parts.h"

namespace trephine::trunk {
namespace {

constexpr double half_mm = 6;                       // of the line over which clearance counts
constexpr double body_mm = 20, wider_ratio = 1.15;  // beyond it, within the body
constexpr int rays = 36;
constexpr double max_ray_mm = 12;
constexpr double equal_mm = 0.3;  // clearances that differ by less are equal: no wall is known better than that

double sampled(const grid::Grid<float>& g, Vec3 world_mm, double outside) {
  const Vec3 p = g.to_index(world_mm);
  const double fi = std::floor(p.x), fj = std::floor(p.y), fk = std::floor(p.z);
  if (!(fi >= 0 && fj >= 0 && fk >= 0 && fi + 1 < g.size[0] && fj + 1 < g.size[1] && fk + 1 < g.size[2]))
    return outside;
  const int i = int(fi), j = int(fj), k = int(fk);
  const double x = p.x - fi, y = p.y - fj, z = p.z - fk;
  const auto row = [&](int b, int c) { return g.at(i, j + b, k + c) * (1 - x) + g.at(i + 1, j + b, k + c) * x; };
  return (row(0, 0) * (1 - y) + row(1, 0) * y) * (1 - z) + (row(0, 1) * (1 - y) + row(1, 1) * y) * z;
}

// A line by how far it leans to the middle and rises, in degrees, and how far it is moved aside and up, in mm.
struct Pose {
  std::array<double, 4> v{0, 0, 0, 0};
};

AxisLine line_of(const Pose& p, const PediclePlace& place) {
  const double c = p.v[0] * M_PI / 180, r = p.v[1] * M_PI / 180, side = place.left ? 1 : -1;
  return {place.at_mm + place.across() * p.v[2] + place.up * p.v[3],
          place.across() * (-side * std::sin(c) * std::cos(r)) + place.forwards() * (std::cos(c) * std::cos(r)) +
              place.up * std::sin(r)};
}

AxisLine largest_clearance(const BoneDistance& bone, const PediclePlace& place) {
  Pose best;
  double most = -1e9;
  const auto look = [&](const Pose& p) {
    const double c = clearance_mm(bone, line_of(p, place));
    if (c > most) {
      most = c;
      best = p;
      return true;
    }
    return false;
  };
  for (double lean = -10; lean <= 45; lean += 5)
    for (double rise = -25; rise <= 25; rise += 5)
      for (double aside = -4; aside <= 4; aside += 1)
        for (double up = -4; up <= 4; up += 1) look({{lean, rise, aside, up}});
  for (double step = 1; step > 0.02; step *= 0.5)
    for (bool better = true; better;) {
      better = false;
      for (int a = 0; a < 4; ++a)
        for (const double way : {-1.0, 1.0}) {
          Pose p = best;
          p.v[std::size_t(a)] += way * step * (a < 2 ? 3 : 1);
          better |= look(p);
        }
    }
  return line_of(best, place);
}

// The straight line through the middles of the cross-sections about the narrowest one, as long as they stay narrow.
bool through_middles(const BoneDistance& bone, AxisLine& line) {
  constexpr int reach = 8;
  std::vector<CrossSection> all;
  for (int t = -reach; t <= reach; ++t)
    all.push_back(cross_section(bone, line.at_mm + line.forwards * t, line.forwards));
  int narrowest = -1;
  for (int n = 2; n < int(all.size()) - 2; ++n)
    if (all[std::size_t(n)].closed_ratio > 0.8 &&
        (narrowest < 0 || all[std::size_t(n)].area_mm2 < all[std::size_t(narrowest)].area_mm2))
      narrowest = n;
  if (narrowest < 0) return false;
  const auto narrow = [&](int n) {
    return n >= 0 && n < int(all.size()) && all[std::size_t(n)].closed_ratio > 0.8 &&
           all[std::size_t(n)].area_mm2 < 1.4 * all[std::size_t(narrowest)].area_mm2;
  };
  int first = narrowest, last = narrowest;
  while (narrow(first - 1)) --first;
  while (narrow(last + 1)) ++last;
  if (last - first < 4) return false;
  Vec3 mean, slope;
  double mean_t = 0, spread = 0;
  const double count = last - first + 1;
  for (int n = first; n <= last; ++n) {
    mean += all[std::size_t(n)].middle_mm / count;
    mean_t += n / count;
  }
  for (int n = first; n <= last; ++n) {
    slope += (all[std::size_t(n)].middle_mm - mean) * (n - mean_t);
    spread += (n - mean_t) * (n - mean_t);
  }
  const Vec3 forwards = normalized(slope / spread);
  if (!(dot(forwards, line.forwards) > 0.9)) return false;
  line = {mean + forwards * (narrowest - mean_t), forwards};
  return true;
}

}  // namespace

BoneDistance::BoneDistance(const grid::Field& bone, const grid::Lattice& raster, const Progress& progress) {
  grid::Field field(raster);
  for (int k = 0; k < raster.size[2]; ++k)
    for (int j = 0; j < raster.size[1]; ++j)
      for (int i = 0; i < raster.size[0]; ++i) {
        const double f = sampled(bone, raster.to_world_mm({double(i), double(j), double(k)}), -1e3);
        field.at(i, j, k) = std::abs(f) < 1e-3 ? 1e-3f : float(f);
      }
  grid_ = mask::signed_distance_mm(field, progress);
}

double BoneDistance::operator()(Vec3 p) const { return sampled(grid_, p, -1e3); }
double field_at(const grid::Field& field, Vec3 p, double outside) { return sampled(field, p, outside); }

double half_width_mm(const BoneDistance& bone, const AxisLine& line) {
  double least = 1e9;
  for (double t = -half_mm; t <= half_mm; t += 1) least = std::min(least, bone(line.at_mm + line.forwards * t));
  return least;
}

double clearance_mm(const BoneDistance& bone, const AxisLine& line) {
  double least = half_width_mm(bone, line);
  for (double t = half_mm + 2; t <= body_mm && least > 0; t += 2)
    least = std::min(least, bone(line.at_mm + line.forwards * t) / wider_ratio);
  return least;
}

CrossSection cross_section(const BoneDistance& bone, Vec3 at, Vec3 normal) {
  const Vec3 across = normalized(cross(normal, std::abs(normal.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
  const Vec3 up = cross(across, normal);
  CrossSection s;
  s.least_mm = max_ray_mm;
  s.middle_mm = at;
  std::array<double, rays> length{};
  for (int n = 0; n < rays; ++n) {
    const double a = 2 * M_PI * n / rays;
    const Vec3 way = across * std::cos(a) + up * std::sin(a);
    double before = bone(at), t = 0;
    // Each step is as long as the wall is far away; where the wall lies is interpolated between the last two samples.
    while (t < max_ray_mm && before > 0) {
      const double step = std::clamp(0.7 * before, 0.15, 2.0), now = bone(at + way * (t + step));
      t += now > 0 ? step : step * before / (before - now);
      if (!(now > 0)) break;
      before = now;
    }
    length[std::size_t(n)] = std::min(t, max_ray_mm);
    s.closed_ratio += (t < max_ray_mm) / double(rays);
    s.least_mm = std::min(s.least_mm, t);
  }
  double twice = 0, x = 0, y = 0;
  for (int n = 0; n < rays; ++n) {
    const double a = 2 * M_PI * n / rays, b = a + 2 * M_PI / rays;
    const double p = length[std::size_t(n)], q = length[std::size_t((n + 1) % rays)];
    const double piece = p * q * std::sin(2 * M_PI / rays);
    twice += piece;
    x += piece * (p * std::cos(a) + q * std::cos(b)) / 3;
    y += piece * (p * std::sin(a) + q * std::sin(b)) / 3;
  }
  s.area_mm2 = 0.5 * twice;
  if (twice > 0) s.middle_mm = at + across * (x / twice) + up * (y / twice);
  return s;
}

double lean_deg(const PediclePlace& place, Vec3 f) {
  return std::atan2((place.left ? -1 : 1) * dot(f, place.across()), dot(f, place.forwards())) * 180 / M_PI;
}
double rise_deg(const PediclePlace& place, Vec3 f) {
  return std::asin(std::clamp(dot(f, place.up), -1.0, 1.0)) * 180 / M_PI;
}

AxisLine find_axis(const BoneDistance& bone, const PediclePlace& place) {
  const AxisLine clearest = largest_clearance(bone, place);
  const double enough = clearance_mm(bone, clearest) - equal_mm;
  // From several beginnings, for of a high pedicle's lines with the same clearance any one may be the clearest.
  AxisLine middle;
  double most = -1e9;
  const auto settle = [&](AxisLine line) {
    for (int n = 0; n < 15; ++n)
      if (!through_middles(bone, line)) return;
    const double c = clearance_mm(bone, line);
    if (!(c > most + 1e-3)) return;
    most = c;
    middle = line;
  };
  settle(clearest);
  for (const double lean : {15.0, 0.0, 30.0})
    for (const double rise : {0.0, 10.0, -10.0, 20.0}) settle(line_of({{lean, rise, 0, 0}}, place));
  if (!(most > -1e8)) return clearest;
  // The nearest to the middles that keeps the clearance. Both lines are taken at the same place along them, so that
  // what lies between is a line.
  const Vec3 from = clearest.at_mm + clearest.forwards * dot(middle.at_mm - clearest.at_mm, clearest.forwards);
  for (double share = 1; share > 0; share -= 0.125) {
    const AxisLine between{from + (middle.at_mm - from) * share,
                           normalized(clearest.forwards + (middle.forwards - clearest.forwards) * share)};
    if (clearance_mm(bone, between) >= enough) return between;
  }
  return clearest;
}

}  // namespace trephine::trunk
