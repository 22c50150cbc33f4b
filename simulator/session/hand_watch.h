// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "haptics/belt_rules.h"
#include "haptics/recording.h"

namespace trephine::session {

/// What the hand holds and whether its commands act, from the frames of a session or of its recording as they come. The
/// tool that a hand asks for is not always the one that it holds: a belt changes tools in the open alone
/// (haptics::ToolBelt), and this follows its rules.
class HandWatch {
 public:
  /// The shape at a place of the volume as it is in that tick; 0 for none.
  using ShapeAt = std::function<int(Vec3)>;
  /// Without `shape_at`, a pose where nothing is touched counts as outside of every shape, and a hand that waits for
  /// such a pose does so for one tick.
  explicit HandWatch(const haptics::RecordingHeader& header, ShapeAt shape_at = {});
  /// Of the other hand and the one tool that it holds, whose commands are the first hand's.
  explicit HandWatch(const haptics::RecordedSecondHand& held, ShapeAt shape_at = {});
  void look(const haptics::ServoFrame& frame);
  /// The other hand's frame, after `first` has looked at the first hand's.
  void look(const haptics::ServoFrame& frame, const HandWatch& first);
  /// The number of the tool in hand in the last frame; 0 in a session with one tool.
  std::size_t tool() const { return std::size_t(std::max(0, rules_.in_hand())); }
  /// Whether what the first hand cut is taken back from the last frame on, as far as frames say it.
  bool takes_back() const;
  /// Whether pedal and commands did something in the last frame.
  bool works() const { return works_; }
  /// That came with the last frame, whether or not it does something; belt_command::none for none.
  int command() const { return command_; }

 private:
  bool is_in_shape(const haptics::ServoFrame& frame) const;
  void follow_belt(const haptics::ServoFrame& frame);

  std::size_t tools_;
  bool drills_;
  ShapeAt shape_at_;
  haptics::BeltRules rules_;
  std::uint32_t buttons_ = 0;
  int command_ = 0;
  bool free_ = true, works_ = false;  // free: it touched nothing, in nothing
};

/// By frame, the tool in hand as far as frames tell it, without the volume; 0 in a session with one tool.
std::vector<std::size_t> tools_in_hand(const haptics::Recording& recording);

}  // namespace trephine::session
