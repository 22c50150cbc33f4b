// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>

#include "haptics/haptic_state.h"

namespace trephine::haptics {

/// What the buttons of a device mean in a session with several tools. Bit 0 is the pedal; four bits are the number of
/// the tool in hand; eight bits are a command, which acts in the first tick that has it.
namespace belt_button {
constexpr std::uint32_t pedal = 1;
constexpr int tool_shift = 8, command_shift = 16;
constexpr std::uint32_t tool_mask = 0xf, command_mask = 0xff;
constexpr int tool(std::uint32_t buttons) { return int(buttons >> tool_shift & tool_mask); }
constexpr int command(std::uint32_t buttons) { return int(buttons >> command_shift & command_mask); }
}  // namespace belt_button

namespace belt_command {
constexpr int none = 0, erase = 1, incise = 2, finish = 3, pause = 4, resume = 5;
/// Of a C-arm: to a view, or by 5 degrees.
constexpr int view_ap = 6, view_lateral = 7, view_oblique = 8, orbit_more = 9, orbit_less = 10, tilt_more = 11,
              tilt_less = 12;
constexpr int aspirate = 13;  ///< draws on the needle's syringe
/// Of what was cut: the last stroke or incision, or all. Also in a session with one tool, whose drill takes them.
constexpr int undo = 14, reset = 15;
constexpr const char* names[] = {"none",      "erase",        "incise",       "finish",     "pause",      "resume",
                                 "view_ap",   "view_lateral", "view_oblique", "orbit_more", "orbit_less", "tilt_more",
                                 "tilt_less", "aspirate",     "undo",         "reset"};
constexpr int count = int(sizeof names / sizeof *names);
/// The command that comes with these buttons, if those before them did not have it.
constexpr int new_of(std::uint32_t buttons, std::uint32_t before) {
  const int command = belt_button::command(buttons);
  return command == belt_button::command(before) ? none : command;
}
/// An answer to a question of a lesson: the choice of that number to the question of that number.
constexpr int answer(int question, int choice) { return 0x80 | question << 3 | choice; }
constexpr bool is_answer(int command) { return (command & 0x80) != 0; }
constexpr int question_of(int answer) { return answer >> 3 & 0xf; }
constexpr int choice_of(int answer) { return answer & 7; }
constexpr bool is_known(int command) {
  return command >= 0 && (command < count || (command <= 0xff && is_answer(command)));
}
constexpr bool takes_back(int command) { return command == undo || command == reset; }
}  // namespace belt_command

/// Which tool of a belt is in the hand, whether a pause holds, and whether the hand waits for a pose outside of every
/// shape: the rules of ToolBelt, for the belt itself and for what follows it by its frames.
class BeltRules {
 public:
  /// `tools`: 0 in a session with one tool, which has no belt and waits for nothing.
  explicit BeltRules(std::size_t tools) : tools_(int(tools)), waiting_(tools > 0) {}

  /// Begins a tick; true where the tool in hand has changed. `free`: nothing was touched, and the tool was in nothing,
  /// after the tick before. `still_waits()`: whether a hand that waits goes on waiting; `in_shape()`: whether the pose
  /// lies in a shape. Both are called only where that counts.
  template <class StillWaits, class InShape>
  bool begin(std::uint32_t buttons, bool free, const StillWaits& still_waits, const InShape& in_shape) {
    const int command = new_command(buttons);
    if (obeys_) {
      paused_ = others_pause_;
      waiting_ = waiting_ || others_back_;
    } else {
      if (command == belt_command::resume) paused_ = false;
      if (command == belt_command::pause && free) paused_ = true;
    }
    // A hand that begins, or comes again, does so outside of every shape: no tissue would have held it on its way in.
    if (paused_ || (buttons & haptic_button::lifted))
      waiting_ = true;
    else if (waiting_)
      waiting_ = still_waits();
    // A number that no tool has changes nothing.
    const int asked = belt_button::tool(buttons), to = asked < tools_ ? asked : std::max(0, in_hand_);
    if (to == in_hand_) return false;
    const bool anywhere = idle() || in_hand_ < 0;  // nothing is felt, and the tool may be anywhere
    if (!anywhere && (!free || in_shape())) return false;
    in_hand_ = to;
    return true;
  }
  /// Ends it. `works`: no fault holds; `can_cut`: there is a drill, whose cuts can be taken back.
  void end(std::uint32_t buttons, bool works, bool can_cut) {
    const bool back = belt_command::takes_back(new_command(buttons)) && !(buttons & belt_button::pedal);
    takes_back_ = back && works && !idle() && can_cut && !obeys_;
    if (takes_back_) waiting_ = true;
    buttons_ = buttons;
  }

  /// Before begin(), in each tick of another hand: whether a pause of the hand whose commands count holds, and whether
  /// what that one cut is taken back from now on. Commands with the buttons then do nothing.
  void obey(bool paused, bool takes_back) { obeys_ = true, others_pause_ = paused, others_back_ = takes_back; }

  /// Between begin() and end(): the command that comes with this tick, whether or not it does something.
  int new_command(std::uint32_t buttons) const { return belt_command::new_of(buttons, buttons_); }
  int in_hand() const { return in_hand_; }  ///< -1 before the first tick
  bool paused() const { return paused_; }
  bool takes_back() const { return takes_back_; }    ///< after end(): the tick's command was to, and may
  bool idle() const { return paused_ || waiting_; }  ///< nothing is felt, cut or marked

 private:
  int tools_, in_hand_ = -1;
  bool waiting_, paused_ = false;
  bool obeys_ = false, others_pause_ = false, others_back_ = false, takes_back_ = false;
  std::uint32_t buttons_ = 0;
};

}  // namespace trephine::haptics
