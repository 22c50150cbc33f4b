// SPDX-License-Identifier: GPL-3.0-or-later
// How a gamepad is held, by its events and, where the kernel dropped some, by what it is asked.
#include <gtest/gtest.h>

#include "device/pad_state.h"

using namespace trephine;

namespace {

// A gamepad with sticks and triggers, held as it is set.
class FakePad : public device::PadSource {
 public:
  bool axis(int code, input_absinfo& out) const override {
    if (code == ABS_GAS || code == ABS_BRAKE) return false;
    const bool trigger = code == ABS_Z || code == ABS_RZ;
    out.minimum = trigger ? 0 : -32768;
    out.maximum = trigger ? 255 : 32767;
    const auto found = values.find(code);
    out.value = found == values.end() ? 0 : found->second;
    ++asked;
    return true;
  }
  bool keys(device::PadKeys& out) const override {
    out = down;
    return answers;
  }
  void press(int code) { down[std::size_t(code / 8)] = std::uint8_t(down[std::size_t(code / 8)] | 1u << (code % 8)); }
  void release() { down.fill(0); }

  std::map<int, int> values;
  device::PadKeys down{};
  bool answers = true;
  mutable int asked = 0;
};

input_event event(int type, int code, int value) {
  input_event e{};
  e.type = std::uint16_t(type);
  e.code = std::uint16_t(code);
  e.value = value;
  return e;
}

const input_event report = event(EV_SYN, SYN_REPORT, 0), dropped = event(EV_SYN, SYN_DROPPED, 0);

}  // namespace

TEST(PadState, EventsAreWhatIsPushed) {
  FakePad pad;
  pad.press(BTN_EAST);
  pad.values[ABS_RZ] = 255;
  device::PadState state(pad);
  EXPECT_EQ(state.push().buttons, 2u) << "it was held down at the start";
  EXPECT_EQ(state.push().ahead, 1);
  const int asked = pad.asked;
  for (const input_event& e : {event(EV_KEY, BTN_SOUTH, 1), event(EV_KEY, BTN_EAST, 0), event(EV_ABS, ABS_X, 32767),
                               event(EV_ABS, ABS_RZ, 0), event(EV_KEY, BTN_TL2, 1), report})
    state.take(e);
  EXPECT_EQ(state.push().buttons, 1u);
  EXPECT_EQ(state.push().move.x, 1);
  EXPECT_EQ(state.push().ahead, -1);
  EXPECT_EQ(pad.asked, asked) << "events say it all";
}

// The pedal was released and the stick let go in what was dropped. What is left of it, up to the report, is a part of a
// movement that nobody knows; what comes after it counts again.
TEST(PadState, AfterDroppedEventsTheGamepadIsAsked) {
  FakePad pad;
  device::PadState state(pad);
  for (const input_event& e : {event(EV_KEY, BTN_SOUTH, 1), event(EV_ABS, ABS_X, 32767), report}) state.take(e);
  ASSERT_EQ(state.push().buttons, 1u);
  pad.press(BTN_WEST);
  pad.values[ABS_Y] = -32768;
  state.take(dropped);
  for (const input_event& e : {event(EV_KEY, BTN_NORTH, 1), event(EV_ABS, ABS_X, -32768)}) state.take(e);
  EXPECT_EQ(state.push().buttons, 1u) << "nothing is known until the report";
  EXPECT_EQ(state.push().move.x, 1);
  state.take(report);
  EXPECT_EQ(state.push().buttons, 4u) << "BTN_WEST alone: BTN_SOUTH was released, BTN_NORTH too";
  EXPECT_NEAR(state.push().move.x, 0, 1e-4);
  EXPECT_EQ(state.push().move.y, 1);
  for (const input_event& e : {event(EV_KEY, BTN_SOUTH, 1), report}) state.take(e);
  EXPECT_EQ(state.push().buttons, 5u);
}

TEST(PadState, WhereNobodyKnowsNothingIsPressed) {
  FakePad pad;
  pad.press(BTN_SOUTH);
  device::PadState state(pad);
  ASSERT_EQ(state.push().buttons, 1u);
  pad.answers = false;
  state.take(dropped);
  state.take(report);
  EXPECT_EQ(state.push().buttons, 0u);
}
