// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/error.h"
#include "segmentation/filters.h"
#include "segmentation/methods.h"
#include "segmentation/soft_tissue.h"
#include "segmentation/surface_field.h"

namespace trephine::segmentation {
namespace {

constexpr double strength_ratio = 0.4;  ///< of denoising to the noise, mm^-0.5
constexpr float thin_bone_hu = 226;
constexpr double bone_blur_mm = 1.5;    ///< HU this near to bone are not believed
constexpr double bone_margin_mm = 1.0;  ///< and the brain never comes nearer than this: dura and a film of CSF
constexpr double default_open_mm = 2.5;
constexpr double default_close_mm = 3.0;
constexpr double default_fill_close_mm = 10.0;
constexpr double inner_hu = 6;         ///< inside, tissue may be this much darker than at its surface (white matter)
constexpr double csf_reach_mm = 60;    ///< sulci, fissures and cisterns are followed this far from the envelope
constexpr double ventricle_hu = 18.5;  ///< the edge between CSF and white matter
constexpr double ventricle_wall_mm = 1.5;
constexpr double wide_mm = 2.0;   ///< CSF wider than twice this is as dark as CSF,
constexpr double lesion_hu = 15;  ///< and what is brighter is oedema or an old infarct: brain
constexpr double lesion_ml = 0.3;
constexpr double crumb_mm = 0.8;  ///< flaps thinner than twice this (dura, vessels) do not hold to the brain
constexpr double cut_sigma_mm = 1.5;
constexpr double cut_scale_hu = 10;

double or_default(double value, double otherwise) { return value > 0 ? value : otherwise; }

/// The box's HU where brain or fluid is, far from bone; denoised, tissue at 30.
Grid<float> soft_of(const HuView& hu, const Box& box, const BitMask& cavity, const BitMask& near_bone,
                    const SegmentParams& p, Report& report, const Progress& progress) {
  Grid<float> v = crop(hu, box);
  BitMask known = make_mask(v, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < v.size[0]; ++i) row[i] = v.at(i, j, k) > -100 && v.at(i, j, k) < 160;
  });
  known &= cavity;
  known.remove(near_bone);
  if (p.smoothing_sigma_mm > 0) v = masked_gaussian(std::move(v), known, p.smoothing_sigma_mm, -1000, 0.02, progress);
  return soft_tissue(std::move(v), known, p.edge == SegmentEdge::half_maximum, strength_ratio, -1000, report, progress);
}

/// Dark and wide, but not as dark as CSF.
BitMask lesions(const Grid<float>& soft, const BitMask& dark, const Progress& progress) {
  BitMask core = eroded(dark, wide_mm, progress);
  core &= make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > lesion_hu;
  });
  const Components pieces = components(core);
  std::vector<char> keep;
  for (const Component& c : pieces.list) keep.push_back(c.voxels * soft.voxel_volume_mm3() / 1000 >= lesion_ml);
  return dilated(select(pieces, keep), wide_mm + 1, progress);
}

}  // namespace

Field segment_brain(const HuView& hu, const SegmentMasks& masks, const SegmentParams& p, Report& report,
                    const Progress& progress) {
  BitMask bone = masks.skull ? positive(*masks.skull, hu.lattice()) : bone_of(hu);
  // Thin plates of bone that the skull's own edge leaves out (orbital roofs in thick slices) are no brain either.
  const Components bright = components(make_mask(hu.lattice(), [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < hu.lattice().size[0]; ++i) row[i] = hu(i, j, k) > thin_bone_hu;
  }));
  bone |= select(bright, touching(bright, bone));
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
  Field soft = soft_of(hu, box, cavity, near_bone, p, report, progress);
  progress.report(0.6);
  cavity.remove(dilated(bone, bone_margin_mm, progress));
  const float lower = float(p.lower_hu), upper = float(p.upper_hu);
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
  shape = largest(components(shape));
  report.add("envelope_ml", double(shape.count()) * hu.lattice().voxel_volume_mm3() / 1000);

  // Sulci, fissures and cisterns: the CSF that is reached from outside, past the ventricles.
  BitMask closed_off = dilated(find_ventricles(soft, shape, -15, ventricle_hu, progress), ventricle_wall_mm, progress);
  closed_off &= shape;
  BitMask dark = within(lower);
  dark.invert();
  dark &= shape;
  dark.remove(closed_off);
  dark.remove(lesions(soft, dark, progress));
  BitMask outside = shape;
  outside.invert();
  dark |= outside;
  shape.remove(grown_within(outside, dark, csf_reach_mm, progress));
  BitMask solid = dilated(largest(components(eroded(shape, crumb_mm, progress))), crumb_mm + 0.5, progress);
  shape &= solid;
  shape = largest(components(shape));
  progress.report(0.8);
  for (float& v : soft.voxels) v = std::min(v - lower, upper - v);
  report.add("cut_voxels_count", place_surface(soft, shape, cut_sigma_mm, cut_scale_hu, progress));
  return soft;
}

}  // namespace trephine::segmentation
