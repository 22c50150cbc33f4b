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

namespace trephine {
namespace {

using namespace segmentation;

constexpr double not_scanned_hu = -950;  ///< register gives air there, and there is none in a cranial cavity
constexpr float least_tissue_hu = -150;
constexpr double rim_voxels = 1.2;  ///< a voxel holds bone and what is beside it
constexpr double warned_ratio = 0.05, refused_ratio = 0.5, cut_sigma_mm = 0.7, margin_mm = 4;

[[noreturn]] void refuse(const std::string& what) {
  throw refusal("", what,
                {"look at the registration's picture (`register`), lower `enhancement_hu`, or take the zone out of the "
                 "scene"});
}

}  // namespace

BitMask soft_tissue_around(const HuVolume& ct, const BitMask& bone) {
  const HuView hu(ct);
  const Lattice& l = lattice_of(ct);
  BitMask tissue = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = hu(i, j, k) > least_tissue_hu;
  });
  tissue.remove(bone);
  return tissue;
}

Field find_vessels(const HuVolume& angiography, const HuVolume& ct, const BitMask& whole_cavity, const Field* within,
                   const Field* without, const VesselsParams& params, Report& report, const Progress& progress) {
  if (lattice_of(angiography) != lattice_of(ct) || whole_cavity.lattice() != lattice_of(ct))
    throw Error(ExitCode::bad_input, "", "volume", "must lie on the CT's voxels, as `register` gives it");
  check_finite(angiography);
  check_finite(ct);
  const Lattice& all = lattice_of(ct);
  const double rim_mm =
      params.rim_mm > 0
          ? std::max(params.rim_mm, rim_voxels * std::max({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z}))
          : 0;
  const double least = std::min({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z});
  const Box box = grown(whole_cavity.bounds(), static_cast<int>(std::ceil((margin_mm + params.grow_mm) / least)), all);
  const BitMask cavity = crop(whole_cavity, box);
  const Lattice& l = cavity.lattice();
  const Grid<float> bright = crop(HuView(angiography), box);
  Grid<float> more = crop(HuView(ct), box);
  BitMask seen = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = cavity.get(i, j, k) && bright.at(i, j, k) > not_scanned_hu;
  });
  const double outside = 1 - double(seen.count()) / std::max(1.0, double(cavity.count()));
  report.add("outside_ratio", outside);
  const char* region = params.region == VesselRegion::cranial_cavity ? "cranial cavity" : "soft tissue";
  if (outside > refused_ratio)
    refuse(fmt::format("{:.0f} % of the {} lies outside of the angiography", 100 * outside, region));
  if (outside > warned_ratio)
    report.warn(fmt::format("{:.0f} % of the {} lies outside of the angiography: vessels there are unknown",
                            100 * outside, region));
  parallel_for(0, static_cast<std::int64_t>(more.voxels.size()), 1 << 16, [&](std::int64_t from, std::int64_t to) {
    for (auto n = static_cast<std::size_t>(from); n < static_cast<std::size_t>(to); ++n)
      more.voxels[n] = bright.voxels[n] - more.voxels[n];
  });
  const BitMask inner = rim_mm > 0 ? eroded(seen, rim_mm, progress.part(0, 0.2)) : seen;
  // Of the inner voxels alone, so that the bone's difference does not bleed in.
  if (params.smoothing_sigma_mm > 0)
    more = masked_gaussian(std::move(more), inner, params.smoothing_sigma_mm, 0, 0.02, progress.part(0.2, 0.6));
  BitMask vessels = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = inner.get(i, j, k) && more.at(i, j, k) > params.enhancement_hu;
  });
  if (within) vessels &= positive(*within, l);
  BitMask left_out(l);
  if (without) left_out = dilated_6(positive(*without, l));
  vessels.remove(left_out);
  vessels = at_least_ml(components(vessels, true), params.min_component_ml);
  if (!vessels.any()) refuse("no vessel is found in the angiography");
  std::vector<float> values;
  for_each_voxel(components(vessels), [&](int, int i, int j, int k) { values.push_back(more.at(i, j, k)); });
  report.add("enhancement_median_hu", median(values, 0));
  // What lies between a vessel and the bone beside it is vessel: a sinus lies on its groove.
  BitMask rim = seen;
  rim.remove(inner);
  if (rim_mm > 0) {
    BitMask beside = dilated(vessels, rim_mm + least, progress.part(0.6, 0.8));
    beside &= rim;
    beside.remove(left_out);
    vessels |= beside;
  }
  Field edge(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const float v = more.at(i, j, k) - static_cast<float>(params.enhancement_hu);
        // In the rim nothing was measured: the mask decides.
        edge.at(i, j, k) = rim.get(i, j, k) ? (vessels.get(i, j, k) ? 50.0f : -50.0f) : v;
      }
  check_mask(vessels, l.count(), report);
  report.add("pieces_count", components(vessels, true).list.size());
  place_surface(edge, vessels, cut_sigma_mm, 2 * params.enhancement_hu, progress.part(0.8, 0.9));
  if (params.grow_mm == 0) return edge;
  Field mm = signed_distance_mm(edge, progress.part(0.9, 1));
  for (float& v : mm.voxels) {
    v = std::clamp(v + static_cast<float>(params.grow_mm), -10.0f, 10.0f);
    if (v == 0) v = -1e-6f;
  }
  return mm;
}

}  // namespace trephine
