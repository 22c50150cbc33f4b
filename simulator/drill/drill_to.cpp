// SPDX-License-Identifier: GPL-3.0-or-later
// Removal to a fraction of a voxel, by a tool that stands in what it has cut.
#include <algorithm>
#include <cmath>

#include "drill/cutter_body.h"
#include "drill/drill.h"
#include "voxel/raw_voxel.h"

namespace trephine::drill {

const Removal& Drill::cut_to(const ToolPose& pose, Vec3 to_tip_mm, double wider_mm, double dt_s, double power_ratio) {
  out_ = {};
  const std::uint64_t ring = std::uint64_t(slices_) + 1;
  past_[calls_ % ring] = {pose, dt_s};
  const std::uint64_t back = std::min<std::uint64_t>(calls_ + 1, std::uint64_t(slices_));
  const int slice = int(calls_ % std::uint64_t(slices_));
  ++calls_;
  double time_s = 0;
  for (std::uint64_t n = 0; n < back; ++n) time_s += past_[(calls_ - 1 - n) % ring].dt_s;
  const Vec3 way = to_tip_mm - pose.tip_mm;
  if (!(norm(way) <= max_way_mm) || !(time_s > 0) || !(power_ratio > 0)) return out_;
  entries_.clear();
  collect_to(CutterBody(cutter_, pose, to_tip_mm, wider_mm, volume_.voxels), time_s, slice, slices_);
  const double rate = rate_for(params_.power_w * std::min(power_ratio, 1.0) * time_s / slices_);
  apply(rate * voxel::haptic_full * fine, false);
  out_.power_w = out_.energy_j / dt_s;
  return out_;
}

// The voxels of every m-th slice of which more is there than may stay, with their doses in s.
void Drill::collect_to(const CutterBody& body, double time_s, int slice, int slices) {
  const grid::Lattice& l = volume_.voxels;
  const Vec3 m = body.middle_mm(), s = l.spacing_mm;
  grid::Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double middle = m[int(a)] / s[int(a)], reach = body.reach_mm() / s[int(a)];
    box.begin[a] = int(std::clamp(std::ceil(middle - reach), 0.0, double(l.size[a])));
    box.end[a] = int(std::clamp(std::floor(middle + reach) + 1, 0.0, double(l.size[a])));
  }
  this->reach(box);
  const double reach = body.reach_mm() * body.reach_mm();
  for (int k = box.begin[2] + (slice - box.begin[2] % slices + slices) % slices; k < box.end[2]; k += slices)
    for (int j = box.begin[1]; j < box.end[1]; ++j) {
      const double y = j * s.y - m.y, z = k * s.z - m.z, left = reach - y * y - z * z;
      if (!(left > 0)) continue;
      const double half = std::sqrt(left);
      const int first = std::max(box.begin[0], int(std::ceil((m.x - half) / s.x)));
      const int last = std::min(box.end[0] - 1, int(std::floor((m.x + half) / s.x)));
      const std::int16_t* row = volume_.voxels.voxels.data() + l.index(0, j, k);
      for (int i = first; i <= last; ++i) {
        const std::int16_t raw = voxel::detail::load_voxel(row[i]);
        if ((kind_[std::uint16_t(raw)] & (drilled | shared)) == 0) continue;
        const CutterBody::At at = body.at({i * s.x, j * s.y, k * s.z});
        if (!(at.stays < 1) || !(at.weight > 0)) continue;
        const voxel::detail::RawVoxel v = voxel::detail::split(raw);
        const int share = removes(v.number, false) ? v.share : voxel::haptic_full - v.share;
        const int stays = int(std::ceil(at.stays * voxel::haptic_full));
        if (share <= stays || entries_.size() == entries_.capacity()) continue;
        entries_.push_back({std::uint32_t(l.index(i, j, k)), std::int16_t(i), std::int16_t(j), std::int16_t(k), 0,
                            float(at.weight * time_s), 0, 0, std::int16_t(stays)});
      }
    }
}

}  // namespace trephine::drill
