// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "drill/tool_ways.h"
#include "drill/voxel_removal.h"

namespace trephine::drill {

/// Removes material from a haptic volume, in its servo loop [Rizzi, chapter 6, Tables VII and VIII, as rates in time].
/// The occupancy o of the voxels with the centre x falls by do/dt = -K w(x - c(t)), where w is the cutter's weight, c
/// goes straight within a tick, and K is the smaller of max_rate_per_s and what the power allows: power / sum of energy
/// * w * voxel volume over voxels that are not empty. Fractions of 1/255 are kept, in steps of 1/65280, so the removed
/// volume does not depend on the tick's length.
///
/// Of a volume of HU the HU fall in place of the occupancy, by those of a full voxel a time (HuWindows): a voxel is its
/// shape's until its HU leave the window, and no other shape's then.
///
/// Only cuttable shapes are removed. Voxels only fall: the occupancy of no shape rises anywhere, and a voxel beside a
/// cut becomes bare where its rest would go to another shape than before (cut_volume()). A voxel of two shapes that is
/// cut keeps one of them: that which may not be removed, at its share, else the larger.
///
/// The thread that calls is the only one that lowers voxels; others may read them (relaxed atomics), settle, and take
/// marks, which are set after the stores. Only the constructor, add_cutter and keep_steps allocate or throw; nothing
/// locks or makes a system call; equal calls give equal bits. After a call ContactVolume::loosen(changed) is due.
class Drill {
 public:
  /// `volume` and `marks` (may be null) must outlive it. Throws Error 78 where the cutter
  /// is larger than 40 mm or has a size that is not positive.
  Drill(voxel::HapticVolume& volume, const DrillShapes& shapes, const Cutter& cutter, const DrillParams& params,
        DirtyBricks* marks = nullptr);

  /// The tool runs: it cuts what lies within the cutter, made wider, at `pose`, on the way to `to_tip_mm`, and
  /// along the whole way from where the last call ended, however fast it goes. A voxel keeps what lies outside, as a
  /// ramp of ramp_voxels() to each side of the cutter's surface (CutterBody), so that the surface of half occupancy is
  /// the cutter's. What the power or the rate leaves is removed by the next calls, as long as the tool stands there.
  /// The first call after rest() begins at `pose`. `power_ratio`: the share of the power that is left; above 1 where
  /// bone breaks away that no power has to cut.
  ///
  /// A call looks at some 8,000 voxels; where a way has more, the next calls go on with it, and what the tool goes on
  /// meanwhile is added up, as long as it goes straight to a quarter of a voxel (or 32 ways wait). So nothing is left
  /// out; Removal says what is late.
  const Removal& cut_way(const ToolPose& pose, Vec3 to_tip_mm, const Wider& wider, double dt_s, double power_ratio = 1);
  /// Goes on with that while the tool does not run.
  const Removal& cut_late(double dt_s);
  bool late() const { return !ways_.empty(); }
  /// A further cutter; its number is how many were added before it, the constructor's being 0. It allocates: call it
  /// before the first cut. Throws as the constructor does.
  void add_cutter(const Cutter& cutter);
  /// Takes that cutter in hand; its way begins with the next call. What is late is cut with the cutter that went there.
  void hold(int number);

  /// The tool does not run.
  void rest() { runs_ = false; }

  /// Begins to remove what cannot be drilled (energy 0) within the radius, at most 30 mm, of the point: the scalp of a
  /// flap. Each call of go_on() takes 4,000 voxels at most, and does nothing where there is nothing left to do.
  void incise(Vec3 point_mm, double radius_mm);
  bool incising() const { return incision_.goes_on(); }
  const Removal& go_on();

  /// Keeps what is changed from then on, by steps, so that the last `max_steps` can be taken back. It allocates: call
  /// it before the first cut. begin_step() says that a new one begins.
  void keep_steps(int max_steps);
  void begin_step() { voxels_.log().begin_step(); }
  /// Index of the newest step that is kept (UndoLog::place); -1 where there is none.
  int step_place();
  /// Begins to take the newest step back, or all that this object cut: `begin` are the voxels as they were at its
  /// start. Each put_back() then gives some thousand voxels their old value again, to the bit, with what was cut of
  /// them beyond whole units, as long as putting_back(); nothing else may be called meanwhile. What is late or still
  /// to be incised is forgotten. False where there is nothing to take back. The units of put_back() are 0.
  bool take_back();
  bool take_all_back(const grid::Grid<std::int16_t>& begin);
  bool putting_back() const { return back_ != Back::none; }
  const Removal& put_back();

  const Cutter& cutter() const { return ways_.cutter(held_); }

 private:
  void cut_pass();
  const Removal& go_ways(double dt_s);
  void forget_what_is_due();

  const double power_w_;
  const grid::Lattice& lattice_;
  VoxelRemoval voxels_;
  ToolWays ways_;
  int held_ = 0;  // the cutter
  ToolPose end_;  // of the last way
  bool runs_ = false;
  Incision incision_;
  enum class Back { none, step, all };
  Back back_ = Back::none;
  const grid::Grid<std::int16_t>* begin_ = nullptr;  // what all is put back to, row by row
  int back_slice_ = 0, back_row_ = 0;
};

}  // namespace trephine::drill
