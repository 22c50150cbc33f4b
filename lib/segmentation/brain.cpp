// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/error.h"
#include "segmentation/filters.h"
#include "segmentation/methods.h"
#include "segmentation/surface_field.h"

namespace trephine::segmentation {
namespace {

constexpr double default_sigma_mm = 1.0;
constexpr double bone_blur_mm = 1.5;    ///< HU this near to bone are not believed
constexpr double bone_margin_mm = 1.0;  ///< and the brain never comes nearer than this: dura and a film of CSF
constexpr double default_open_mm = 2.5;
constexpr double default_close_mm = 3.0;
constexpr double default_fill_close_mm = 10.0;
constexpr double inner_hu = 6;  ///< inside, tissue may be this much darker than at its surface (white matter, oedema)
constexpr double peel_mm = 4;   ///< the surface's threshold works this deep
constexpr double cut_sigma_mm = 1.5;
constexpr double cut_scale_hu = 10;

double or_default(double value, double otherwise) { return value > 0 ? value : otherwise; }

/// The box's HU smoothed over the voxels that hold brain or fluid, far from bone.
Grid<float> soft_tissue(const HuView& hu, const Box& box, const BitMask& cavity, const BitMask& near_bone,
                        double sigma_mm, const Progress& progress) {
  Grid<float> v = crop(hu, box);
  BitMask known = make_mask(v, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < v.size[0]; ++i) row[i] = v.at(i, j, k) > -60 && v.at(i, j, k) < 130;
  });
  known &= cavity;
  known.remove(near_bone);
  return masked_gaussian(std::move(v), known, sigma_mm, -1000, 0.02, progress);
}

}  // namespace

double tissue_shift_hu(const Grid<float>& soft, const BitMask& where, Report& report) {
  constexpr double usual_hu = 30, most_hu = 15;
  std::vector<float> values;
  for (int k = 0; k < soft.size[2]; ++k)
    for (int j = 0; j < soft.size[1]; ++j)
      for (int i = (j + k) % 3; i < soft.size[0]; i += 3)
        if (where.get(i, j, k)) values.push_back(soft.at(i, j, k));
  const double middle = median(values, float(usual_hu));
  report.add("tissue_hu", middle);
  return std::clamp(middle - usual_hu, -most_hu, most_hu);
}

Field segment_brain(const HuView& hu, const SegmentMasks& masks, const SegmentParams& p, Report& report,
                    const Progress& progress) {
  BitMask bone = masks.skull ? positive(*masks.skull, hu.lattice()) : bone_of(hu);
  BitMask cavity = cranial_cavity(bone, report, progress);
  const Box roi = region_of_interest(hu.lattice(), p);
  progress.report(0.3);
  Box box = grown(cavity.bounds(), 4, hu.lattice());
  bone = crop(bone, box);
  cavity = crop(cavity, box);
  if (masks.within) cavity &= positive(*masks.within, cavity.lattice());
  if (masks.without) cavity.remove(positive(*masks.without, cavity.lattice()));
  BitMask roi_mask(cropped(hu.lattice(), roi));
  cavity &= placed(roi_mask.invert(), cavity.lattice());

  const BitMask near_bone = dilated(bone, bone_blur_mm, progress);
  Field soft = soft_tissue(hu, box, cavity, near_bone, or_default(p.smoothing_sigma_mm, default_sigma_mm), progress);
  progress.report(0.6);
  cavity.remove(dilated(bone, bone_margin_mm, progress));
  const double shift = p.edge == SegmentEdge::half_maximum ? tissue_shift_hu(soft, cavity, report) : 0;
  const float lower = float(p.lower_hu + shift), upper = float(p.upper_hu);
  report.add("lower_hu", double(lower));
  const auto within = [&](float from) {
    BitMask tissue = make_mask(soft, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > from && soft.at(i, j, k) < upper;
    });
    return tissue &= cavity;
  };
  const BitMask tissue = within(lower - float(inner_hu));

  // Bridges (vessels, dura, nerves) are cut; then the envelope: narrow sulci closed, ventricles filled.
  const double open_mm = or_default(p.open_mm, default_open_mm);
  BitMask shape = dilated(largest(components(eroded(tissue, open_mm, progress))), open_mm + 1, progress);
  shape &= tissue;
  progress.report(0.7);
  if (!shape.any()) check_mask(shape, hu.lattice().count(), report);
  shape = closed(shape, or_default(p.close_mm, default_close_mm), progress);
  shape &= cavity;
  BitMask filled = holes(shape, {or_default(p.fill_close_mm, default_fill_close_mm), p.fill_max_ml, true}, progress);
  filled &= cavity;
  shape |= filled;
  report.add("filled_ml", double(filled.count()) * hu.lattice().voxel_volume_mm3() / 1000);
  // The surface at its own threshold: what is darker is peeled off from outside.
  BitMask outside = shape, dark = within(lower);
  outside.invert();
  dark.invert();
  shape.remove(grown_within(outside, dark, peel_mm, progress));
  shape = largest(components(shape));
  progress.report(0.8);
  for (float& v : soft.voxels) v = std::min(v - lower, upper - v);
  report.add("cut_voxels_count", place_surface(soft, shape, cut_sigma_mm, cut_scale_hu, progress));
  return soft;
}

}  // namespace trephine::segmentation
