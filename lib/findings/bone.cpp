// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps in the vault, and tubes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "craniometry/skin_arc.h"
#include "findings/findings_parts.h"
#include "mask/filters.h"

namespace trephine::findings {
namespace {

constexpr double step_mm = 0.5, reach_mm = 45;
// Below the vault the occipital bone is looked through from the cerebellum: backwards, between the foramen magnum and
// the inion, through the muscles of the nape.
constexpr Vec3 cerebellum_mm{0, 42, -2};
constexpr double nape_mm = 95, backwards = 0.45, most_down = 0.62, most_up = 0.35;
constexpr float skin_hu = -400;
constexpr double scalp_mm = 4;
constexpr double off_bone_mm = 2.5, straight_mm = 3, thick_mm = 4.5;
constexpr double slices_doubtful = 2, slices_sure = 5;  ///< slices that a gap is wide
constexpr double round_ratio = 0.6, max_of_hole = 0.75, hole_doubtful = 0.8, hole_sure = 1.6;
constexpr double few_slices = 4, many_slices = 9;  ///< that a tube is long
constexpr double brain_hu = 30, noise_above = 3;
constexpr double flat_slices = 1, deep_slices = 5;  ///< through which it goes
constexpr double flat_mm = 3, deep_mm = 9;          ///< likewise; a streak is as deep as the metal that casts it
constexpr double suture_mm = 4;                     ///< a gap of bone that is narrower is a suture or a thin place

float hu_near(const mask::HuView& hu, Vec3 lps) {
  const Vec3 p = hu.lattice().to_index(lps);
  const int i = int(std::lround(p.x)), j = int(std::lround(p.y)), k = int(std::lround(p.z));
  return hu.lattice().contains(i, j, k) ? hu(i, j, k) : -3000.f;
}

/// What a ray from the middle of the head meets beyond the brain.
enum class Ray { bone, gap, unknown };
struct Met {
  Ray is = Ray::unknown;
  Vec3 at_mm;  ///< where it leaves the inside of the head
};

// The skull is read between its voxels. The nearest voxel alone closes a burr hole in thick slices: a slanting ray
// meets the step of the slice above or below before it is through.
Met along(const Inside& in, const mask::HuView& hu, const craniometry::FieldView& skull, Vec3 from, Vec3 way,
          double farthest_mm) {
  const grid::Lattice& cells = in.cells();
  double inner = 0;
  bool inside = false;
  for (double d = 0; d < 130; d += 1) {
    const Vec3 p = cells.to_index(from + way * d);
    const int i = int(std::lround(p.x)), j = int(std::lround(p.y)), k = int(std::lround(p.z));
    if (!cells.contains(i, j, k)) break;
    if (in.all.get(i, j, k)) inner = d, inside = true;
  }
  Met met;
  if (!inside) return met;
  met.at_mm = from + way * inner;
  for (double d = inner - 6; d < inner + farthest_mm; d += step_mm) {
    const Vec3 lps = from + way * d;
    const float value = hu_near(hu, lps);
    if (value < -2500) return met;  // the scan ends
    if (skull(lps) > 0) return met.is = Ray::bone, met;
    // Where the scan or its field cuts the head, the brain ends in air, without a scalp over it.
    if (d > inner && value < skin_hu) return met.is = d > inner + scalp_mm ? Ray::gap : Ray::unknown, met;
  }
  return met;
}

/// Streaks of metal are thin, straight and long, and keep to the slices of the metal; a catheter goes through many. One
/// that lies along the slices cannot be told from a streak.
double goes_through_slices(const std::vector<Vec3>& points, const grid::Lattice& l) {
  double low = 1e9, high = -1e9;
  for (const Vec3& p : points) {
    const double k = l.to_index(p).z;
    low = std::min(low, k);
    high = std::max(high, k);
  }
  const double slices = high - low + 1;
  return std::min(mask::ramp(slices, flat_slices, deep_slices), mask::ramp(slices * l.spacing_mm.z, flat_mm, deep_mm));
}

}  // namespace

std::vector<Seen> bone_gaps(const Inside& in, const grid::HuVolume& volume, const grid::Field& skull,
                            const FindingsParams& params) {
  const mask::HuView hu(volume);
  const craniometry::FieldView bone(skull, hu.lattice());
  std::vector<Vec3> at;
  std::vector<double> area;  // mm^2 of a ray's share of the bone
  const auto look = [&](Vec3 middle, Vec3 way, double farthest_mm) {
    const Met met = along(in, hu, bone, middle, way, farthest_mm);
    if (met.is != Ray::gap) return;
    const double out = norm(met.at_mm - middle);
    at.push_back(met.at_mm);
    area.push_back(direction_sr * out * out);
  };
  const Vec3 middle = in.envelope.centre_mm();
  const std::vector<Vec3> directions = even_directions();
  for (const Vec3& way : directions)
    if (in.place.sure ? in.place.to_template(middle + way * 70).z >= vault_mm : way.z >= 0.35)
      look(middle, way, reach_mm);
  const std::size_t of_vault = at.size();
  if (in.place.sure) {
    const Vec3 cerebellum = in.place.to_lps(cerebellum_mm);
    for (const Vec3& way : directions) {
      const Vec3 towards = normalized(in.place.to_template(cerebellum + way * 50) - cerebellum_mm);
      if (towards.y > backwards && towards.z < most_up && towards.z > -most_down) look(cerebellum, way, nape_mm);
    }
  }
  // Rays that lie beside each other are one gap.
  const double near_mm = 2.2 * 75 * std::sqrt(direction_sr);
  std::vector<int> of(at.size(), -1);
  std::vector<Seen> all;
  int gaps = 0;
  for (std::size_t first = 0; first < at.size(); ++first) {
    if (of[first] >= 0) continue;
    std::vector<std::size_t> members{first};
    of[first] = gaps;
    for (std::size_t m = 0; m < members.size(); ++m)
      for (std::size_t o = 0; o < at.size(); ++o)
        if (of[o] < 0 && (o < of_vault) == (first < of_vault) && norm(at[o] - at[members[m]]) < near_mm)
          of[o] = gaps, members.push_back(o);
    ++gaps;
    std::vector<Vec3> points;
    double mm2 = 0;
    for (const std::size_t m : members) points.push_back(at[m]), mm2 += area[m];
    const Extent e = extent_of(points);
    if (mm2 / 100 < params.min_gap_cm2 || 3.46 * e.sigma_mm[1] < suture_mm) continue;
    Seen s;
    s.finding.kind = FindingKind::bone_gap;
    const bool vault = first < of_vault;
    s.finding.where = vault ? "in the vault" : "in the occipital bone";
    s.finding.position_mm = e.middle_mm;
    const double slice =
        std::max({in.raster.fine.spacing_mm.x, in.raster.fine.spacing_mm.y, in.raster.fine.spacing_mm.z});
    const double width_mm = 3.46 * e.sigma_mm[1], cm2 = mm2 / 100, min_cm2 = params.min_gap_cm2;
    // A gap that is many slices wide is no thin place between two of them.
    const double slices = std::max(mask::ramp(slice, 8, 3), mask::ramp(width_mm / slice, slices_doubtful, slices_sure));
    double sure = 0.95 * mask::ramp(cm2, 0.3 * min_cm2, 3 * min_cm2) * slices;
    // A small one that is as wide as it is long, and wider than a slice, is a hole that was made: thin places and
    // sutures are long.
    if (e.sigma_mm[1] > round_ratio * e.sigma_mm[0])
      sure = std::max(sure, max_of_hole * mask::ramp(cm2, 0.5 * min_cm2, 1.2 * min_cm2) *
                                mask::ramp(width_mm / slice, hole_doubtful, hole_sure));
    s.finding.confidence = sure * (in.place.sure ? 1 : 0.5);
    s.finding.figures = {{"area_cm2", cm2}, {"longest_mm", 3.46 * e.sigma_mm[0]}, {"width_mm", width_mm}};
    s.finding.text = fmt::format("the {} has a gap of {:.1f} cm2, {:.0f} mm long", vault ? "vault" : "occipital bone",
                                 mm2 / 100, 3.46 * e.sigma_mm[0]);
    if (mm2 > 500) s.finding.concerns = {"brain"};  // the brain bulges or sinks there, and no bone bounds it
    all.push_back(std::move(s));
  }
  std::stable_sort(all.begin(), all.end(), [](const Seen& a, const Seen& b) {
    return a.finding.figures[0].second > b.finding.figures[0].second;
  });
  return all;
}

std::vector<Seen> tubes(const Inside& in, const grid::HuVolume& volume, const FindingShapes& shapes,
                        const FindingsParams& params, const Progress& progress) {
  const mask::HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  std::vector<Seen> all;
  // Dense, thin, long and straight, in the brain.
  const double slice = std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  mask::BitMask deep = mask::fine_mask(in.envelope, in.raster);
  deep.remove(mask::dilated(mask::positive(*shapes.skull, l), std::max(off_bone_mm, 1.05 * slice), progress));
  // Voxels of the brain that a sharp kernel's noise takes above tube_hu hang together in lines.
  mask::BitMask dense = mask::above(hu, std::max(params.tube_hu, brain_hu + noise_above * shapes.voxel_noise_hu));
  dense &= deep;
  const mask::Components pieces = mask::components(dense, true);
  std::vector<std::vector<Vec3>> of(pieces.list.size());
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) {
    of[std::size_t(c)].push_back(l.to_world_mm({double(i), double(j), double(k)}));
  });
  for (std::size_t c = 0; c < of.size(); ++c) {
    const Extent e = extent_of(of[c]);
    if (e.count < 8 || e.longest_mm() < params.min_tube_mm || e.sigma_mm[1] > straight_mm) continue;
    const double mm3 = e.count * l.voxel_volume_mm3(), thick = std::sqrt(mm3 / e.longest_mm() * 4 / pi);
    if (thick > thick_mm) continue;
    // The basilar artery and the sinuses run along the midline and the base.
    if (in.place.sure && in.place.to_template(e.middle_mm).z < 20) continue;
    if (std::abs(in.place.sure ? in.place.to_template(e.middle_mm).x : 10) < 3) continue;
    Seen s;
    s.finding.kind = FindingKind::tube;
    s.finding.where = "in the brain";
    s.finding.position_mm = e.middle_mm;
    // A tube that goes on through many thick slices is none of their streaks.
    const double slices =
        std::max(mask::ramp(slice, 5, 1.5), mask::ramp(e.longest_mm() / slice, few_slices, many_slices));
    const double through = goes_through_slices(of[c], l);
    s.finding.confidence = in.contrast_ml > vessels_ml ? std::min(0.4, through)
                           : in.place.sure             ? 0.85 * slices * through
                                                       : 0.45 * through;
    s.finding.figures = {{"longest_mm", e.longest_mm()}, {"width_mm", thick}};
    s.finding.concerns = {"ventricles"};
    s.finding.text =
        fmt::format("a tube of {:.0f} mm, about {:.1f} mm thick, lies in the brain", e.longest_mm(), thick);
    mask::BitMask own(l);
    for (const Vec3& p : of[c]) {
      const Vec3 q = l.to_index(p);
      own.set(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z)));
    }
    s.cells = mask::coarse_mask(own, in.raster, 0);
    all.push_back(std::move(s));
  }
  return all;
}

}  // namespace trephine::findings
