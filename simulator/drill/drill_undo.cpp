// SPDX-License-Identifier: GPL-3.0-or-later
// What was cut is put back, to the bit.
#include <algorithm>

#include "drill/drill.h"
#include "voxel/raw_voxel.h"

namespace trephine::drill {
namespace {

constexpr std::size_t max_kept = std::size_t(1) << 20, max_put_back = 4000;
constexpr int max_looked = 16000;  // voxels of which most are as they were

}  // namespace

void Drill::keep_steps(int max_steps) {
  const std::size_t count = volume_.voxels.count();
  log_ = UndoLog(count, max_steps, std::min(count, max_kept));
  changes_.reserve(std::max(changes_.capacity(), max_put_back));
}

// All that was ever cut lies in such boxes.
void Drill::reach(const grid::Box& box) {
  if (box.empty()) return;
  const bool first = ever_.empty();
  for (std::size_t a = 0; a < 3; ++a) {
    ever_.begin[a] = first ? box.begin[a] : std::min(ever_.begin[a], box.begin[a]);
    ever_.end[a] = first ? box.end[a] : std::max(ever_.end[a], box.end[a]);
  }
}

bool Drill::take_back() {
  if (putting_back()) return false;
  log_.end_step();
  if (log_.steps() == 0) return false;
  rest();
  ways_count_ = 0;
  incision_ = {};
  next_ = next_row_ = 0;
  back_ = Back::step;
  return true;
}

bool Drill::take_all_back(const grid::Grid<std::int16_t>& begin) {
  if (putting_back() || ever_.empty()) return false;
  rest();
  ways_count_ = 0;
  incision_ = {};
  next_ = next_row_ = 0;
  log_.clear();
  begin_ = &begin;
  back_slice_ = ever_.begin[2];
  back_row_ = ever_.begin[1];
  back_ = Back::all;
  return true;
}

void Drill::change_back(std::uint32_t at, std::int16_t raw, std::uint8_t fraction) {
  fraction_[at] = fraction;
  std::int16_t& voxel = volume_.voxels.voxels[at];
  if (voxel == raw) return;
  __atomic_store_n(&voxel, raw, __ATOMIC_RELAXED);
  const std::size_t row = std::size_t(volume_.voxels.size[0]), rest = at / row;
  const int place[3] = {int(at % row), int(rest % std::size_t(volume_.voxels.size[1])),
                        int(rest / std::size_t(volume_.voxels.size[1]))};
  changes_.push_back({at, std::int16_t(place[0]), std::int16_t(place[1]), std::int16_t(place[2]), raw});
  for (std::size_t a = 0; a < 3; ++a) {
    changing_.begin[a] = changes_.size() == 1 ? place[a] : std::min(changing_.begin[a], place[a]);
    changing_.end[a] = changes_.size() == 1 ? place[a] + 1 : std::max(changing_.end[a], place[a] + 1);
  }
}

const Removal& Drill::put_back() {
  out_ = {};
  changes_.clear();
  changing_ = {};
  if (back_ == Back::step) {
    const UndoLog::Part part = log_.take(max_put_back);
    for (std::size_t n = 0; n < part.count; ++n)
      change_back(part.first[n].at, part.first[n].raw, part.first[n].fraction);
    if (part.last) back_ = Back::none;
  } else if (back_ == Back::all) {
    const int across = ever_.end[0] - ever_.begin[0];
    for (int looked = 0; back_slice_ < ever_.end[2] && looked < max_looked &&
                         (changes_.empty() || changes_.size() + std::size_t(across) <= max_put_back);
         looked += across) {
      for (int i = ever_.begin[0]; i < ever_.end[0]; ++i) {
        const std::size_t at = volume_.voxels.index(i, back_row_, back_slice_);
        change_back(std::uint32_t(at), begin_->voxels[at], 0);
      }
      if (++back_row_ < ever_.end[1]) continue;
      back_row_ = ever_.begin[1];
      ++back_slice_;
    }
    if (back_slice_ >= ever_.end[2]) {
      back_ = Back::none;
      ever_ = {};
    }
  }
  if (changes_.empty()) return out_;
  changing_ = grid::grown(changing_, 1, volume_.voxels);  // a voxel says to whom its neighbours' rest belongs
  mark_changes();
  return out_;
}

}  // namespace trephine::drill
