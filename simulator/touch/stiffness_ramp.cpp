// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/stiffness_ramp.h"

#include <algorithm>
#include <cmath>

#include "voxel/raw_voxel.h"

namespace trephine::touch {
namespace {

constexpr double depth_voxels = 1.5;

}  // namespace

StiffnessRamps::StiffnessRamps(const cases::CaseHaptic& haptic) {
  for (const cases::CaseShape& s : haptic.shapes) {
    const double most = s.transfer ? voxel::stiffest_n_per_mm(*s.transfer) : 0;
    if (!(most > 0) || s.number < 1 || s.number > voxel::haptic_max_shapes) continue;
    Ramp& ramp = ramps_[std::size_t(s.number)];
    ramp.low = s.window_low;
    ramp.high = s.window_high;
    for (int hu = ramp.low; hu <= std::min(ramp.high, voxel::transfer_high_hu); ++hu)
      ramp.ratio.push_back(float(voxel::at_hu(*s.transfer, hu).stiffness_n_per_mm / most));
    any_ = true;
  }
}

double StiffnessRamps::ratio_at(const contact::ContactVolume& volume, const contact::Contact& contact) const {
  if (contact.shape < 1 || contact.shape > voxel::haptic_max_shapes) return 1;
  const Ramp& ramp = ramps_[std::size_t(contact.shape)];
  if (ramp.ratio.empty()) return 1;
  const grid::Grid<std::int16_t>& voxels = volume.volume().voxels;
  // A round tool may hang on the edge of a disc, where its own normal leans.
  Vec3 normal = volume.normal_at(contact.point_mm, contact.from, contact.into);
  if (normal == Vec3{}) normal = contact.normal;
  const Vec3 beneath = contact.face == contact::ContactFace::front ? -normal : normal;
  const Vec3 at = voxels.to_index(contact.point_mm), way = voxels.to_index(contact.point_mm + beneath) - at;
  const Vec3 place = at + normalized(way) * depth_voxels;
  double sum = 0, weight = 0;
  const int i0 = int(std::floor(place.x)), j0 = int(std::floor(place.y)), k0 = int(std::floor(place.z));
  for (int corner = 0; corner < 8; ++corner) {
    const int i = i0 + (corner & 1), j = j0 + (corner >> 1 & 1), k = k0 + (corner >> 2);
    if (i < 0 || j < 0 || k < 0 || i >= voxels.size[0] || j >= voxels.size[1] || k >= voxels.size[2]) continue;
    const int hu = voxel::detail::load_voxel(voxels.voxels[voxels.index(i, j, k)]);
    if (hu < ramp.low || hu > ramp.high) continue;
    const double w = (1 - std::abs(place.x - i)) * (1 - std::abs(place.y - j)) * (1 - std::abs(place.z - k));
    sum += w * hu;
    weight += w;
  }
  // A wall so thin that nothing of it lies in that depth is as its surface.
  const double hu = weight > 1e-6 ? sum / weight - ramp.low : 0;
  const std::size_t below = std::min(std::size_t(hu), ramp.ratio.size() - 1);
  const std::size_t above = std::min(below + 1, ramp.ratio.size() - 1);
  return ramp.ratio[below] + (ramp.ratio[above] - ramp.ratio[below]) * std::min(1.0, hu - double(below));
}

}  // namespace trephine::touch
