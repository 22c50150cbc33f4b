// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/vessels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "mask/surface_field.h"

namespace trephine::segmentation {
namespace {

constexpr double not_scanned_hu = -950;  ///< register gives air there, and there is none in a cranial cavity
constexpr float min_tissue_hu = -150;
constexpr double rim_voxels = 1.2;  ///< a voxel holds bone and what is beside it
constexpr double warned_ratio = 0.05, refused_ratio = 0.5, cut_sigma_mm = 0.7, margin_mm = 4;

[[noreturn]] void refuse(const std::string& what) {
  throw refusal("", what,
                {"look at the registration's picture (`register`), lower `enhancement_hu`, or take the zone out of the "
                 "scene"});
}

}  // namespace

mask::BitMask soft_tissue_around(const grid::HuVolume& ct, const mask::BitMask& bone) {
  return mask::without(mask::above(mask::HuView(ct), min_tissue_hu), bone);
}

Outcome<grid::Field, VesselsResult> find_vessels(const grid::HuVolume& angiography, const grid::HuVolume& ct,
                                                 const mask::BitMask& whole_cavity, const grid::Field* within,
                                                 const grid::Field* without, const VesselsParams& params,
                                                 const Progress& progress) {
  if (grid::lattice_of(angiography) != grid::lattice_of(ct) || whole_cavity.lattice() != grid::lattice_of(ct))
    throw Error(ExitCode::bad_input, "", "volume", "must lie on the CT's voxels, as `register` gives it");
  mask::check_finite(angiography);
  mask::check_finite(ct);
  const grid::Lattice& all = grid::lattice_of(ct);
  const double rim_mm =
      params.rim_mm > 0
          ? std::max(params.rim_mm, rim_voxels * std::max({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z}))
          : 0;
  const double least = std::min({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z});
  const grid::Box box =
      grid::grown(whole_cavity.bounds(), static_cast<int>(std::ceil((margin_mm + params.grow_mm) / least)), all);
  const mask::BitMask cavity = mask::crop(whole_cavity, box);
  const grid::Lattice& l = cavity.lattice();
  const grid::Grid<float> bright = mask::crop(mask::HuView(angiography), box);
  grid::Grid<float> more = mask::crop(mask::HuView(ct), box);
  mask::BitMask seen = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = cavity.get(i, j, k) && bright.at(i, j, k) > not_scanned_hu;
  });
  const double outside = 1 - double(seen.count()) / std::max(1.0, double(cavity.count()));
  VesselsResult result;
  Warnings warnings;
  result.outside_ratio = outside;
  const char* region = params.region == VesselRegion::cranial_cavity ? "cranial cavity" : "soft tissue";
  if (outside > refused_ratio)
    refuse(fmt::format("{:.0f} % of the {} lies outside of the angiography", 100 * outside, region));
  if (outside > warned_ratio)
    warnings.push_back({"region_not_shown",
                        "{outside_percent:.0f} % of the {region} lies outside of the angiography: vessels there are "
                        "unknown",
                        {{"outside_percent", 100 * outside}, {"region", region}}});
  parallel_for(0, static_cast<std::int64_t>(more.voxels.size()), 1 << 16, [&](std::int64_t from, std::int64_t to) {
    for (auto n = static_cast<std::size_t>(from); n < static_cast<std::size_t>(to); ++n)
      more.voxels[n] = bright.voxels[n] - more.voxels[n];
  });
  const mask::BitMask inner = rim_mm > 0 ? mask::eroded(seen, rim_mm, progress.part(0, 0.2)) : seen;
  // Of the inner voxels alone, so that the bone's difference does not bleed in.
  if (params.smoothing_sigma_mm > 0)
    more = mask::masked_gaussian(std::move(more), inner, params.smoothing_sigma_mm, 0, 0.02, progress.part(0.2, 0.6));
  mask::BitMask vessels = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = inner.get(i, j, k) && more.at(i, j, k) > params.enhancement_hu;
  });
  if (within) vessels &= mask::positive(*within, l);
  mask::BitMask left_out(l);
  if (without) left_out = mask::dilated_6(mask::positive(*without, l));
  vessels.remove(left_out);
  vessels = mask::at_least_ml(mask::components(vessels, true), params.min_component_ml);
  if (!vessels.any()) refuse("no vessel is found in the angiography");
  std::vector<float> values;
  mask::for_each_voxel(mask::components(vessels),
                       [&](int, int i, int j, int k) { values.push_back(more.at(i, j, k)); });
  result.enhancement_median_hu = mask::median(values, 0);
  // What lies between a vessel and the bone beside it is vessel: a sinus lies on its groove.
  mask::BitMask rim = seen;
  rim.remove(inner);
  if (rim_mm > 0) {
    mask::BitMask beside = mask::dilated(vessels, rim_mm + least, progress.part(0.6, 0.8));
    beside &= rim;
    beside.remove(left_out);
    vessels |= beside;
  }
  grid::Field edge(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const float v = more.at(i, j, k) - static_cast<float>(params.enhancement_hu);
        // In the rim nothing was measured: the mask decides.
        edge.at(i, j, k) = rim.get(i, j, k) ? (vessels.get(i, j, k) ? 50.0f : -50.0f) : v;
      }
  result.size = mask::check_mask(vessels, l.count());
  result.pieces_count = mask::components(vessels, true).list.size();
  mask::place_surface(edge, vessels, cut_sigma_mm, 2 * params.enhancement_hu, progress.part(0.8, 0.9));
  if (params.grow_mm == 0) return {std::move(edge), std::move(result), std::move(warnings)};
  grid::Field mm = mask::signed_distance_mm(edge, progress.part(0.9, 1));
  for (float& v : mm.voxels) {
    v = std::clamp(v + static_cast<float>(params.grow_mm), -10.0f, 10.0f);
    if (v == 0) v = -1e-6f;
  }
  return {std::move(mm), std::move(result), std::move(warnings)};
}

}  // namespace trephine::segmentation
