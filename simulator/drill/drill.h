// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "drill/bricks.h"
#include "drill/cutter.h"
#include "drill/undo_log.h"
#include "voxel/haptic_volume.h"

namespace trephine::drill {

/// The law of removal.
struct DrillParams {
  double power_w = 20, max_rate_per_s = 400, soft_energy_ratio = 0.3;
  template <class V>
  static void describe(V& v) {
    using P = DrillParams;
    v.number(&P::power_w, "power_w", Range{0.01, 1000}, "Power of the drill's spindle under load.");
    v.number(&P::max_rate_per_s, "max_rate_per_s", Range{0.01, 10000},
             "Largest rate at which occupancy falls in the cutter's middle; 400: a full voxel in 2.5 ms.");
    v.number(&P::soft_energy_ratio, "soft_energy_ratio", Range{0.001, 1},
             "Energy for the softest material of a hardness volume, as a share of its shape's.");
  }
};

/// How a shape is removed. Energy 0: never by a rotating tool, however cuttable it is.
struct DrillShape {
  bool cuttable = false;
  double energy_j_per_mm3 = 0;
};
using DrillShapes = std::array<DrillShape, voxel::haptic_max_shapes + 1>;

class CutterBody;

/// What one call removed. A voxel counts by its occupancy.
struct Removal {
  std::array<std::int64_t, voxel::haptic_max_shapes + 1> units{};  ///< by shape; 255 are a voxel
  double energy_j = 0;
  double power_w = 0;           ///< over the call's time
  std::int64_t late_units = 0;  ///< of all units, those where the tool is a voxel further on already (cut_way)
  grid::Box changed;            ///< voxels that may have another value than before; empty where there are none
};

/// Removes material from a haptic volume of encoding `occupancy`, in its servo loop [Rizzi, chapter 6, Tables VII and
/// VIII, as rates in time]. The occupancy o of the voxels with the centre x falls by do/dt = -K w(x - c(t)), where w is
/// the cutter's weight, c goes straight within a tick, and K is the smaller of max_rate_per_s and what the power
/// allows: power / sum of energy * w * voxel volume over voxels that are not empty. Fractions of 1/255 are kept, in
/// steps of 1/65280, so the removed volume does not depend on the tick's length.
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
  /// `volume` and `marks` (may be null) must outlive it. Throws Error 65 where the encoding is not `occupancy`, or the
  /// cutter is larger than 40 mm or has a size that is not positive.
  Drill(voxel::HapticVolume& volume, const DrillShapes& shapes, const Cutter& cutter, const DrillParams& params,
        DirtyBricks* marks = nullptr);

  /// The tool runs: it cuts what lies within the cutter, grown by `wider_mm`, at `pose`, on the way to `to_tip_mm`, and
  /// along the whole way from where the last call ended, however fast it goes. A voxel keeps what lies outside, as a
  /// ramp of a voxel to each side of the cutter's surface (CutterBody), so that the surface of half occupancy is the
  /// cutter's. What the power or the rate leaves is removed by the next calls, as long as the tool stands there. The
  /// first call after rest() begins at `pose`. `power_ratio`: the share of the power that is left, 0 to 1.
  ///
  /// A call looks at some 8,000 voxels; where a way has more, the next calls go on with it, and what the tool goes on
  /// meanwhile is added up, as long as it goes straight to a quarter of a voxel (or 32 ways wait). So nothing is left
  /// out; Removal says what is late.
  const Removal& cut_way(const ToolPose& pose, Vec3 to_tip_mm, double wider_mm, double dt_s, double power_ratio = 1);
  /// Goes on with that while the tool does not run.
  const Removal& cut_late(double dt_s);
  bool late() const { return ways_count_ > 0; }
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
  bool incising() const { return next_ < incision_.end[2]; }
  const Removal& go_on();

  /// Keeps what is changed from then on, by steps, so that the last `max_steps` can be taken back. It allocates: call
  /// it before the first cut. begin_step() says that a new one begins.
  void keep_steps(int max_steps);
  void begin_step() { log_.begin_step(); }
  /// Index of the newest step that is kept (UndoLog::place); -1 where there is none.
  int step_place() const { return log_.steps() > 0 ? log_.place() : -1; }
  /// Begins to take the newest step back, or all that this object cut: `begin` are the voxels as they were at its
  /// start. Each put_back() then gives some thousand voxels their old value again, to the bit, with what was cut of
  /// them beyond whole units, as long as putting_back(); nothing else may be called meanwhile. What is late or still
  /// to be incised is forgotten. False where there is nothing to take back. The units of put_back() are 0.
  bool take_back();
  bool take_all_back(const grid::Grid<std::int16_t>& begin);
  bool putting_back() const { return back_ != Back::none; }
  const Removal& put_back();

  const Cutter& cutter() const { return cutter_; }

 private:
  struct Entry {
    std::uint32_t at;
    std::int16_t i, j, k, fall;  ///< fall: of 1/255; the fraction is kept
    float dose, energy, left;    ///< s; J of the full voxel; occupancy
    std::int16_t stays = 0;      ///< what is not removed, of 1/255
  };
  struct Change {
    std::uint32_t at;
    std::int16_t i, j, k, raw;
  };
  struct Shared {
    std::uint32_t at;
    std::int16_t i, j, k, other;
  };
  enum class Back { none, step, all };
  void reach(const grid::Box& box);
  void change_back(std::uint32_t at, std::int16_t raw, std::uint8_t fraction);
  void mark_changes();
  grid::Box box_around(Vec3 middle_mm, double reach_mm) const;
  void collect(const CutterBody& body, double time_s, int slice, int slices);
  /// A straight piece of the tool's way, which is cut in so many passes.
  struct Way {
    ToolPose from;
    Vec3 to_tip_mm;
    double wider_mm = 0, time_s = 0, energy_j = 0;
    int passes = 1, pass = 0;
    int cutter = 0;
  };
  Way& way_at(int n) { return ways_[std::size_t((first_way_ + n) % max_ways)]; }
  double voxels_of(const Way& way) const;
  int passes_of(const Way& way) const;
  bool join(Way& last, const Way& way, bool always);
  void join_any();
  void make_room(const Cutter& cutter);
  void add_way(const Way& way);
  void cut_pass();
  const Removal& go_ways(double dt_s);
  double rate_for(double budget_j);
  void apply(double units_per_dose, bool incision);
  void lower(const Entry& e, bool incision);
  void keep_shared();
  void store(bool incision);
  bool keeps_own(int own, int share, int other, int rest, bool incision) const;
  double energy_of(int shape, std::uint32_t at) const;
  bool removes(int shape, bool incision) const {
    const DrillShape& s = shapes_[std::size_t(shape)];
    return shape != 0 && s.cuttable && (s.energy_j_per_mm3 > 0) != incision;
  }

  voxel::HapticVolume& volume_;
  DrillShapes shapes_;
  Cutter cutter_;
  std::vector<Cutter> cutters_;
  int held_ = 0;  // of cutters_
  DrillParams params_;
  DirtyBricks* marks_;
  std::vector<std::uint8_t> fraction_;  ///< of 1/255, by voxel
  std::vector<std::uint8_t> kind_;  ///< by raw value: 1 its shape is drilled, 2 incised, 4 the rest may be of another
  std::vector<Entry> entries_;
  std::vector<Change> changes_;
  std::vector<Shared> shared_;
  std::vector<std::uint8_t> brick_marked_;
  double voxel_mm3_ = 1;
  bool any_shared_ = false;

  static constexpr int fine = 256;  ///< steps of a unit of occupancy
  static constexpr std::uint8_t drilled = 1, incised = 2, shared = 4;
  static constexpr double largest_mm = 40;
  static constexpr int max_voxels = 8000, incision_voxels = 4000;
  static constexpr int max_ways = 32, max_passes = 4096;
  std::array<Way, max_ways> ways_{};  // a ring, oldest first
  int first_way_ = 0, ways_count_ = 0;
  ToolPose end_;  // of the last way
  bool runs_ = false;
  Vec3 incision_mm_;
  double incision_radius_mm_ = 0;
  grid::Box incision_;
  int next_ = 0, next_row_ = 0;
  grid::Box changing_;
  Removal out_;
  UndoLog log_{0, 0, 0};
  grid::Box ever_;  // of all voxels that may have changed
  Back back_ = Back::none;
  const grid::Grid<std::int16_t>* begin_ = nullptr;
  int back_slice_ = 0, back_row_ = 0;
};

}  // namespace trephine::drill
