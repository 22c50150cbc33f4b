// SPDX-License-Identifier: GPL-3.0-or-later
// Holes of the vault that bone has closed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/pi.h"
#include "craniometry/skin_arc.h"
#include "findings/findings_parts.h"
#include "mask/filters.h"

namespace trephine::findings {
namespace {

constexpr double inner_mm = 40, outer_mm = 125, step_mm = 0.4;  ///< from the middle of the head
constexpr double ring_mm[2] = {11, 18};                         ///< what a ray is compared with
constexpr std::size_t sectors = 8;
constexpr int min_of_sector = 5;
constexpr double min_depth_mm = 1.8, sure_depth_mm = 3;  ///< below the ring
constexpr double most_depth_mm = 10;                     ///< no bone of the vault is thicker
constexpr double max_thickness = 0.75;                   ///< of the ring's: a bump beside it makes no dent
constexpr double min_cm2 = 0.3, most_cm2 = 3, round_ratio = 0.5;
constexpr double slice_doubtful_mm = 6, slice_sure_mm = 3;
constexpr double most_confidence = 0.75;

/// What a ray meets of the vault.
struct Ray {
  Vec3 way;
  double inner = 0, outer = 0;  ///< of the bone, from the middle; 0: none, as in a gap
  double depth = 0;             ///< of the outer table below that of the ring
};

/// How far the outer table lies from the middle, in a sector of a ring.
struct Level {
  double sum = 0;
  int count = 0;
};

/// How far the outer table lies below all lines across the ring: a groove does not lie below those along it, nor an
/// edge below all. 0 where a part of the ring is not there.
double depth_below(const std::array<Level, sectors>& ring, double outer) {
  double least = 1e9;
  for (std::size_t s = 0; s < sectors / 2; ++s) {
    const Level &a = ring[s], &b = ring[s + sectors / 2];
    if (std::min(a.count, b.count) < min_of_sector) return 0;
    least = std::min(least, 0.5 * (a.sum / a.count + b.sum / b.count));
  }
  return std::max(0.0, least - outer);
}

Ray ray_along(const craniometry::FieldView& skull, Vec3 middle, Vec3 way) {
  Ray r{way};
  for (double d = inner_mm; d < outer_mm; d += step_mm) {
    if (!(skull(middle + way * d) > 0)) continue;
    if (r.outer == 0) r.inner = d;
    r.outer = d;
  }
  return r;
}

}  // namespace

std::vector<Seen> bone_dents(const Inside& in, const grid::Field& skull, const grid::Lattice& scan) {
  if (!in.place.sure) return {};
  const craniometry::FieldView bone(skull, scan);
  const Vec3 middle = in.envelope.centre_mm();
  std::vector<Ray> all;
  for (const Vec3& way : even_directions())
    if (in.place.to_template(middle + way * 70).z >= vault_mm) all.push_back({way});
  parallel_for(0, std::int64_t(all.size()), 64, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) all[std::size_t(n)] = ray_along(bone, middle, all[std::size_t(n)].way);
  });
  const auto apart_mm = [](const Ray& a, const Ray& b, double radius) {
    return radius * std::acos(std::clamp(dot(a.way, b.way), -1.0, 1.0));
  };
  std::vector<char> dented(all.size());
  parallel_for(0, std::int64_t(all.size()), 16, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      Ray& ray = all[std::size_t(n)];
      if (ray.outer == 0) continue;
      const Vec3 east = normalized(cross(ray.way, std::abs(ray.way.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0})),
                 north = cross(ray.way, east);
      std::array<Level, sectors> ring;
      std::vector<float> thickness;
      bool open = false;
      const double least_cosine = std::cos(ring_mm[1] / ray.outer);
      for (const Ray& other : all) {
        if (dot(ray.way, other.way) < least_cosine) continue;
        const double mm = apart_mm(ray, other, ray.outer);
        if (other.outer == 0) open = true;
        if (mm < ring_mm[0] || other.outer == 0) continue;
        const double turn = std::atan2(dot(other.way, north), dot(other.way, east)) / (2 * pi) + 1;
        Level& level = ring[std::size_t(turn * sectors) % sectors];
        level.sum += other.outer, ++level.count;
        thickness.push_back(float(other.outer - other.inner));
      }
      if (open) continue;  // a gap is told as one
      ray.depth = depth_below(ring, ray.outer);
      dented[std::size_t(n)] = ray.depth > min_depth_mm && ray.depth < most_depth_mm &&
                               ray.outer - ray.inner < max_thickness * mask::median(thickness, 0);
    }
  });
  const double near_mm = 2.2 * 75 * std::sqrt(direction_sr);
  std::vector<Seen> found;
  for (std::size_t first = 0; first < all.size(); ++first) {
    if (!dented[first]) continue;
    std::vector<std::size_t> members{first};
    dented[first] = 0;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (std::size_t o = 0; o < all.size(); ++o)
        if (dented[o] && apart_mm(all[o], all[members[m]], 75) < near_mm) dented[o] = 0, members.push_back(o);
    std::vector<Vec3> points;
    double cm2 = 0, depth = 0;
    for (const std::size_t m : members) {
      points.push_back(middle + all[m].way * all[m].outer);
      cm2 += direction_sr * all[m].outer * all[m].outer / 100;
      depth = std::max(depth, all[m].depth);
    }
    const Extent e = extent_of(points);
    if (cm2 < min_cm2 || cm2 > most_cm2 || e.sigma_mm[1] < round_ratio * e.sigma_mm[0]) continue;
    Seen s;
    s.finding.kind = FindingKind::bone_gap;
    s.finding.where = "in the vault";
    s.finding.position_mm = e.middle_mm;
    const double slice_mm = std::max({scan.spacing_mm.x, scan.spacing_mm.y, scan.spacing_mm.z});
    s.finding.confidence = most_confidence * mask::ramp(depth, min_depth_mm, sure_depth_mm) *
                           mask::ramp(slice_mm, slice_doubtful_mm, slice_sure_mm);
    s.finding.figures = {{"area_cm2", cm2}, {"longest_mm", 3.46 * e.sigma_mm[0]}, {"depth_mm", depth}};
    s.finding.text = fmt::format(
        "the vault has a round dent of {:.1f} cm2, {:.1f} mm deep, as where bone has closed a burr hole", cm2, depth);
    found.push_back(std::move(s));
  }
  std::stable_sort(found.begin(), found.end(), [](const Seen& a, const Seen& b) {
    return a.finding.figures[0].second > b.finding.figures[0].second;
  });
  return found;
}

}  // namespace trephine::findings
