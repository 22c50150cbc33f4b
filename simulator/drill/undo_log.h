// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace trephine::drill {

/// A voxel as it was: its raw value, and what was cut of it beyond whole units.
struct KeptVoxel {
  std::uint32_t at;
  std::int16_t raw;
  std::uint8_t fraction;
};

/// What voxels were before each of the last steps, such as strokes of a drill. Only the constructor allocates. Where
/// room runs out the oldest steps are forgotten; a step that alone is too large is forgotten as well, and so is
/// whatever comes after 65,000 steps.
class UndoLog {
 public:
  /// `max_steps`: 0 keeps nothing. `max_voxels`: of all kept steps together.
  UndoLog(std::size_t voxel_count, int max_steps, std::size_t max_voxels);

  /// What is noted from now on belongs to a new step, unless nothing was noted since the last one began.
  void begin_step();
  /// Before a voxel changes. Only the first call for a voxel in a step counts.
  void note(const KeptVoxel& was) {
    if (stamp_.empty() || stamp_[was.at] == number_) return;
    add(was);
  }
  /// Steps that can be taken back, the last one too if nothing was noted in it.
  int steps() const { return count_; }
  /// Index, 0 to max_steps - 1, of the newest step. It does not change while the step is kept. There must be one.
  int place() const { return (first_ + count_ - 1) % int(steps_.size()); }
  /// Ends the newest step; forgets it if nothing was noted in it.
  void end_step();
  /// The newest voxels of the newest step, at most that many, off the log: valid until the next note().
  struct Part {
    const KeptVoxel* first = nullptr;
    std::size_t count = 0;
    bool last = true;  ///< the step is gone with it
  };
  Part take(std::size_t most);
  void clear();

 private:
  struct Step {
    std::uint64_t begin = 0, end = 0;  // of all that was ever noted
  };
  void add(const KeptVoxel& was);
  void forget_oldest();
  Step& newest() { return steps_[std::size_t(first_ + count_ - 1) % steps_.size()]; }

  std::vector<std::uint16_t> stamp_;  // by voxel, the step that noted it
  std::vector<KeptVoxel> kept_;       // a ring
  std::vector<Step> steps_;           // a ring
  int first_ = 0, count_ = 0;
  std::uint64_t next_ = 0;
  std::uint16_t number_ = 0;
  bool whole_ = false;  // the newest step is kept and may grow
};

}  // namespace trephine::drill
