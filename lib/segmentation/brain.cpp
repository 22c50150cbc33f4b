// SPDX-License-Identifier: GPL-3.0-or-later
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
constexpr double default_fill_close_mm = 6.0;
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
  const float lower = float(p.lower_hu), upper = float(p.upper_hu);
  BitMask tissue = make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > lower && soft.at(i, j, k) < upper;
  });
  tissue &= cavity;

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
  progress.report(0.8);
  for (float& v : soft.voxels) v = std::min(v - lower, upper - v);
  report.add("cut_voxels_count", place_surface(soft, shape, cut_sigma_mm, cut_scale_hu, progress));
  return soft;
}

}  // namespace trephine::segmentation
