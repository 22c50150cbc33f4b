// SPDX-License-Identifier: GPL-3.0-or-later
// What is as dense as fresh blood, and what is darker than white matter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "findings/findings_parts.h"
#include "mask/filters.h"

namespace trephine::findings {
namespace {

constexpr double core_hu = 2;    ///< above blood_hu, in which it begins
constexpr double core_mm = 1.6;  ///< a ball of this radius fits into it
constexpr double grow_mm = 10;   ///< it goes on so far into places where it would not begin
constexpr double beside_mm = 8;  ///< below the inner table
constexpr double at_ventricle_mm = 2.5, at_tube_mm = 5;
constexpr double near_place_mm = 10;  ///< wide ventricles reach so far beyond the template's
constexpr double touching = 0.2, little_touching = 0.02, at_place_mm = 4, at_horn_mm = 9;
constexpr double flat_ratio = 0.35;  ///< of the spread across the slices to the longest: blood does not keep to slices
constexpr double high_mm = 20, high_slices = 4;  ///< what is higher is not flat, however long: a level in both horns is
constexpr double streak_ratio = 1.4;             ///< of the jumps between slices there to those of the scan
constexpr double thick_streaks = 1.25;  ///< times that in slices of 6 mm, whose neighbours differ as tissue does
constexpr double clear_mm = 3, min_cells = 60;
constexpr double max_doubtful = 0.42;
/// With contrast medium: about a vessel lies a rim that is as dense as blood, and what takes up medium is no larger
/// than a bleed that need not be told first.
constexpr double vessel_rim_mm = 5, most_at_vessels = 0.1, least_beside_medium_ml = 3, sure_beside_medium_ml = 9;
/// Air at the base is that of sinuses and bone cells whose walls the scan does not show; frontal sinuses reach higher.
constexpr double min_air_ml = 1, above_base_mm = 16, above_sinuses_mm = 45, off_sinuses_mm = 12;
constexpr double dark_core_mm = 3.5, dark_smooth_mm = 1.5;
constexpr double off_ventricles_mm = 4, off_surface_mm = 6, off_cistern_mm = 5;

/// Where a usual head is as dense as blood, by the template: sinuses, tentorium, falx, and the vessels of the base.
bool is_usually_dense(const Inside& in, Vec3 lps, double depth_mm) {
  if (!in.place.sure) return depth_mm < 4;
  const Vec3 t = in.place.to_template(lps);
  const bool falx = std::abs(t.x) < 7, top_of_falx = std::abs(t.x) < 15 && depth_mm < 17;
  const bool tentorium = t.y > 18 && t.z > -28 && t.z < 42 && (depth_mm < 14 || t.z - 0.35 * (t.y - 30) < 30);
  const bool base = t.z < 16;
  return falx || top_of_falx || tentorium || base;
}

std::vector<Vec3> points_of(const Inside& in, const mask::BitMask& m) {
  std::vector<Vec3> points;
  for (int k = 0; k < m.lattice().size[2]; ++k)
    for (int j = 0; j < m.lattice().size[1]; ++j)
      for (int i = 0; i < m.lattice().size[0]; ++i)
        if (m.get(i, j, k)) points.push_back(in.lps(i, j, k));
  return points;
}

double mean_in(const Inside& in, const mask::BitMask& m) {
  double sum = 0, n = 0;
  for (int k = 0; k < m.lattice().size[2]; ++k)
    for (int j = 0; j < m.lattice().size[1]; ++j)
      for (int i = 0; i < m.lattice().size[0]; ++i)
        if (m.get(i, j, k) && in.tissue.at(i, j, k) > -1000) sum += in.tissue.at(i, j, k), ++n;
  return n > 0 ? sum / n : 0;
}

mask::BitMask between(const grid::Grid<float>& values, double from, double to) {
  return mask::make_mask(values, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < values.size[0]; ++i) row[i] = values.at(i, j, k) > from && values.at(i, j, k) < to;
  });
}

mask::BitMask opened(const mask::BitMask& m, double radius_mm, const Progress& progress) {
  return mask::both(mask::dilated(mask::eroded(m, radius_mm, progress), radius_mm, progress), m);
}

/// One mask for each component of at least so many ml, the largest first.
std::vector<mask::BitMask> pieces_of(const mask::BitMask& m, double ml) {
  const mask::Components all = mask::components(m);
  std::vector<std::size_t> order;
  for (std::size_t c = 0; c < all.list.size(); ++c)
    if (double(all.list[c].voxels) * m.lattice().voxel_volume_mm3() / 1000 >= ml) order.push_back(c);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return all.list[a].voxels > all.list[b].voxels; });
  std::vector<mask::BitMask> pieces;
  for (const std::size_t c : order) {
    std::vector<char> keep(all.list.size(), 0);
    keep[c] = 1;
    pieces.push_back(mask::select(all, keep));
  }
  return pieces;
}

/// Share of the piece's cells for which the test holds.
template <class Test>
double share(const mask::BitMask& m, const Test& test) {
  double n = 0, yes = 0;
  for (int k = 0; k < m.lattice().size[2]; ++k)
    for (int j = 0; j < m.lattice().size[1]; ++j)
      for (int i = 0; i < m.lattice().size[0]; ++i)
        if (m.get(i, j, k)) ++n, yes += test(i, j, k);
  return n > 0 ? yes / n : 0;
}

/// How much the tissue of each slice jumps against the mean of its two neighbours (rms, HU), away from `without`; 0
/// where too little of it is seen. Streaks of metal and of thick bone differ from slice to slice, tissue hardly does.
std::vector<double> slice_jumps(const Inside& in, mask::BitMask without, const Progress& progress) {
  without = mask::dilated(without, clear_mm, progress);
  const grid::Lattice& l = in.cells();
  std::vector<double> jumps(std::size_t(l.size[2]), 0);
  for (int k = 1; k + 1 < l.size[2]; ++k) {
    double squares = 0, n = 0;
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const float below = in.tissue.at(i, j, k - 1), here = in.tissue.at(i, j, k), above = in.tissue.at(i, j, k + 1);
        if (!in.envelope.get(i, j, k) || without.get(i, j, k) || std::min({below, here, above}) <= -1000) continue;
        const double jump = here - 0.5 * (below + above);
        squares += jump * jump, ++n;
      }
    if (n >= min_cells) jumps[std::size_t(k)] = std::sqrt(squares / n);
  }
  return jumps;
}

double usual_jump(const std::vector<double>& jumps) {
  std::vector<float> known;
  for (const double j : jumps)
    if (j > 0) known.push_back(float(j));
  return known.empty() ? 0 : double(mask::median(known, 0));
}

/// The spread of a piece across the slices (standard deviation, mm), and the mean of their jumps.
struct InSlices {
  double sigma_mm = 0, jump = 0;
};
InSlices in_slices(const mask::BitMask& m, const std::vector<double>& jumps) {
  double n = 0, sum = 0, squares = 0, jump = 0, known = 0;
  for (int k = 0; k < m.lattice().size[2]; ++k) {
    double here = 0;
    for (int j = 0; j < m.lattice().size[1]; ++j)
      for (int i = 0; i < m.lattice().size[0]; ++i) here += m.get(i, j, k);
    n += here, sum += here * k, squares += here * k * k;
    if (jumps[std::size_t(k)] > 0) known += here, jump += here * jumps[std::size_t(k)];
  }
  if (n == 0) return {};
  const double variance = std::max(0.0, squares / n - (sum / n) * (sum / n));
  return {std::sqrt(variance) * m.lattice().spacing_mm.z, known > 0 ? jump / known : 0};
}

}  // namespace

std::string ml_text(double ml) { return ml < 10 ? fmt::format("{:.1f} ml", ml) : fmt::format("{:.0f} ml", ml); }

std::vector<Seen> dense_tissue(const Inside& in, const std::vector<Seen>& implants, const FindingsParams& p,
                               const Progress& progress) {
  // Noise is no blood: what is left of it in the smoothed tissue comes on top.
  const double lower = p.blood_hu + std::max(0.0, 2.5 * in.noise_hu - 8);
  mask::BitMask bright = between(in.tissue, lower, p.most_blood_hu);
  bright &= in.all;
  mask::BitMask core = opened(between(in.tissue, lower + core_hu, p.most_blood_hu), core_mm, progress);
  core &= in.all;
  core &= mask::make_mask(core.lattice(), [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < core.lattice().size[0]; ++i)
      row[i] = core.get(i, j, k) && !is_usually_dense(in, in.lps(i, j, k), in.depth_mm.at(i, j, k));
  });
  core = mask::at_least_ml(mask::components(core), 0.3 * p.min_blood_ml);
  const mask::BitMask grown = mask::grown_within(core, opened(bright, core_mm, progress), grow_mm, progress);
  mask::BitMask at_tubes(in.cells());
  for (const Seen& s : implants)
    if (s.cells.lattice().count() > 0) at_tubes |= mask::dilated(s.cells, at_tube_mm, progress);
  const bool has_medium = in.contrast_ml > vessels_ml;
  const mask::BitMask by_vessels = has_medium ? mask::dilated(in.vessels, vessel_rim_mm, progress) : mask::BitMask();
  const mask::BitMask at_ventricles = mask::dilated(in.ventricles, at_ventricle_mm, progress);
  const std::vector<double> jumps = slice_jumps(in, grown, progress);
  const double usual = usual_jump(jumps);
  const Vec3 spacing = in.raster.fine.spacing_mm;
  const double slice_mm = std::max({spacing.x, spacing.y, spacing.z});
  const double max_streaks = streak_ratio * (1 + (thick_streaks - 1) * mask::ramp(slice_mm, 3, 6));
  std::vector<Seen> all;
  for (mask::BitMask& piece : pieces_of(grown, p.min_blood_ml)) {
    if (share(piece, [&](int i, int j, int k) { return at_tubes.get(i, j, k); }) > 0.5) continue;
    const Extent e = extent_of(points_of(in, piece));
    const double ml = e.count * in.cell_ml();
    const double shallow = share(piece, [&](int i, int j, int k) { return in.depth_mm.at(i, j, k) < beside_mm; });
    mask::BitMask rim = piece;
    rim.remove(mask::eroded(piece, 1.6, progress));
    const double beside_ventricle = share(rim, [&](int i, int j, int k) { return at_ventricles.get(i, j, k); });
    const auto lateral_mm = [&](int i, int j, int k) {
      const Vec3 t = in.place.to_template(in.lps(i, j, k));
      return std::min(place::place_mm(place::Place::lateral_left, t), place::place_mm(place::Place::lateral_right, t));
    };
    const double in_place = !in.place.sure ? 0 : share(piece, [&](int i, int j, int k) {
      return lateral_mm(i, j, k) < at_place_mm || (beside_ventricle > little_touching &&
                                                   place::horns_mm(in.place.to_template(in.lps(i, j, k))) < at_horn_mm);
    });
    const bool near_place =
        !in.place.sure || share(piece, [&](int i, int j, int k) { return lateral_mm(i, j, k) < near_place_mm; }) > 0.5;
    Seen s;
    s.finding.kind = FindingKind::dense;
    const bool beside = shallow > 0.5;
    const bool in_ventricles = !beside && (beside_ventricle > touching || in_place > 0.5);
    s.finding.where = beside          ? "beside the brain"
                      : in_ventricles ? "in or at the ventricles"
                      : near_place    ? "in the brain, or in a part of the ventricles that was not found"
                                      : "in the brain";
    if (!in_ventricles) s.finding.concerns.push_back("brain");
    if (in_ventricles || (near_place && !beside)) s.finding.concerns.push_back("ventricles");
    s.finding.position_mm = e.middle_mm;
    const double hu = mean_in(in, piece);
    double sure = mask::ramp(ml, 0.3 * p.min_blood_ml, 2 * p.min_blood_ml) * mask::ramp(hu, lower + 3, lower + 14);
    const InSlices slices = in_slices(piece, jumps);
    const double flat = e.sigma_mm[0] > 0 ? slices.sigma_mm / e.sigma_mm[0] : 0;
    const double streaks = usual > 0 ? slices.jump / usual : 0;
    const double high = 3.46 * slices.sigma_mm;  // of an even column
    const bool is_flat = flat < flat_ratio && !(in_ventricles && high > std::max(high_mm, high_slices * slice_mm));
    double at_vessels = 0;
    if (has_medium) {
      at_vessels = share(rim, [&](int i, int j, int k) { return by_vessels.get(i, j, k); });
      sure *= mask::ramp(ml, least_beside_medium_ml, sure_beside_medium_ml);
    }
    if (at_vessels > most_at_vessels || is_flat || streaks > max_streaks || !in.place.sure)
      sure = std::min(sure, max_doubtful);
    s.finding.confidence = std::max(0.1, 0.95 * sure);
    s.finding.figures = {{"volume_ml", ml},
                         {"longest_mm", e.longest_mm()},
                         {"mean_hu", hu},
                         {"flat_ratio", flat},
                         {"streaks_ratio", streaks}};
    s.finding.text = fmt::format("{} as dense as fresh blood ({:.0f} HU, where brain has 30) lie {}", ml_text(ml), hu,
                                 s.finding.where);
    s.cells = std::move(piece);
    all.push_back(std::move(s));
  }
  return all;
}

std::vector<Seen> dark_tissue(const Inside& in, const FindingsParams& p, const Progress& progress) {
  const mask::BitMask seen = between(in.tissue, -500, 1e6);
  const grid::Grid<float> smooth = mask::masked_gaussian(in.tissue, seen, dark_smooth_mm, -1000, 0.15, progress);
  mask::BitMask dark = between(smooth, -20, p.dark_hu);
  dark &= in.envelope;
  dark.remove(mask::dilated(in.ventricles, off_ventricles_mm, progress));
  dark &= mask::make_mask(dark.lattice(), [&](int j, int k, std::uint8_t* row) {
    using place::Place;
    for (int i = 0; i < dark.lattice().size[0]; ++i) {
      row[i] = in.depth_mm.at(i, j, k) > off_surface_mm;
      if (!row[i] || !in.place.sure || !dark.get(i, j, k)) continue;
      const Vec3 t = in.place.to_template(in.lps(i, j, k));
      for (const Place place : {Place::third, Place::fourth, Place::fissure, Place::quadrigeminal, Place::basal,
                                Place::sylvian, Place::lateral_left, Place::lateral_right})
        row[i] = row[i] && place::place_mm(place, t) > off_cistern_mm;
      row[i] = row[i] && t.z > 0;  // the petrous bones darken what lies between them
    }
  });
  mask::BitMask core = opened(dark, dark_core_mm, progress);
  std::vector<Seen> all;
  for (mask::BitMask& piece : pieces_of(core, p.min_dark_ml)) {
    const Extent e = extent_of(points_of(in, piece));
    const double ml = e.count * in.cell_ml(), hu = mean_in(in, piece);
    Seen s;
    s.finding.kind = FindingKind::dark;
    s.finding.where = "in the brain";
    s.finding.position_mm = e.middle_mm;
    s.finding.confidence = std::max(0.1, 0.9 * mask::ramp(ml, 0.5 * p.min_dark_ml, 2 * p.min_dark_ml) *
                                             mask::ramp(hu, p.dark_hu, p.dark_hu - 4) * (in.place.sure ? 1 : 0.5));
    s.finding.concerns = {"brain"};
    s.finding.figures = {{"volume_ml", ml}, {"longest_mm", e.longest_mm()}, {"mean_hu", hu}};
    s.finding.text = fmt::format("{} of the brain are dark ({:.0f} HU, where brain has 30)", ml_text(ml), hu);
    s.cells = std::move(piece);
    all.push_back(std::move(s));
  }
  return all;
}

std::vector<Seen> air_inside(const Inside& in) {
  if (!in.place.sure) return {};
  const mask::BitMask off_base = mask::make_mask(in.cells(), [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < in.cells().size[0]; ++i) {
      const double deep = in.depth_mm.at(i, j, k), up = in.place.to_template(in.lps(i, j, k)).z;
      row[i] = in.air.get(i, j, k) && up > (deep > off_sinuses_mm ? above_base_mm : above_sinuses_mm);
    }
  });
  std::vector<Seen> all;
  for (mask::BitMask& piece : pieces_of(off_base, min_air_ml)) {
    const Extent e = extent_of(points_of(in, piece));
    const double ml = e.count * in.cell_ml();
    Seen s;
    s.finding.kind = FindingKind::dark;
    s.finding.where = "inside the skull";
    s.finding.position_mm = e.middle_mm;
    s.finding.confidence = 0.9 * mask::ramp(ml, 0, 2 * min_air_ml);
    s.finding.concerns = {"brain"};
    s.finding.figures = {{"volume_ml", ml}, {"longest_mm", e.longest_mm()}};
    s.finding.text = fmt::format("{} of air lie inside the skull", ml_text(ml));
    s.cells = std::move(piece);
    all.push_back(std::move(s));
  }
  return all;
}

}  // namespace trephine::findings
