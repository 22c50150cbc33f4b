// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <string>
#include <utility>

#include "contact/contact.h"
#include "haptics/frame.h"
#include "haptics/hand_motion.h"
#include "haptics/tool_belt.h"

namespace trephine::lessons {

/// A move that is above is no hand's: the lesson is not judged.
using haptics::hand_window_s;
using haptics::max_hand_m_per_s;
using haptics::max_hand_m_per_s2;
/// Within the patient no tool goes forward faster than that over so long: a hand that slips through a wall is at rest
/// again after some 10 mm, and needles are pushed with 0.1 m/s.
constexpr double max_forward_m_per_s = 0.5, forward_window_s = 0.05;

/// Looks at a lesson's frames one by one: whether each could be a hand's, at the pace that the recording says, and
/// whether a tool begins, is changed or comes again only outside of every shape. What was lifted, or moved in a pause,
/// may come again elsewhere.
class HandLimits {
 public:
  /// `contact` as it is cut while the frames are followed; it must outlive this.
  /// `whose`: begins what is refused.
  explicit HandLimits(const contact::ContactVolume& contact, std::string whose = "")
      : contact_(contact), whose_(std::move(whose)) {}
  /// Before the belt follows the frame, and after: `belt` as it then is. Throws Error 65 with the field `frames`.
  void look(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt);

 private:
  [[noreturn]] void refuse(const haptics::ServoFrame& f, const std::string& what) const;
  void look_at_speed(const haptics::ServoFrame& f);
  void look_at_pace(const haptics::ServoFrame& f);
  struct Moment {
    double time_s;
    Vec3 tip_mm;
  };
  const contact::ContactVolume& contact_;
  const std::string whose_;
  std::deque<Moment> moments_;  // of two windows
  std::deque<Moment> within_;   // of the proxy, one window, while the tip is within a shape
  bool away_ = true;            // not begun, lifted or paused
  bool was_silent_ = false;
  int tool_ = -1, inside_ = 0;
};

}  // namespace trephine::lessons
