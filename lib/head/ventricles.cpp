// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricles.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "grid/resample_cubic.h"
#include "head/brain_box.h"
#include "head/deep_csf.h"
#include "head/horns.h"
#include "head/soft_tissue.h"
#include "head/ventricle_blood.h"
#include "head/ventricle_parts.h"
#include "head/ventricles_fit.h"
#include "mask/filters.h"
#include "mask/streaks.h"
#include "mask/surface_field.h"
#include "segmentation/finish.h"

namespace trephine::head {
namespace {

constexpr double strength_ratio = 0.4;   ///< strength of denoising for each unit of noise, mm^-0.5
constexpr double envelope_close_mm = 8;  ///< sulci narrower than twice this do not count as the brain's outside
constexpr double shell_mm = 4;           ///< no ventricle is searched for this near to the outside
constexpr double cut_sigma_mm = 1.0;
constexpr double cut_scale_hu = 8;
constexpr double cut_scale_mm = 0.8;
constexpr double max_voxel_mm = 1.0;
constexpr double clear_mm = 1;          ///< the edge is not searched for this near to other fluid
constexpr double start_sigma_mm = 0.5;  ///< smooths the steps of the voxels before the fit
constexpr double edge_may_move_hu = 5;
constexpr double edge_share = 0.5;
constexpr double horns_reach_mm = 45;  ///< horns are searched for this far from the ventricles

constexpr BrainBox about_monro{{-10, -28, -12}, {10, -2, 14}};  ///< foramina and septum

/// The mean of the middle half of the sorted values: as robust as the median, and finer than one unit on integers.
double middle_of(std::vector<float>& v) {
  const auto from = v.begin() + std::ptrdiff_t(v.size() / 4), to = v.begin() + std::ptrdiff_t(v.size() - v.size() / 4);
  std::sort(v.begin(), v.end());
  double sum = 0;
  for (auto i = from; i < to; ++i) sum += *i;
  return sum / double(to - from);
}

/// Halfway between the HU inside the shape and those of the tissue around it, as far as `otherwise` allows.
double half_of_both_sides(const grid::Grid<float>& hu, const mask::BitMask& shape, const mask::BitMask& brain,
                          double otherwise, const Progress& progress) {
  const mask::BitMask inner = mask::eroded(shape, 1.0, progress);
  mask::BitMask outer = mask::dilated(shape, 4.0, progress);
  outer.remove(mask::dilated(shape, 2.0, progress));
  outer &= brain;
  std::vector<float> inside, around;
  for (int k = 0; k < hu.size[2]; ++k)
    for (int j = 0; j < hu.size[1]; ++j)
      for (int i = 0; i < hu.size[0]; ++i) {
        if (inner.get(i, j, k))
          inside.push_back(hu.at(i, j, k));
        else if (outer.get(i, j, k))
          around.push_back(hu.at(i, j, k));
      }
  if (inside.size() < 100 || around.size() < 100) return otherwise;
  const double low = middle_of(inside), high = middle_of(around);
  return std::clamp(low + edge_share * (high - low), otherwise - edge_may_move_hu, otherwise + edge_may_move_hu);
}

/// Merges a x a voxels of each slice into their mean.
grid::Grid<float> merged(const grid::Grid<float>& g, int a) {
  grid::Lattice l = g;
  l.size = {g.size[0] / a, g.size[1] / a, g.size[2]};
  l.spacing_mm = {g.spacing_mm.x * a, g.spacing_mm.y * a, g.spacing_mm.z};
  l.origin_mm = g.to_world_mm({0.5 * (a - 1), 0.5 * (a - 1), 0});
  grid::Grid<float> out(l);
  parallel_for(0, l.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int b = 0; b < a; ++b) {
          const float* row = &g.at(0, j * a + b, k);
          for (int i = 0; i < l.size[0]; ++i)
            for (int c = 0; c < a; ++c) out.at(i, j, k) += row[i * a + c] / float(a * a);
        }
  });
  return out;
}

/// Set where at least half of the a x a voxels are set.
mask::BitMask merged(const mask::BitMask& m, const grid::Lattice& l, int a) {
  return mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      int n = 0;
      for (int b = 0; b < a; ++b)
        for (int c = 0; c < a; ++c) n += m.get(i * a + c, j * a + b, k);
      row[i] = 2 * n >= a * a;
    }
  });
}

Outcome<grid::Field, VentriclesResult> ventricles_in(const mask::HuView& hu, const VentriclesMasks& masks,
                                                     const VentriclesParams& p, const Progress& progress) {
  const grid::Box brain_box = grid::grown(mask::positive(*masks.brain, *masks.brain).bounds(), 1, *masks.brain);
  if (brain_box.empty())
    throw refusal("brain", "the mask is empty: 0 voxels",
                  {"lower `lower_hu` or raise `upper_hu` of the stage `brain`, or paint it and bring it back by the "
                   "stage `labels`"});
  const grid::Lattice whole = grid::cropped(*masks.brain, brain_box);
  const grid::Box box = grid::place_in(whole, hu.lattice());
  for (int a = 0; a < 3; ++a)
    if (box.begin[a] < 0 || box.end[a] > hu.lattice().size[a])
      throw Error(ExitCode::bad_input, "", "brain", "the field reaches beyond the volume");
  VentriclesResult result;
  const bool fitted = p.edge == segmentation::SegmentEdge::half_maximum;
  // Finer voxels add no information about the shape; the edge is fitted between the voxels.
  const int merge = fitted ? std::clamp(int(max_voxel_mm / std::max(whole.spacing_mm.x, whole.spacing_mm.y)), 1,
                                        std::min(whole.size[0], whole.size[1]))
                           : 1;
  grid::Grid<float> raw = merged(mask::crop(hu, box), merge);
  const grid::Lattice l = raw;
  const mask::BitMask fine_brain = mask::positive(*masks.brain, whole);
  const mask::BitMask brain = merged(fine_brain, l, merge);
  const grid::Box roi = mask::region_of_interest(hu.lattice(), p.roi_min_mm, p.roi_max_mm);
  mask::BitMask free(grid::cropped(hu.lattice(), roi));
  free = mask::placed(free.invert(), whole);
  if (masks.without) free.remove(mask::positive(*masks.without, whole));
  const mask::BitMask allowed = merged(free, l, merge);

  // The brain's surface with its sulci closed, from which depths are measured.
  mask::BitMask envelope = mask::closed(brain, envelope_close_mm, progress);
  envelope |= mask::holes(envelope, {0, 1000, true}, progress);
  mask::BitMask known = mask::eroded(envelope, shell_mm, progress);
  const auto soft_alone = [&] {
    return mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = raw.at(i, j, k) > -100 && raw.at(i, j, k) < 160;
    });
  };
  if (p.smoothing_sigma_mm > 0) {
    // Noise takes single voxels out of the range, which are tissue all the same.
    mask::BitMask averaged = known;
    averaged &= soft_alone();
    raw = mask::masked_gaussian(std::move(raw), averaged, p.smoothing_sigma_mm, 1000, 0.02, progress);
  }
  known &= soft_alone();
  if (p.edge == segmentation::SegmentEdge::half_maximum) result.level = level_tissue(raw, known, progress);
  const std::vector<mask::StreakedSlice> streaks = mask::remove_streaks(raw, known, progress);
  SoftTissue denoised = soft_tissue(raw, known, strength_ratio, 1000, progress);
  result.tissue_noise_hu_mm1_5 = denoised.noise_hu_mm1_5;
  grid::Field soft = std::move(denoised.image);
  const double noise = denoised.noise_hu_mm1_5;
  check_noise(noise, raw, p.smoothing_sigma_mm);
  progress.report(0.4);
  const double lower = p.lower_hu;
  double upper = p.upper_hu;
  envelope &= allowed;
  mask::BitMask others, cut_off;
  mask::BitMask wide = wide_csf(soft, envelope, lower, upper, progress);
  place::HeadPlace place = place::place_head(envelope, &wide, hu.lattice(), progress);
  // Without its blood they do not lie where the template has them.
  if (const double ml = show_blood_as_fluid(raw, soft, {envelope, known, wide, lower, upper}, place, progress);
      ml > 0) {
    result.blood_ml = ml;
    soft = soft_tissue(raw, known, strength_ratio, 1000, progress).image;
    wide = wide_csf(soft, envelope, lower, upper, progress);
    place = place::place_head(envelope, &wide, hu.lattice(), progress);
  }
  result.place = figures_of(place);
  Warnings warnings = warnings_of(place);
  if (result.blood_ml)
    warnings.push_back({"blood_in_ventricles",
                        "{blood_ml:.1f} ml in the ventricles are as dense as fresh blood, and belong to them here",
                        {{"blood_ml", *result.blood_ml}}});
  mask::BitMask shape = deep_csf(soft, envelope, place, lower, upper, progress, &others, &cut_off);
  progress.report(0.6);
  if (p.edge == segmentation::SegmentEdge::half_maximum && shape.any()) {
    upper = half_of_both_sides(soft, shape, brain, upper, progress);
    shape = deep_csf(soft, envelope, place, lower, upper, progress, &others, &cut_off);
  }
  result.upper_hu = upper;
  if (const auto stubs = warn_of_stubs(cut_off, shape)) warnings.push_back(*stubs);
  if (p.close_mm > 0) shape = mask::closed(shape, p.close_mm, progress);
  shape |= mask::holes(shape, {p.fill_close_mm, 5, false}, progress);  // choroid plexus, calcified or not
  shape &= brain;
  if (!shape.any()) mask::check_mask(shape, hu.lattice().count());
  progress.report(0.8);
  const auto margin = [&](double mm) {
    return int(std::ceil(mm / std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z})));
  };
  const Vec3 centre = envelope.centre_mm();
  grid::Field horns;
  int horns_count = 0;
  mask::BitMask course(l);
  if (p.edge == segmentation::SegmentEdge::half_maximum) {
    const grid::Box around = grid::grown(shape.bounds(), margin(horns_reach_mm), l);
    horns =
        find_horns(trephine::grid::crop(raw, around), mask::crop(known, around), mask::crop(envelope, around),
                   mask::crop(others, around), mask::crop(shape, around), centre, place, noise, horns_count, progress);
    result.horns_count = horns_count;
    course = mask::positive(horns, l);
    course &= brain;
  }
  mask::BitMask both = shape;
  both |= course;
  const grid::Box cut = grid::grown(both.bounds(), margin(6), l);
  grid::Field field;
  mask::BitMask found;
  if (fitted) {
    known.remove(mask::dilated(others, clear_mm, progress));
    grid::Field start(grid::cropped(l, cut));
    shape = mask::crop(shape, cut);
    for (int k = 0; k < start.size[2]; ++k)
      for (int j = 0; j < start.size[1]; ++j)
        for (int i = 0; i < start.size[0]; ++i) start.at(i, j, k) = shape.get(i, j, k) ? 0.5f : -0.5f;
    const grid::Grid<float> tubes = grid::fit(horns, start, -4.f);
    mask::gaussian(start, start_sigma_mm, progress);
    start = mask::signed_distance_mm(start, progress);
    for (std::size_t v = 0; v < tubes.voxels.size() && horns_count > 0; ++v)
      start.voxels[v] = std::max(start.voxels[v], tubes.voxels[v]);
    const mask::BitMask necks = mask::make_mask(start, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < start.size[0]; ++i)
        row[i] = about_monro.holds(start.to_world_mm({double(i), double(j), double(k)}) - centre);
    });
    start = fit_fluid(trephine::grid::crop(raw, cut), mask::crop(known, cut), start, noise, &necks, progress);
    // Back to the volume's voxels.
    const grid::Box out{{cut.begin[0] * merge, cut.begin[1] * merge, cut.begin[2]},
                        {cut.end[0] * merge, cut.end[1] * merge, cut.end[2]}};
    field = grid::resampled_cubic(start, grid::cropped(whole, out), progress);
    found = mask::positive(field, field);
    found &= mask::crop(fine_brain, out);
    found = believable_pieces(found, place);
    found |= mask::holes(found, {p.fill_close_mm, 5, false}, progress);
    if (!found.any()) mask::check_mask(found, hu.lattice().count());
  } else {
    for (float& v : soft.voxels) v = std::min(v - float(lower), float(upper) - v);
    field = trephine::grid::crop(soft, cut);
    found = mask::crop(shape, cut);
  }
  result.cut_voxels_count =
      mask::place_surface(field, found, cut_sigma_mm, fitted ? cut_scale_mm : cut_scale_hu, progress);
  const auto parts = measure_parts(found, place);
  result.parts = parts.result;
  warnings.insert(warnings.end(), parts.warnings.begin(), parts.warnings.end());
  result.streaked_slices_count = streaks.size();
  if (const auto crossed = warn_of_streaks(streaks, l, found)) warnings.push_back(*crossed);
  const double ml = double(found.count()) * whole.voxel_volume_mm3() / 1000;
  if (ml < 3 || ml > 200)
    warnings.push_back({"unusual_ventricles", "the ventricles found are not of the size of an adult's", {}});
  return {std::move(field), std::move(result), std::move(warnings)};
}

}  // namespace
}  // namespace trephine::head

namespace trephine::head {

Outcome<grid::Field, VentriclesResult> find_ventricles(const grid::HuVolume& volume, const VentriclesMasks& masks,
                                                       const VentriclesParams& params, const Progress& progress) {
  if (!masks.brain) throw Error(ExitCode::usage, "", "brain", "is needed: the field of the brain that holds them");
  segmentation::check_thresholds(params.lower_hu, params.upper_hu);
  return segmentation::finished<VentriclesResult>(
      volume, {params.grow_mm, 1},
      [&](const mask::HuView& hu) {
        mask::check_varies(volume);
        return ventricles_in(hu, masks, params, progress);
      },
      progress);
}

}  // namespace trephine::head
