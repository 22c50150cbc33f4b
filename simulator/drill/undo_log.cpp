// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/undo_log.h"

#include <algorithm>

namespace trephine::drill {
namespace {

constexpr std::uint16_t last_number = 65000;

}  // namespace

UndoLog::UndoLog(std::size_t voxel_count, int max_steps, std::size_t max_voxels) {
  if (max_steps <= 0 || max_voxels == 0) return;
  stamp_.assign(voxel_count, 0);
  kept_.resize(max_voxels);
  steps_.resize(std::size_t(max_steps));
}

void UndoLog::begin_step() {
  if (stamp_.empty() || (whole_ && newest().begin == newest().end)) return;
  whole_ = number_ < last_number;
  if (!whole_) return clear();  // no step may lie between what is taken back and now
  ++number_;
  if (count_ == int(steps_.size())) forget_oldest();
  ++count_;
  newest() = {next_, next_};
}

void UndoLog::forget_oldest() {
  first_ = (first_ + 1) % int(steps_.size());
  --count_;
}

void UndoLog::add(const KeptVoxel& was) {
  if (!whole_) return;
  stamp_[was.at] = number_;
  Step& step = newest();
  if (step.end - step.begin == kept_.size()) {  // it alone has no room
    whole_ = false;
    --count_;
    return;
  }
  while (next_ - steps_[std::size_t(first_)].begin == kept_.size()) forget_oldest();
  kept_[next_ % kept_.size()] = was;
  step.end = ++next_;
}

void UndoLog::end_step() {
  if (whole_ && newest().begin == newest().end) --count_;
  whole_ = false;
}

UndoLog::Part UndoLog::take(std::size_t most) {
  Part part;
  end_step();
  if (count_ == 0) return part;
  Step& step = newest();
  const std::size_t ring = kept_.size(), at_end = std::size_t((step.end - 1) % ring) + 1;
  part.count = std::min({most, std::size_t(step.end - step.begin), at_end});  // up to where the ring begins
  part.first = &kept_[at_end - part.count];
  step.end -= part.count;
  next_ = step.end;
  part.last = step.begin == step.end;
  if (part.last) --count_;
  return part;
}

void UndoLog::clear() {
  first_ = count_ = 0;
  whole_ = false;
}

}  // namespace trephine::drill
