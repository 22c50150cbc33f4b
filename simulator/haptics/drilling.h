// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <atomic>
#include <string>
#include <vector>

#include "base/params.h"
#include "cases/case.h"
#include "drill/bone_heat.h"
#include "drill/cutter_body.h"
#include "drill/drill.h"
#include "drill/letting_go.h"
#include "haptics/burrs.h"
#include "haptics/feel.h"
#include "haptics/haptic_state.h"
#include "voxel/decode.h"

namespace trephine::haptics {

/// How a session cuts. Button 1 of the device is the drill's pedal; button 2, when it goes down, marks the tip as the
/// middle of an incision.
struct DrillingParams : drill::HeatParams {
  enum class Cutter { own, ball, cylinder };
  bool drill = false;
  Cutter cutter = Cutter::own;
  double cutter_height_mm = 0, cutter_width_ratio = 1, cutter_turn_deg = 0;
  double spindle_rpm = 60000, stall_force_n = 8, reaction_ratio = 0.5;
  double vibration_n = 0.05, vibration_hz = 200;
  double incision_radius_mm = 15, rim_strength_n_per_mm2 = 0.2;
  std::int64_t undo_steps = 20;
  template <class V>
  static void describe(V& v) {
    using P = DrillingParams;
    v.flag(&P::drill, "drill", "The tool cuts: while button 1 is down it drills, and button 2 marks an incision.");
    v.choice(&P::cutter, "cutter", {{"own", Cutter::own}, {"ball", Cutter::ball}, {"cylinder", Cutter::cylinder}},
             "What cuts; own: what the tool's kind says, such as a ball for a burr.");
    v.number(&P::cutter_height_mm, "cutter_height_mm", Range{0, 40},
             "Length of a cylinder, from the tip; 0: that of the tool's kind.");
    v.number(&P::cutter_width_ratio, "cutter_width_ratio", Range{0.05, 1},
             "Smaller semi-axis of a cylinder as a share of the larger, which is half of the tool's diameter.");
    v.number(&P::cutter_turn_deg, "cutter_turn_deg", Range{-180, 180},
             "Turn of a cylinder's larger axis about the tool's.");
    v.number(&P::spindle_rpm, "spindle_rpm", Range{100, 500000}, "Speed of the spindle, for the force of cutting.");
    v.number(&P::stall_force_n, "stall_force_n", Range{0.01, 100}, "Force of the feed at which the drill stalls.");
    v.number(&P::reaction_ratio, "reaction_ratio", Range{0, 10},
             "Reaction along the feed, as a share of the force at the cutter's rim.");
    v.number(&P::vibration_n, "vibration_n", Range{0, 5}, "Amplitude of the vibration at full power, across the tool.");
    v.number(&P::vibration_hz, "vibration_hz", Range{1, 1000}, "Its frequency.");
    v.number(&P::incision_radius_mm, "incision_radius_mm", Range{0.1, 30}, "Radius of an incision.");
    v.number(&P::rim_strength_n_per_mm2, "rim_strength_n_per_mm2", Range{0, 100},
             "What is left of bone under a cutter whose tip is through breaks under more than this, by its area.");
    v.integer(&P::undo_steps, "undo_steps", Range{0, 1000},
              "How many strokes and incisions can be taken back, the last one first; 0: none, nor all at once.");
    v.template all_of<drill::HeatParams>();
  }
};

/// What a session removed, and what happened on the way.
struct DrillingOutcome {
  std::array<std::int64_t, voxel::haptic_max_shapes + 1> units{};  ///< by shape, of 1/255 voxel
  std::array<double, touch::max_shape + 1> most_force_n{};         ///< by the shape that was touched
  std::int64_t late_units = 0;  ///< of all, those where the tool was a voxel further on already
  double energy_j = 0, drilled_s = 0, stalled_s = 0;
  /// While it removed something, or did so within the last 20 ms: for how long, the force's mean times that, and how
  /// far the tool went on along its axis.
  double cutting_s = 0, cutting_n_s = 0, advanced_mm = 0;
  double max_bone_c = drill::BoneHeat::body_c, above_harm_s = 0, heat_dose_min = 0;  ///< BoneHeat
  int incisions = 0;
  int undone = 0, resets = 0;  ///< strokes and incisions that were taken back; how often all was
  bool breached = false;       ///< the tip left drilled bone on the other side than it came in, for the first time
  double breach_time_s = 0;
  Vec3 breach_mm;
};

/// How each shape of the case is removed.
drill::DrillShapes drill_shapes_of(const cases::CaseHaptic& haptic);
/// The shapes that a drill removes, bit n for shape n.
std::uint64_t drilled_shapes(const cases::CaseHaptic& haptic);
/// The tool's cutter. Throws Error 64 where the tool cuts nothing.
drill::Cutter cutter_of(const DrillingParams& params, const ToolParams& own_tool);

/// Removal within the tick of the servo loop, after the proxy: the cutter stands where the tool is shown, and its force
/// is felt in the next tick. Only the constructor allocates; nothing locks or makes a system call; equal
/// ticks give equal bits.
class Drilling {
 public:
  /// All must outlive it; `marks` may be null.
  Drilling(voxel::HapticVolume& volume, contact::ContactVolume& contact, const drill::DrillShapes& shapes,
           const DrillingParams& params, const drill::DrillParams& law, const drill::Cutter& cutter,
           drill::DirtyBricks* marks = nullptr);
  /// With several burrs, of which the first is in hand.
  Drilling(voxel::HapticVolume& volume, contact::ContactVolume& contact, const drill::DrillShapes& shapes,
           const DrillingParams& params, const drill::DrillParams& law, std::vector<Burr> burrs,
           drill::DirtyBricks* marks = nullptr);

  /// From the next tick on that burr is in hand. A way through bone that another one began goes on.
  void hold(int burr);
  int in_hand() const { return burr_; }

  /// The force on the hand since the last tick: against the motion, and a vibration across the tool. But for the
  /// vibration it never gives energy to a device at rest.
  Vec3 force_n() const { return force_; }
  /// What the drill adds to the input of a tick, whose buttons are known: its force, whether it runs, came free of
  /// bone in the last tick, or is put back, and what of the bone lets go of it.
  void prepare(HapticInput& in) const;
  void tick(const HapticInput& in, const HapticState& state);
  /// Begins an incision there.
  void incise_at(Vec3 point_mm);
  /// Takes back the last stroke of the pedal or the last incision, or all that was cut since the start; the voxels are
  /// then as they were, to the bit. It takes some ticks, putting_back(), in which nothing is cut. What has happened
  /// stays counted: the time, the energy and the forces. False where nothing can be taken back: there is nothing, or it
  /// is too long ago. The pedal must be up.
  enum class Back { last, all };
  bool take_back(Back what);
  /// What the tool lies in changes, so it cannot be felt (HapticInput::away). Other threads may ask.
  bool putting_back() const { return putting_back_.load(std::memory_order_relaxed); }
  const DrillingOutcome& outcome() const { return outcome_; }
  /// What was removed of the shape, of 1/255 voxel; another thread may ask.
  std::int64_t removed_units(int shape) const { return removed_[std::size_t(shape)].load(std::memory_order_relaxed); }
  /// What is heard of it; another thread may ask.
  struct Heard {
    bool runs, stalled;
    double load_ratio, energy_j_per_mm3;
    int flutes;
  };
  Heard heard() const;

  static constexpr std::uint32_t pedal = 1, mark = 2;

 private:
  void measure_burr();
  void count(const drill::Removal& removal, bool breaks = false);
  void cut_late(double dt_s);
  void feel_heat(bool runs, double dt_s);
  double cut(const HapticInput& in, const HapticState& state);
  drill::Wider wider(const HapticState& state) const;
  drill::ToolPose turned_pose(Vec3 tip_mm, Vec3 axis, Vec3 across) const;
  void watch_breach(const HapticInput& in, Vec3 tip_mm);
  void let_go(const HapticInput& in, const HapticState& state);
  bool was_bone(Vec3 at_mm) const;

  contact::ContactVolume& contact_;
  const DrillingParams params_;
  const std::vector<Burr> burrs_;
  std::atomic<int> burr_{0};
  const double power_w_;
  drill::DrillShapes shapes_;
  voxel::HapticVolume before_;  ///< as it was at the start
  voxel::HapticDecoder before_decoder_;
  drill::Drill drill_;
  drill::BoneHeat heat_;
  double removed_j_ = 0, removed_mm3_ = 0, voxel_mm3_;  // in this tick
  double since_cut_s_ = 1;
  std::atomic<float> load_{0}, hardness_{0};
  std::atomic<bool> runs_{false}, stalls_{false};
  Vec3 force_, last_mm_, velocity_;
  double power_ = 0, time_s_ = 0, rim_m_per_s_ = 1;
  std::uint32_t buttons_ = 0;
  double wider_voxels_ = 0;  ///< than the tool, of what it cuts
  double ramp_voxels_ = 1;
  struct Stand {  ///< what taking back changes of the outcome
    std::array<std::int64_t, voxel::haptic_max_shapes + 1> units;
    int incisions;
    bool breached, in_bone;
    std::int64_t pass_units;
    double breach_time_s;
    Vec3 breach_mm, entry_mm;
  };
  Stand stand() const;
  void go_back_to(const Stand& stand);
  void begin_step();
  void put_back(std::uint32_t buttons);
  std::vector<Stand> stands_;  ///< by the steps' places
  Stand back_to_;
  std::atomic<bool> putting_back_{false};
  bool begun_ = false, in_bone_ = false;
  drill::LettingGo letting_go_;
  bool due_ = false;             ///< a breach that is told when the cutter is free
  Vec3 due_mm_;                  ///< where its tip came through
  bool came_through_ = false;    ///< in this tick the cutter came free
  std::int64_t pass_units_ = 0;  ///< of what a drill removes, since the tip is in bone
  double least_pass_units_ = 0;  ///< of a way through bone that is a breach
  Vec3 entry_mm_;
  DrillingOutcome outcome_;
  std::array<std::atomic<std::int64_t>, voxel::haptic_max_shapes + 1> removed_{};  // outcome_.units, for other threads
};

}  // namespace trephine::haptics
