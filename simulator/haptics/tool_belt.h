// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptics/belt_rules.h"
#include "haptics/drilling.h"
#include "haptics/proxy.h"

namespace trephine::haptics {

/// A tool of a session with several.
struct BeltToolParams : ToolParams {
  std::string name;
  bool blunt = false, marks = false, cuts = false;
  double pierce_n = 0;
  template <class V>
  static void describe(V& v) {
    using P = BeltToolParams;
    v.text(&P::name, "name", "What the lesson calls it.");
    v.template all_of<ToolParams>();
    v.flag(&P::blunt, "blunt", "It enters nothing, however hard it is pressed.");
    v.flag(&P::marks, "marks", "While the pedal is down it draws on what it touches, and its last point is kept.");
    v.flag(&P::cuts, "cuts", "While the pedal is down it drills.");
    v.number(&P::pierce_n, "pierce_n", Range{0, 100},
             "Force at which it enters and leaves what else nothing enters, such as bone; 0: it does not.");
  }
};

/// The tools of a session, of which the hand holds one at a time: a proxy for each, the drill, and what commands do in
/// the tick. Changing the tool takes no time; the new one begins where the device is, and its force rises from zero.
/// The force of the tool that was put down falls within the limit on the force's rate.
///
/// - The command `incise` cuts the skin around the last point that a marking tool touched with its pedal down.
/// - A tool is changed in the open alone: while nothing is touched and the pose lies in no shape. A session that begins
///   inside a shape, or goes on there after a pause or after the hand took the tool away, feels nothing until the pose
///   was outside.
/// - `undo` takes back the last stroke or incision, `reset` all that was cut in the session, while the pedal is up; as
///   after a pause nothing is felt until the pose is outside of every shape.
/// - `pause` is taken while the tool is in the open; until `resume` nothing is felt, cut or marked.
///
/// Everything follows from the frames' poses, buttons and steps, so a recording replays bit for bit. update() and
/// after() neither allocate, lock nor throw, and make no system call.
class ToolBelt {
 public:
  /// What `space` refers to, and `drilling` (may be null), must outlive it. Throws as make_tool does; 64 for no tool,
  /// or more than 16.
  ToolBelt(const touch::FeltSpace& space, const Feels& feels, const ForceParams& force, const ShaftParams& shaft,
           std::vector<BeltToolParams> tools, Drilling* drilling);
  ~ToolBelt();

  const HapticState& update(const HapticInput& given);
  /// What tool and commands do, after the force was sent.
  void after(const HapticInput& in, const HapticState& state);
  /// update() with an answer that is known from a recording, or from a belt that works in another thread.
  void follow(const HapticInput& in, const HapticState& state);
  /// From now on this belt cuts nothing, and only follows another one: it reports what `others`, the drill of that
  /// belt, removed. Null: that belt has no drill.
  void watch(const Drilling* others) { watched_ = others; }
  void latch(std::uint32_t fault);
  /// Of another hand, before each tick: BeltRules::obey().
  void obey(bool paused, bool takes_back) { rules_.obey(paused, takes_back); }

  const std::vector<BeltToolParams>& tools() const { return tools_; }
  int in_hand() const { return rules_.in_hand(); }
  bool paused() const { return rules_.paused(); }
  bool takes_back() const { return rules_.takes_back(); }  ///< after after(): BeltRules
  bool idle() const { return rules_.idle(); }  ///< a pause, or the wait for the open: nothing is felt, cut or marked
  bool has_mark() const { return has_mark_; }
  Vec3 mark_mm() const { return mark_mm_; }
  Drilling* drilling() const { return drilling_; }
  bool can_cut() const { return drilling_ || watched_; }
  std::int64_t removed_units(int shape) const {
    return drilling_ ? drilling_->removed_units(shape) : watched_ ? watched_->removed_units(shape) : 0;
  }

 private:
  bool take(const HapticInput& in);
  bool putting_back() const { return can_cut() && (drilling_ ? drilling_ : watched_)->putting_back(); }
  void settle_force(const HapticInput& in, Vec3 sent);

  const contact::ContactVolume& contact_;
  const ForceParams force_;
  const std::vector<BeltToolParams> tools_;
  std::vector<std::unique_ptr<Proxy>> proxies_;
  std::vector<int> burrs_;  ///< by tool, its number among those that cut, as the drill counts them; -1: it does not
  Drilling* drilling_;
  const Drilling* watched_ = nullptr;
  HapticState state_;
  Vec3 left_n_;  ///< of the force of the tool that was put down
  BeltRules rules_;
  bool has_mark_ = false;
  Vec3 mark_mm_;
};

}  // namespace trephine::haptics
