// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/voxel_removal.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "voxel/raw_voxel.h"

namespace trephine::drill {
namespace {

constexpr std::size_t max_kept = std::size_t(1) << 20;  // voxels of all steps together

void extend(grid::Box& all, const grid::Box& box) {
  if (box.empty()) return;
  const bool first = all.empty();
  for (std::size_t a = 0; a < 3; ++a) {
    all.begin[a] = first ? box.begin[a] : std::min(all.begin[a], box.begin[a]);
    all.end[a] = first ? box.end[a] : std::max(all.end[a], box.end[a]);
  }
}

}  // namespace

VoxelRemoval::VoxelRemoval(voxel::HapticVolume& volume, const DrillShapes& shapes, const DrillParams& params,
                           DirtyBricks* marks)
    : volume_(volume),
      shapes_(shapes),
      soft_energy_ratio_(params.soft_energy_ratio),
      max_rate_per_s_(params.max_rate_per_s),
      voxel_mm3_(volume.voxels.voxel_volume_mm3()),
      marks_(marks) {
  if (volume.encoding == voxel::HapticEncoding::hu) hu_.emplace(volume);
  fraction_.assign(volume.voxels.count(), 0);
  kind_.assign(65536, 0);
  for (const voxel::HapticShape& s : volume.shapes)
    for (int raw = s.window_low; raw <= s.window_high; ++raw) {
      const voxel::detail::RawVoxel v = voxel::detail::split(std::int16_t(raw));
      if (!hu_ && v.number != s.number) continue;
      const bool rest = !hu_ && !v.bare && v.share < voxel::haptic_full;
      kind_[std::uint16_t(raw)] = std::uint8_t((removes(s.number, false) ? drilled : 0) |
                                               (removes(s.number, true) ? incised : 0) | (rest ? shared : 0));
    }
  for (const std::int16_t raw : volume.voxels.voxels) any_shared_ = any_shared_ || (kind_[std::uint16_t(raw)] & shared);
  brick_marked_.assign(marks ? marks->layout().count() : 0, 0);
}

void VoxelRemoval::make_room(std::size_t voxels) {
  entries_.reserve(voxels + incision_voxels);
  changes_.reserve(2 * voxels + 2 * incision_voxels);
  shared_.reserve(voxels + 30 * incision_voxels);
}

void VoxelRemoval::begin() {
  removed_ = {};
  changes_.clear();
  changing_ = {};
}

void VoxelRemoval::cut(double budget_j) { apply(rate_for(budget_j), false); }

void VoxelRemoval::go_on(Incision& cut) {
  entries_.clear();
  const grid::Lattice& l = volume_.voxels;
  int looked = 0;
  for (; cut.slice < cut.box.end[2]; ++cut.slice, cut.row = cut.box.begin[1])
    for (; cut.row < cut.box.end[1]; ++cut.row) {
      looked += cut.box.end[0] - cut.box.begin[0];
      if (looked > incision_voxels && !entries_.empty()) return apply(0, true);
      if (looked > 8 * incision_voxels) return;  // nothing to remove was found so far
      for (int i = cut.box.begin[0]; i < cut.box.end[0]; ++i) {
        const std::uint32_t at = std::uint32_t(l.index(i, cut.row, cut.slice));
        const std::uint8_t kind = kind_[std::uint16_t(voxel::detail::load_voxel(volume_.voxels.voxels[at]))];
        if ((kind & (incised | shared)) == 0) continue;
        const Vec3 d = l.to_world_mm({double(i), double(cut.row), double(cut.slice)}) - cut.middle_mm;
        if (dot(d, d) > cut.radius_mm * cut.radius_mm) continue;
        const std::int16_t nothing = hu_ ? std::int16_t(voxel::haptic_beyond_hu) : std::int16_t(0);
        entries_.push_back({at, std::int16_t(i), std::int16_t(cut.row), std::int16_t(cut.slice), voxel::haptic_full, 0,
                            0, 0, voxel::haptic_full, nothing});
      }
    }
  apply(0, true);
}

void VoxelRemoval::keep_steps(int max_steps) {
  const std::size_t count = volume_.voxels.count();
  log_ = UndoLog(count, max_steps, std::min(count, max_kept));
  changes_.reserve(std::max(changes_.capacity(), max_put_back));
}

double VoxelRemoval::energy_of(int shape, std::uint32_t at) const {
  const double energy = shapes_[std::size_t(shape)].energy_j_per_mm3;
  if (volume_.hardness.voxels.empty()) return energy;
  return energy * (soft_energy_ratio_ + (1 - soft_energy_ratio_) * volume_.hardness.voxels[at] / 255.0);
}

// The rate K at which the entries use up the budget. What a voxel that empties within the tick leaves over goes to the
// others, so that a long tick removes what many short ones do.
double VoxelRemoval::rate_for(double budget_j) {
  double rate = max_rate_per_s_;
  for (int pass = 0; pass < 4; ++pass) {
    double work_j = 0, ended_j = 0;  // work_j: at a rate of 1 per second
    for (Entry& e : entries_) {
      if (pass == 0 && hu_) {
        const std::int16_t hu = voxel::detail::load_voxel(volume_.voxels.voxels[e.at]);
        const int number = hu_->number(hu);
        e.energy = float(voxel_mm3_ * energy_of(number, e.at));
        e.left = float(std::max(0.0, hu_->left(number, hu, e.stays) - fraction_[e.at] / double(fine)) / e.full);
      } else if (pass == 0) {
        const voxel::detail::RawVoxel v = voxel::detail::split(voxel::detail::load_voxel(volume_.voxels.voxels[e.at]));
        const double share = removes(v.number, false) ? v.share : voxel::haptic_full - v.share;
        e.energy = float(voxel_mm3_ * energy_of(removes(v.number, false) ? v.number : 0, e.at));
        e.left = float(std::max(0.0, share - e.stays - fraction_[e.at] / double(fine)) / voxel::haptic_full);
      }
      const double dose = double(e.dose);
      if (pass > 0 && dose * rate >= double(e.left))
        ended_j += double(e.energy) * double(e.left);
      else
        work_j += double(e.energy) * dose;
    }
    const double then = work_j > 0 ? std::min(max_rate_per_s_, std::max(0.0, budget_j - ended_j) / work_j) : rate;
    if (pass > 0 && std::abs(then - rate) <= 1e-4 * rate) return then;
    rate = then;
  }
  return rate;
}

// The voxels of every m-th slice of which more is there than may stay, with their doses in s.
void VoxelRemoval::collect(const CutterBody& body, double time_s, int slice, int slices) {
  entries_.clear();
  const grid::Lattice& l = volume_.voxels;
  const Vec3 m = body.middle_mm(), s = l.spacing_mm;
  grid::Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double middle = m[int(a)] / s[int(a)], reach = body.reach_mm() / s[int(a)];
    box.begin[a] = int(std::clamp(std::ceil(middle - reach), 0.0, double(l.size[a])));
    box.end[a] = int(std::clamp(std::floor(middle + reach) + 1, 0.0, double(l.size[a])));
  }
  extend(ever_, box);
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
        const int number = hu_ ? hu_->number(raw) : 0;
        const int stays = hu_ ? hu_->target(number, at.stays) : int(std::ceil(at.stays * voxel::haptic_full));
        if ((hu_ ? int(raw) : share) <= stays || entries_.size() == entries_.capacity()) continue;
        entries_.push_back({std::uint32_t(l.index(i, j, k)), std::int16_t(i), std::int16_t(j), std::int16_t(k), 0,
                            float(at.weight * time_s), 0, 0, std::int16_t(hu_ ? hu_->full(number) : voxel::haptic_full),
                            std::int16_t(stays)});
      }
    }
}

void VoxelRemoval::apply(double rate_per_s, bool incision) {
  changes_.clear();
  shared_.clear();
  changing_ = {};
  for (Entry& e : entries_) {
    if (!incision) {
      log_.note({e.at, voxel::detail::load_voxel(volume_.voxels.voxels[e.at]), fraction_[e.at]});
      std::int64_t fall = fraction_[e.at] + std::llrint(double(e.dose) * (rate_per_s * e.full * fine));
      if (hu_ || e.stays > 0)  // left is what remains above that
        fall = std::min<std::int64_t>(fall, fraction_[e.at] + std::llrint(double(e.left) * e.full * fine));
      e.fall = std::int16_t(std::min<std::int64_t>(fall / fine, hu_ ? INT16_MAX : voxel::haptic_full));
      fraction_[e.at] = std::uint8_t(fall % fine);
    }
    if (e.fall > 0 && hu_)
      lower_hu(e, incision);
    else if (e.fall > 0)
      lower(e, incision);
  }
  if (changes_.empty()) return;
  if (any_shared_) keep_shared();
  store(incision);
}

// A changed voxel can keep one of its parts, bare: that which may not be removed, else the larger.
bool VoxelRemoval::keeps_own(int own, int share, int other, int rest, bool incision) const {
  const bool own_stays = !removes(own, incision), other_stays = rest > 0 && !removes(other, incision);
  return own_stays != other_stays ? own_stays : share >= rest;
}

// Notes the voxel's new value, in which every part that may be removed is lower.
void VoxelRemoval::lower(const Entry& e, bool incision) {
  const voxel::detail::RawVoxel v = voxel::detail::split(voxel::detail::load_voxel(volume_.voxels.voxels[e.at]));
  if (v.number == 0) return;
  const bool has_rest = !v.bare && v.share < voxel::haptic_full;
  const int other = has_rest ? voxel::detail::other_shape(volume_.voxels, v.number, e.i, e.j, e.k) : 0;
  const int rest = other != 0 ? voxel::haptic_full - v.share : 0;
  const int own = removes(v.number, incision) ? std::max(0, v.share - e.fall) : v.share;
  const int others = removes(other, incision) ? std::max(0, rest - e.fall) : rest;
  if (own == v.share && others == rest) return;
  const bool first = keeps_own(v.number, own, other, others, incision);
  const int kept = first ? own : others;
  const std::int16_t raw = kept == 0 ? voxel::haptic_empty : voxel::detail::join(first ? v.number : other, kept, true);
  const int gone = v.share - (first ? own : 0), gone_too = rest - (first ? 0 : others);
  removed_.units[std::size_t(v.number)] += gone;
  removed_.units[std::size_t(other)] += gone_too;
  if (!incision)
    removed_.energy_j += voxel_mm3_ / voxel::haptic_full *
                         ((removes(v.number, false) ? gone * energy_of(v.number, e.at) : 0) +
                          (removes(other, false) ? gone_too * energy_of(other, e.at) : 0));
  note({e.at, e.i, e.j, e.k, raw});
}

void VoxelRemoval::lower_hu(const Entry& e, bool incision) {
  const std::int16_t hu = voxel::detail::load_voxel(volume_.voxels.voxels[e.at]);
  const int number = hu_->number(hu);
  if (!removes(number, incision)) return;
  const std::int16_t now = incision ? e.stays : hu_->settled(number, hu - e.fall, e.stays);
  if (now >= hu) return;
  if (hu_->number(now) != number) removed_.units[std::size_t(number)] += voxel::haptic_full;
  if (!incision) removed_.energy_j += voxel_mm3_ * energy_of(number, e.at) * e.fall / e.full;
  note({e.at, e.i, e.j, e.k, now});
}

void VoxelRemoval::note(const Change& change) {
  changes_.push_back(change);
  const int at[3] = {change.i, change.j, change.k};
  for (std::size_t a = 0; a < 3; ++a) {
    changing_.begin[a] = changes_.size() == 1 ? at[a] : std::min(changing_.begin[a], at[a]);
    changing_.end[a] = changes_.size() == 1 ? at[a] + 1 : std::max(changing_.end[a], at[a] + 1);
  }
}

// The voxels of two shapes around the change, with the shape to which their rest has belonged so far.
void VoxelRemoval::keep_shared() {
  const grid::Box box = grid::grown(changing_, 1, volume_.voxels);
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j) {
      const std::int16_t* row = volume_.voxels.voxels.data() + volume_.voxels.index(0, j, k);
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        const std::int16_t raw = voxel::detail::load_voxel(row[i]);
        if (!(kind_[std::uint16_t(raw)] & shared) || shared_.size() == shared_.capacity()) continue;
        const int own = voxel::detail::split(raw).number;
        shared_.push_back({std::uint32_t(volume_.voxels.index(i, j, k)), std::int16_t(i), std::int16_t(j),
                           std::int16_t(k), std::int16_t(voxel::detail::other_shape(volume_.voxels, own, i, j, k))});
      }
    }
}

void VoxelRemoval::store(bool incision) {
  std::vector<std::int16_t>& voxels = volume_.voxels.voxels;
  for (const Change& c : changes_) {
    log_.note({c.at, voxels[c.at], fraction_[c.at]});
    __atomic_store_n(&voxels[c.at], c.raw, __ATOMIC_RELAXED);
  }
  const std::size_t lowered = changes_.size();
  for (const Shared& s : shared_) {
    const voxel::detail::RawVoxel v = voxel::detail::split(voxel::detail::load_voxel(voxels[s.at]));
    if (v.number == 0 || v.bare || v.share == voxel::haptic_full) continue;
    if (voxel::detail::other_shape(volume_.voxels, v.number, s.i, s.j, s.k) == s.other) continue;
    const int rest = s.other != 0 ? voxel::haptic_full - v.share : 0;
    const bool own = keeps_own(v.number, v.share, s.other, rest, incision);
    removed_.units[std::size_t(own ? s.other : v.number)] += own ? rest : v.share;
    changes_.push_back({s.at, s.i, s.j, s.k,
                        own ? voxel::detail::join(v.number, v.share, true) : voxel::detail::join(s.other, rest, true)});
  }
  for (std::size_t n = lowered; n < changes_.size(); ++n) {
    const Change& c = changes_[n];
    log_.note({c.at, voxels[c.at], fraction_[c.at]});
    __atomic_store_n(&voxels[c.at], c.raw, __ATOMIC_RELAXED);
  }
  if (changes_.size() > lowered) changing_ = grid::grown(changing_, 1, volume_.voxels);
  extend(ever_, changing_);
  mark_changes();
}

// What the changes are to others: the box to be loosened, and the bricks that read them.
void VoxelRemoval::mark_changes() {
  for (std::size_t a = 0; a < 3; ++a) {
    const bool first = removed_.changed.begin[a] >= removed_.changed.end[a];
    removed_.changed.begin[a] = first ? changing_.begin[a] : std::min(removed_.changed.begin[a], changing_.begin[a]);
    removed_.changed.end[a] = std::max(removed_.changed.end[a], changing_.end[a]);
  }
  if (!marks_) return;
  // Each brick once: a mark is an atomic that another thread's cache may hold.
  const BrickLayout& layout = marks_->layout();
  std::array<int, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = layout.first_reader(changing_.begin[a], 1);
    high[a] = layout.last_reader(int(a), changing_.end[a] - 1, 1);
  }
  for (const Change& c : changes_) {
    const int v[3] = {c.i, c.j, c.k};
    int first[3], last[3];
    for (int a = 0; a < 3; ++a) {
      first[a] = layout.first_reader(v[a], 1);
      last[a] = layout.last_reader(a, v[a], 1);
    }
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y)
        for (int x = first[0]; x <= last[0]; ++x) brick_marked_[layout.index(x, y, z)] = 1;
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const std::size_t brick = layout.index(x, y, z);
        if (brick_marked_[brick] == 0) continue;
        brick_marked_[brick] = 0;
        marks_->mark(brick);
      }
}

void VoxelRemoval::put_back(std::uint32_t at, std::int16_t raw, std::uint8_t fraction) {
  fraction_[at] = fraction;
  std::int16_t& voxel = volume_.voxels.voxels[at];
  if (voxel == raw) return;
  __atomic_store_n(&voxel, raw, __ATOMIC_RELAXED);
  const std::size_t row = std::size_t(volume_.voxels.size[0]), rest = at / row;
  note({at, std::int16_t(at % row), std::int16_t(rest % std::size_t(volume_.voxels.size[1])),
        std::int16_t(rest / std::size_t(volume_.voxels.size[1])), raw});
}

void VoxelRemoval::end_back(bool nothing_left) {
  if (nothing_left) ever_ = {};
  if (changes_.empty()) return;
  changing_ = grid::grown(changing_, 1, volume_.voxels);  // a voxel says to whom its neighbours' rest belongs
  mark_changes();
}

}  // namespace trephine::drill
