// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec3.h"
#include "contact/contact.h"
#include "drill/cutter.h"

namespace trephine::drill {

/// How bone lets go of a cutter that comes through it. Once the tip has left the bone, what is left of it under the
/// cutter bears a pressure that is its area, seen along the tool, times a strength; a cutter that is pressed harder
/// breaks it, and so does any cutter when less than a seventh of its area is left. From then on the bone's stiffness
/// falls as fast as the force may (ForceSlew), and it gives way so that the last of its area goes with the last of its
/// stiffness: nothing is felt in the open.
///
/// The strength is a figure that we chose: a ball of 5 mm lets go under 3 N when a quarter of it is free. The rim of a
/// plate is not modelled as a solid. Only the constructor and add() allocate.
class LettingGo {
 public:
  /// `bone`: the shapes that a drill removes, bit n for shape n. `max_n_per_ms`: how fast the force may fall.
  LettingGo(const contact::ContactVolume& contact, std::uint64_t bone, double strength_n_per_mm2, double max_n_per_ms)
      : contact_(contact), bone_(bone), strength_n_per_mm2_(strength_n_per_mm2), max_n_per_ms_(max_n_per_ms) {}
  /// A further cutter; its number is how many were added before.
  void add(const Cutter& cutter);
  void hold(int cutter) {
    held_ = cutter;
    rest();
  }

  /// The tip has left the bone on its far side.
  void come_through() { through_ = true; }
  bool is_through() const { return through_; }
  void rest() {
    hold_again();
    through_ = false;
  }
  /// The bone holds again as before: the drill stops, or its tip is in bone once more. It remains through.
  void hold_again() {
    breaks_ = false;
    ratio_ = 1;
    loose_s_ = 0;
  }
  /// Looks at what is left of the bone under the cutter. `pressure_n`: what is felt of it now. True where nothing is,
  /// or has held for a while: the cutter is free, and this rests.
  bool look(const ToolPose& tool, double pressure_n, double dt_s);

  /// Bone gives way, whatever power the drill has, by at most so much in a tick.
  bool breaks() const { return breaks_; }
  double most_mm() const { return most_mm_; }
  /// What is left of the bone's stiffness; 1: it holds.
  double ratio() const { return ratio_; }
  /// Nothing of it is felt any more.
  bool is_loose() const;
  std::uint64_t bone() const { return bone_; }

 private:
  struct Front {
    std::vector<Vec3> at_mm;  ///< just before the cutter's end, from its tip, along across, up and axis; of equal areas
    double area_mm2 = 0, radius_mm = 0;
    bool round = false;
  };
  double share_left(const ToolPose& tool) const;
  const contact::ContactVolume& contact_;
  const std::uint64_t bone_;
  const double strength_n_per_mm2_, max_n_per_ms_;
  std::vector<Front> fronts_;
  int held_ = 0;
  bool through_ = false, breaks_ = false;
  double from_ = 1, ratio_ = 1, fall_per_s_ = 0, most_mm_ = 0, loose_s_ = 0;  ///< from_: the share where it broke
};

}  // namespace trephine::drill
