// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/brain.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "head/brain_dark.h"
#include "head/brain_pits.h"
#include "head/deep_csf.h"
#include "mask/along_sheets.h"
#include "mask/coarse.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "place/cranium.h"
#include "place/lungs.h"

namespace trephine::head {
namespace {

constexpr double cell_mm = 1.0;  ///< at most; size of the cells on which the brain is found
constexpr double sheet_mm_per_noise =
    0.08;  ///< sigma of the means along sulci for each unit of noise, mm per HU mm^1.5
constexpr double min_sheet_mm = 0.4, max_sheet_mm = 3;
constexpr double strength_ratio = 0.13;  ///< strength of denoising for each unit of noise that is left, mm^-0.5
constexpr double blur_mm = 0.7;          ///< sigma of the total blur: kernel, cells, means and denoising
constexpr double sharpened_mm =
    2;  ///< how far from dark voxels of the unsharpened image a sulcus may go on in the sharpened one
constexpr double speck_voxels = 3.5, speck_mm3 = 8;  ///< fewer of them together are noise
constexpr float thin_bone_hu = 226;
constexpr double bone_blur_mm = 1.2;    ///< HU this near to bone are not reliable
constexpr double bone_margin_mm = 1.0;  ///< the brain never comes nearer to bone than this: dura and a film of CSF
constexpr double inner_hu = 10;         ///< inside, tissue may be this much darker than at its surface (white matter)
constexpr double ventricle_hu = 18.5;   ///< the edge between CSF and white matter
constexpr double csf_hu = -15;          ///< and the least of CSF
constexpr double ventricle_wall_mm = 1.5;
constexpr double wide_mm = 2.0;   ///< CSF wider than twice this is as dark as CSF,
constexpr double lesion_hu = 15;  ///< and what is brighter is oedema or an old infarct: brain
constexpr double lesion_ml = 0.3;
constexpr double stem_darker_hu = 9;
constexpr double min_filled_share =
    0.85;  ///< of the cavity that the envelope fills; 0.90 to 0.98 in 27 heads and phantoms
// The fourth ventricle's place from the brain's centre, LPS, in an adult. It is wider than twice neck_mm, and its
// outlets are narrower.
constexpr double neck_mm = 2.0, fourth_core_ml = 0.2;
constexpr Vec3 fourth_from{-15, 10, -75}, fourth_to{15, 55, -25};
constexpr double crumb_mm = 0.8;  ///< flaps thinner than twice this (dura, vessels) are not part of the brain
constexpr double cut_sigma_mm = 1.5;
constexpr double cut_scale_hu = 10;

/// The HU of the cells where brain or fluid is, far from bone, with tissue at 30.
struct Tissue {
  grid::Grid<float> level, soft;  ///< before denoising and after it
  mask::BitMask known;
  double noise = 0;
};

Tissue tissue_of(const mask::HuView& hu, const grid::Box& box, const mask::CoarseRaster& raster, mask::BitMask known,
                 const BrainParams& p, BrainResult& result, const Progress& progress) {
  const auto beyond = [&](float low, float high) {
    return mask::make_mask(raster.fine, [&, low, high](int j, int k, std::uint8_t* row) {
      const std::size_t start = hu.lattice().index(box.begin[0], box.begin[1] + j, box.begin[2] + k);
      for (int i = 0; i < raster.fine.size[0]; ++i) row[i] = !(hu(start + i) > low && hu(start + i) < high);
    });
  };
  // A few voxels at a place are beyond by noise, and the mean of the rest would be wrong without them.
  const mask::BitMask strange = mask::both(beyond(-100, 160), known);
  known.remove(beyond(-400, 460))
      .remove(mask::at_least_ml(mask::components(strange),
                                std::min(speck_mm3, speck_voxels * raster.fine.voxel_volume_mm3()) / 1000));
  grid::Grid<float> v = mask::coarse_mean(hu, known, raster, -1000);
  known = mask::coarse_mask(known, raster, 0);
  if (p.smoothing_sigma_mm > 0)
    v = mask::masked_gaussian(std::move(v), known, p.smoothing_sigma_mm, -1000, 0.02, progress);
  if (p.edge == segmentation::SegmentEdge::half_maximum) result.level = level_tissue(v, known, progress);
  // More noise is averaged over wider planes.
  const double noise = tissue_noise(v, known, progress);
  check_noise(noise, v, p.smoothing_sigma_mm);
  Tissue t{v, {}, known, noise};
  const double wide_mm = std::min(max_sheet_mm, sheet_mm_per_noise * noise);
  if (wide_mm >= min_sheet_mm) v = mask::averaged_along_sheets(v, known, wide_mm, progress);
  SoftTissue soft = soft_tissue(std::move(v), known, strength_ratio, -1000, progress);
  t.soft = std::move(soft.image);
  result.tissue_noise_hu_mm1_5 = soft.noise_hu_mm1_5;
  return t;
}

/// Undoes the blur of edges and clefts to first order: adds what a Gaussian mean takes away.
grid::Field sharpened(grid::Field soft, const Progress& progress) {
  constexpr float nowhere = -1000;
  const mask::BitMask seen = mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > nowhere;
  });
  const grid::Grid<float> mean = mask::masked_gaussian(soft, seen, blur_mm, nowhere, 0.02, progress);
  for (std::size_t v = 0; v < soft.voxels.size(); ++v)
    if (soft.voxels[v] > nowhere) soft.voxels[v] += soft.voxels[v] - mean.voxels[v];
  return soft;
}

/// The components of `domain` that touch `start`.
mask::BitMask reached(const mask::BitMask& start, const mask::BitMask& domain) {
  const mask::Components pieces = mask::components(domain);
  return mask::select(pieces, mask::touching(pieces, start));
}

/// Regions that are dark and wide, but not as dark as CSF.
mask::BitMask lesions(const grid::Grid<float>& soft, const mask::BitMask& dark, const Progress& progress) {
  mask::BitMask core = mask::eroded(dark, wide_mm, progress);
  core &= mask::make_mask(soft, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < soft.size[0]; ++i) row[i] = soft.at(i, j, k) > lesion_hu;
  });
  return mask::dilated(mask::at_least_ml(mask::components(core), lesion_ml), wide_mm + 1, progress);
}

/// CSF at the place of the fourth ventricle that narrow passages separate from the outside: it belongs to the brain.
mask::BitMask fourth_ventricle(const mask::BitMask& dark, const mask::BitMask& outside, Vec3 centre_mm,
                               const Progress& progress) {
  const grid::Lattice& l = dark.lattice();
  const mask::Components pieces = mask::components(mask::eroded(dark, neck_mm, progress));
  const std::vector<char> open = mask::touching(pieces, outside);
  std::vector<char> keep;
  for (std::size_t c = 0; c < pieces.list.size(); ++c) {
    const grid::Box& b = pieces.list[c].box;
    Vec3 middle;
    for (int a = 0; a < 3; ++a) middle[a] = 0.5 * (b.begin[a] + b.end[a] - 1);
    const Vec3 p = l.to_world_mm(middle) - centre_mm;
    bool inside = !open[c] && double(pieces.list[c].voxels) * l.voxel_volume_mm3() / 1000 >= fourth_core_ml;
    for (int a = 0; a < 3; ++a) inside = inside && p[a] > fourth_from[a] && p[a] < fourth_to[a];
    keep.push_back(inside);
  }
  return mask::dilated(mask::select(pieces, keep), neck_mm + 0.5, progress);
}

/// Interpolated between cells, the field may reach into a voxel of bone, and single voxels may become detached.
grid::Field kept_within(grid::Field field, const mask::BitMask& allowed) {
  constexpr float least = 0.002f * float(cut_scale_hu);
  mask::BitMask inside = mask::positive(field, field);
  inside &= allowed;
  inside = mask::largest(mask::components(inside));
  parallel_for(0, field.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i)
          if (float& f = field.at(i, j, k); !inside.get(i, j, k)) f = std::min(f, -least);
  });
  return field;
}

Outcome<grid::Field, BrainResult> brain_in(const mask::HuView& hu, const BrainMasks& masks, const BrainParams& p,
                                           const Progress& progress) {
  BrainResult result;
  mask::BitMask bone = masks.skull ? mask::positive(*masks.skull, hu.lattice()) : place::bone_of(hu);
  // Thin plates of bone that the skull's own edge leaves out (orbital roofs in thick slices) are not brain either.
  const mask::Components bright = mask::components(mask::above(hu, thin_bone_hu));
  bone |= mask::select(bright, mask::touching(bright, bone));
  auto found = place::cranial_cavity(bone, progress);
  Warnings warnings = std::move(found.warnings);
  result.cranial_cavity_ml = found.result.cranial_cavity_ml;
  mask::BitMask cavity = std::move(found.value);
  place::require_no_lungs(cavity, hu);
  const grid::Box roi = mask::region_of_interest(hu.lattice(), p.roi_min_mm, p.roi_max_mm);
  progress.report(0.3);
  grid::Box box = grid::grown(cavity.bounds(), 4, hu.lattice());
  bone = mask::crop(bone, box);
  cavity = mask::crop(cavity, box);
  if (masks.within) cavity &= mask::positive(*masks.within, cavity.lattice());
  if (masks.without) cavity.remove(mask::positive(*masks.without, cavity.lattice()));
  mask::BitMask roi_mask(grid::cropped(hu.lattice(), roi));
  cavity &= mask::placed(roi_mask.invert(), cavity.lattice());

  // Everything below works on cells of at most a millimetre, because noise hides anything finer.
  const mask::CoarseRaster raster = mask::coarse_raster(cavity.lattice(), cell_mm, true);
  mask::BitMask known = cavity;
  known.remove(mask::dilated(bone, bone_blur_mm, progress));
  const Tissue scanned = tissue_of(hu, box, raster, std::move(known), p, result, progress);
  grid::Field soft = scanned.soft;
  progress.report(0.6);
  mask::BitMask allowed = cavity;
  cavity.remove(mask::dilated(bone, bone_margin_mm, progress));
  cavity = mask::coarse_mask(cavity, raster, 0.5);
  const float lower = float(p.lower_hu), upper = float(p.upper_hu);
  const auto within = [&](const grid::Field& f, float from) {
    mask::BitMask tissue = mask::make_mask(f, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < f.size[0]; ++i) row[i] = f.at(i, j, k) > from && f.at(i, j, k) < upper;
    });
    return tissue &= cavity;
  };
  const mask::BitMask tissue = within(soft, lower - float(inner_hu));

  // Bridges (vessels, dura, nerves) are cut. Then the envelope is made: narrow sulci are closed and ventricles filled.
  const double open_mm = p.open_mm;
  mask::BitMask shape =
      mask::dilated(mask::largest(mask::components(mask::eroded(tissue, open_mm, progress))), open_mm + 1, progress);
  shape &= tissue;
  progress.report(0.7);
  if (!shape.any()) mask::check_mask(shape, hu.lattice().count());
  shape = mask::closed(shape, p.close_mm, progress);
  shape &= cavity;
  mask::BitMask filled = mask::holes(shape, {p.fill_close_mm, p.fill_max_ml, true}, progress);
  filled &= cavity;
  shape |= filled;
  result.filled_ml = double(filled.count()) * soft.voxel_volume_mm3() / 1000;
  shape = mask::largest(mask::components(shape));
  result.envelope_ml = double(shape.count()) * soft.voxel_volume_mm3() / 1000;
  if (const double share = double(shape.count()) / double(cavity.count()); share < min_filled_share)
    warnings.push_back({"cavity_not_filled",
                        "only {filled_percent:.0f} % of the space that bone encloses was taken for brain with its "
                        "sulci (90 % and more in heads): look in the pictures whether a part of the brain is missing",
                        {{"filled_percent", 100 * share}}});

  // Sulci, fissures and cisterns are the CSF that is reached from outside without passing through the ventricles.
  const mask::BitMask wide = wide_csf(soft, shape, csf_hu, ventricle_hu, progress);
  const place::HeadPlace place = place::place_head(shape, &wide, hu.lattice(), progress);
  result.place = figures_of(place);
  const Warnings of_place = warnings_of(place);
  warnings.insert(warnings.end(), of_place.begin(), of_place.end());
  // The brain ends at the foramen magnum.
  if (place.sure)
    shape &= mask::make_mask(shape.lattice(), [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < shape.lattice().size[0]; ++i)
        row[i] = place.to_template(shape.lattice().to_world_mm({double(i), double(j), double(k)})).z >
                 place::template_foramen_z;
    });
  mask::BitMask closed_off =
      mask::dilated(deep_csf(soft, shape, place, csf_hu, ventricle_hu, progress), ventricle_wall_mm, progress);
  closed_off &= shape;
  // The brainstem has no sulci, and the petrous bones on both sides darken it: only what is as dark as CSF is cut
  // there.
  mask::BitMask stem(shape.lattice());
  if (place.sure)
    stem = mask::make_mask(shape.lattice(), [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < shape.lattice().size[0]; ++i)
        row[i] = place::in_brainstem(place.to_template(shape.lattice().to_world_mm({double(i), double(j), double(k)})));
    });
  const auto dark_in = [&](const grid::Field& f) {
    mask::BitMask dark = within(f, lower - float(stem_darker_hu));
    dark &= stem;
    dark |= within(f, lower);
    dark.invert();
    dark &= shape;
    return dark.remove(closed_off);
  };
  const grid::Field sharp = sharpened(soft, progress);
  mask::BitMask dark = dark_in(soft), deeper = dark_in(sharp), outside = shape;
  deeper.remove(lesions(soft, dark, progress));
  deeper |= outside.invert();
  mask::BitMask fourth = fourth_ventricle(deeper, outside, shape.centre_mm(), progress);
  deeper.remove(fourth &= shape);
  // Sharpening deepens sulci that are reached without it. Alone it may reach nothing new, because it raises noise too.
  dark |= outside;
  dark &= deeper;
  mask::BitMask cut = mask::grown_within(reached(outside, dark), deeper, sharpened_mm, progress);
  cut &= shape;
  const mask::BitMask tissue_cut = dark_tissue(cut, shape, soft, progress);
  result.dark_tissue_ml = double(tissue_cut.count()) * soft.voxel_volume_mm3() / 1000;
  cut.remove(tissue_cut);
  const mask::BitMask pits = noise_pits(cut, shape, scanned.level, scanned.known, scanned.noise, progress);
  result.noise_pits_ml = double(pits.count()) * soft.voxel_volume_mm3() / 1000;
  shape.remove(cut.remove(pits));
  mask::BitMask solid =
      mask::dilated(mask::largest(mask::components(mask::eroded(shape, crumb_mm, progress))), crumb_mm + 0.5, progress);
  shape &= solid;
  shape = mask::largest(mask::components(shape));
  progress.report(0.8);
  soft = sharp;
  for (float& v : soft.voxels) v = std::min(v - lower, upper - v);
  result.cut_voxels_count = mask::place_surface(soft, shape, cut_sigma_mm, cut_scale_hu, progress);
  grid::Field field = mask::refined(soft, raster);
  return {kept_within(std::move(field), allowed), std::move(result), std::move(warnings)};
}

}  // namespace
}  // namespace trephine::head

namespace trephine::head {

Outcome<grid::Field, BrainResult> find_brain(const grid::HuVolume& volume, const BrainMasks& masks,
                                             const BrainParams& params, const Progress& progress) {
  segmentation::check_thresholds(params.lower_hu, params.upper_hu);
  return segmentation::finished<BrainResult>(
      volume, {params.grow_mm, 1},
      [&](const mask::HuView& hu) {
        mask::check_varies(volume);
        if (params.smoothing_sigma_mm == 0) check_scan_noise(volume, masks.scan_figures, progress);
        return brain_in(hu, masks, params, progress);
      },
      progress);
}

}  // namespace trephine::head
