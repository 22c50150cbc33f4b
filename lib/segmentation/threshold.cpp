// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/threshold.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "segmentation/even_core.h"

namespace trephine::segmentation {
namespace {

constexpr double edge_reach_mm =
    2.0;  ///< reach of a half-maximum profile: more than the blur, less than a table of bone
constexpr double brightest_bone_hu =
    2000;  ///< enamel and metal count as this, so that they do not erode the bone beside them
constexpr double cut_sigma_mm = 1.0;
constexpr double cut_scale_hu = 100;
constexpr double rejected_piece_ml = 1;  ///< of an opened mask: smaller pieces are thin parts of the kept one (ears)
constexpr double rim_mm = 2;             ///< how deep below the surface of a body a kernel brightens its rim
constexpr double min_rim_ml = 2;         ///< less may be thin bone at the surface
constexpr double max_even_ml = 1;        ///< of bone's inside, in one piece
constexpr double plate_core_mm = 1;      ///< a thin part of at least twice this
constexpr double min_cut_cm2 = 10;       ///< of a body: the field of view cuts it open
constexpr double min_outside_ml = 10;    ///< between the thresholds: what was sought may lie there
constexpr double plate_span_mm = 100;    ///< and this long, cut by the volume's edge, is a table or head holder

/// The value that places the surface: HU above the lower threshold, or below the upper one where that is nearer. The
/// thresholds are inclusive; on integers they are moved half a unit outwards, so that no voxel is 0.
struct Window {
  float lower, upper;
  Window(const SegmentParams& p, bool integers) : lower(float(p.lower_hu)), upper(float(p.upper_hu)) {
    if (integers) {
      lower = float(std::ceil(p.lower_hu) - 0.5);
      upper = float(std::floor(p.upper_hu) + 0.5);
    }
  }
  float operator()(float hu) const { return std::min(hu - lower, upper - hu); }
};

std::vector<char> chosen(const mask::Components& c, const SegmentParams& p) {
  const double voxel_ml = c.lattice.voxel_volume_mm3() / 1000;
  std::vector<char> keep(c.list.size());
  std::size_t best = 0;
  for (std::size_t i = 0; i < c.list.size(); ++i) {
    keep[i] = c.list[i].voxels * voxel_ml >= p.min_component_ml;
    if (c.list[i].voxels > c.list[best].voxels) best = i;
  }
  if (p.components == SegmentComponents::largest && !keep.empty()) {
    const char large_enough = keep[best];
    std::fill(keep.begin(), keep.end(), 0);
    keep[best] = large_enough;
  }
  return keep;
}

double span_mm(const mask::Component& c, const grid::Lattice& l) {
  double span = 0;
  for (int a = 0; a < 3; ++a) span = std::max(span, (c.box.end[a] - c.box.begin[a]) * l.spacing_mm[a]);
  return span;
}

/// Opening by pieces: pieces that fall off when bridges thinner than twice open_mm are cut are dropped, and so are thin
/// plates that the volume cuts; other thin parts (ears, nose) stay. Parts that touch both are split at the narrowest
/// place.
mask::BitMask opened_pieces(const mask::BitMask& mask, const SegmentParams& p, const Progress& progress) {
  const grid::Lattice& l = mask.lattice();
  const double voxel_ml = l.voxel_volume_mm3() / 1000;
  const mask::Components cores = mask::components(mask::eroded(mask, p.open_mm, progress));
  std::vector<char> keep = chosen(cores, p), drop(keep.size());
  for (std::size_t i = 0; i < keep.size(); ++i)
    drop[i] = !keep[i] && cores.list[i].voxels * voxel_ml >= rejected_piece_ml;
  mask::BitMask kept = mask::dilated(mask::select(cores, keep), p.open_mm, progress);
  kept &= mask;
  mask::BitMask dropped = mask::dilated(mask::select(cores, drop), p.open_mm, progress);
  dropped &= mask;
  dropped.remove(kept);
  mask::BitMask thin = mask::eroded(mask, std::min(plate_core_mm, p.open_mm / 2), progress);
  thin.remove(kept).remove(dropped);
  const mask::Components plates = mask::components(thin);
  std::vector<char> is_plate;
  for (const mask::Component& c : plates.list) is_plate.push_back(c.faces > 0 && span_mm(c, l) >= plate_span_mm);
  dropped |= mask::select(plates, is_plate);
  if (!dropped.any()) {
    const mask::Components all = mask::components(mask);
    return mask::select(all, mask::touching(all, kept));
  }

  mask::BitMask rest = mask;
  rest.remove(kept);
  const grid::Box box = grid::grown(rest.bounds(), 1, l);
  rest = mask::crop(rest, box);
  const mask::BitMask core = mask::crop(kept, box), other = mask::crop(dropped, box);
  mask::BitMask outside = mask::crop(mask, box);
  outside.invert();
  grid::Mask seeds(rest.lattice());
  for (int k = 0; k < seeds.size[2]; ++k)
    for (int j = 0; j < seeds.size[1]; ++j)
      for (int i = 0; i < seeds.size[0]; ++i) seeds.at(i, j, k) = core.get(i, j, k) ? 1 : other.get(i, j, k) ? 2 : 0;
  // Only the rim of the kept part takes part.
  mask::BitMask domain = mask::dilated_6(rest);
  domain &= core;
  domain |= rest;
  const grid::Mask labels = mask::flood(mask::distance_mm(outside, progress), domain, seeds, progress);
  const mask::BitMask mine = mask::make_mask(labels, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < labels.size[0]; ++i) row[i] = labels.at(i, j, k) == 1;
  });
  return kept |= mask::placed(mine, l);
}

using Made = Outcome<grid::Field, SegmentResult>;

/// The rim of a body that a kernel which enhances edges makes as bright as bone: what lies within rim_mm of the surface
/// and not beside something of the shape below that, as bone does. Empty where it is little.
mask::BitMask bright_rim(const mask::BitMask& shape, const mask::BitMask& body, Made& made, const Progress& progress) {
  const mask::BitMask deep = mask::both(shape, mask::eroded(body, rim_mm, progress));
  mask::BitMask rim = mask::without(shape, mask::grown_within(deep, shape, rim_mm, progress));
  const double ml = double(rim.count()) * shape.lattice().voxel_volume_mm3() / 1000;
  if (ml < min_rim_ml) return mask::BitMask(shape.lattice());
  made.result.bright_rim_ml = ml;
  made.warnings.push_back({"bright_rim",
                           "{rim_ml:.0f} ml within {within_mm:.0f} mm of the surface are as bright as bone and lie "
                           "beside none, as where a kernel enhances edges: they were left out",
                           {{"rim_ml", ml}, {"within_mm", rim_mm}}});
  return rim;
}

void look_for_blood(const mask::BitMask& shape, const mask::HuView& hu, std::array<int, 3> begin, Made& made,
                    const Progress& progress) {
  const std::optional<EvenCore> found = even_core(shape, hu, begin, progress);
  if (!found) return;
  const EvenCore& core = *found;
  made.result.even_ml = core.ml;
  if (core.ml > max_even_ml)
    made.warnings.push_back(
        {"even_as_blood",
         "{even_ml:.1f} ml of {mean_hu:.0f} HU about ({x_mm:.0f}, {y_mm:.0f}, {z_mm:.0f}) are as even as blood, as "
         "so large a piece of bone is not: vessels or organs with contrast medium are part of it; take a scan without, "
         "or paint them away",
         {{"even_ml", core.ml},
          {"mean_hu", core.mean_hu},
          {"x_mm", core.middle_mm.x},
          {"y_mm", core.middle_mm.y},
          {"z_mm", core.middle_mm.z}}});
}

/// How much of the mask the sides of the volume cut, above and below not counted.
double cut_by_sides_mm2(const mask::BitMask& mask) {
  const grid::Lattice& l = mask.lattice();
  double mm2 = 0;
  for (int k = 0; k < l.size[2]; ++k) {
    for (int j = 0; j < l.size[1]; ++j)
      mm2 += (mask.get(0, j, k) + mask.get(l.size[0] - 1, j, k)) * l.spacing_mm.y * l.spacing_mm.z;
    for (int i = 0; i < l.size[0]; ++i)
      mm2 += (mask.get(i, 0, k) + mask.get(i, l.size[1] - 1, k)) * l.spacing_mm.x * l.spacing_mm.z;
  }
  return mm2;
}

/// Where the field cuts a body open, what the body holds lies outside of it, as a lung does whose chest is cut through.
void require_closed(const mask::BitMask& within, double inside_ml) {
  const double cm2 = cut_by_sides_mm2(within) / 100;
  if (cm2 < min_cut_cm2) return;
  throw refusal(
      "within",
      fmt::format("{:.0f} cm2 of what it must lie inside of are cut by the sides of the field of view, and "
                  "{:.0f} ml between lower_hu and upper_hu are left inside: what a field cuts open lies "
                  "outside",
                  cm2, inside_ml),
      {"take a series whose field of view shows all of the body (`import --list` shows all), or leave it out of the "
       "scene"});
}

}  // namespace

Outcome<grid::Field, SegmentResult> segment_threshold(const mask::HuView& hu, const SegmentMasks& masks,
                                                      const SegmentParams& p, const Progress& progress) {
  Made made;
  const grid::Box roi = mask::region_of_interest(hu.lattice(), p.roi_min_mm, p.roi_max_mm);
  const grid::Lattice work = grid::cropped(hu.lattice(), roi);
  const bool smooth = p.smoothing_sigma_mm > 0;
  const Window window(p, hu.is_integer() && !smooth);
  grid::Grid<float> smoothed_hu;
  if (smooth) {
    smoothed_hu = mask::crop(hu, roi);
    mask::gaussian(smoothed_hu, p.smoothing_sigma_mm, progress);
  }
  progress.report(0.1);
  const auto value = [&](int i, int j, int k) {  // of the working lattice
    return smooth ? smoothed_hu.at(i, j, k) : hu(i + roi.begin[0], j + roi.begin[1], k + roi.begin[2]);
  };
  const auto make = [&](auto&& test) {
    return mask::make_mask(work, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < work.size[0]; ++i) row[i] = test(value(i, j, k));
    });
  };

  mask::BitMask shape = make([&](float v) { return window(v) > 0; });
  double inside_ml = 0, outside_ml = 0;
  if (masks.within) {
    const mask::BitMask within = mask::positive(*masks.within, work);
    const double all_ml = double(shape.count()) * work.voxel_volume_mm3() / 1000;
    shape &= within;
    inside_ml = double(shape.count()) * work.voxel_volume_mm3() / 1000;
    outside_ml = all_ml - inside_ml;
    if (p.seed_lower_hu > p.lower_hu) shape.remove(bright_rim(shape, within, made, progress));
  }
  if (masks.without) shape.remove(mask::positive(*masks.without, work));
  progress.report(0.2);
  if (p.seed_lower_hu > p.lower_hu) {
    const mask::Components pieces = mask::components(shape, true);
    shape = mask::select(pieces, mask::touching(pieces, make([&](float v) { return v >= p.seed_lower_hu; })));
  }
  if (p.open_mm > 0) shape = opened_pieces(shape, p, progress);
  progress.report(0.4);
  if (p.components != SegmentComponents::all || p.min_component_ml > 0) {
    const mask::Components pieces = mask::components(shape);
    made.result.pieces_count = static_cast<std::int64_t>(pieces.list.size());
    shape = mask::select(pieces, chosen(pieces, p));
  }
  if (p.seed_lower_hu > p.lower_hu) look_for_blood(shape, hu, roi.begin, made, progress);
  if (p.close_mm > 0) shape = mask::closed(shape, p.close_mm, progress);
  const mask::FillRule rule{p.fill_close_mm, p.fill_max_ml, p.fill == SegmentFill::cavities_and_cut};
  if (p.fill != SegmentFill::none) {
    const mask::BitMask filled = mask::holes(shape, rule, progress);
    const double voxel_ml = work.voxel_volume_mm3() / 1000;
    made.result.filled_ml = double(filled.count()) * voxel_ml;
    if (p.fill_close_mm > 0) {
      const mask::BitMask enclosed = mask::holes(shape, {0, rule.max_ml, rule.cut_open}, progress);
      made.result.filled_by_closing_ml = (double(filled.count()) - double(enclosed.count())) * voxel_ml;
    }
    shape |= filled;
  }
  progress.report(0.6);
  if (!shape.any()) {
    if (masks.within && outside_ml >= min_outside_ml)
      require_closed(mask::positive(*masks.within, hu.lattice()), inside_ml);
    mask::check_mask(shape, hu.lattice().count());
  }

  grid::Box box = shape.bounds();  // from the working lattice's indices to the volume's
  for (int axis = 0; axis < 3; ++axis) {
    box.begin[axis] += roi.begin[axis];
    box.end[axis] += roi.begin[axis];
  }
  box = grid::grown(box, 3, hu.lattice());
  shape = mask::placed(shape, grid::cropped(hu.lattice(), box));
  grid::Field field = smooth ? grid::fit(smoothed_hu, shape.lattice(), -1e4f) : mask::crop(hu, box);
  smoothed_hu = {};
  if (p.edge == SegmentEdge::half_maximum) {
    for (float& v : field.voxels) v -= window.lower;
    mask::apply_half_maximum(field, shape, window.lower, edge_reach_mm, brightest_bone_hu, progress);
    // Removes small pieces that the moved edge left behind, and fills pores that it opened.
    SegmentParams crumbs;
    crumbs.min_component_ml = std::max(p.min_component_ml, 27 * work.voxel_volume_mm3() / 1000);
    const mask::Components pieces = mask::components(shape);
    shape = mask::select(pieces, chosen(pieces, crumbs));
    if (p.fill != SegmentFill::none) shape |= mask::holes(shape, {0, p.fill_max_ml, rule.cut_open}, progress);
  } else {
    for (float& v : field.voxels) v = window(v);
  }
  progress.report(0.8);
  made.result.cut_voxels_count = mask::place_surface(field, shape, cut_sigma_mm, cut_scale_hu, progress);
  made.value = std::move(field);
  return made;
}

}  // namespace trephine::segmentation
