// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "device/hand_path.h"
#include "device/simulated_hand.h"
#include "haptics/frame.h"
#include "haptics/recording.h"
#include "peers/contact_algorithm.h"
#include "session/force_figures.h"

namespace trephine::peers {

/// Servo loop and pictures of an experiment.
constexpr double tick_s = 0.001;
constexpr int ticks_a_picture = 17;  // 59 Hz
/// What a device gives at most; the same for all algorithms, for what the hand feels and for what is judged.
constexpr double device_most_n = 3.3;

/// CPU time of a tick, of the calling thread, in us, without that of reading the clock.
struct TickTimes {
  double mean_us = 0, median_us = 0, p99_us = 0, most_us = 0;
  double touching_ratio = 0;      ///< ticks in contact
  std::vector<double> sorted_us;  ///< all of them, ascending
};
/// Moves the device along the path's loop, `mm_a_tick` a tick, and measures each tick after the first two pictures' and
/// what comes before the first contact.
TickTimes measure_ticks(ContactAlgorithm& algorithm, const device::HandPath& path, double mm_a_tick, int ticks);

/// CPU time of the calling thread that the client's part takes, in ms, mean of `pictures` along the path.
double measure_client_ms(ContactAlgorithm& algorithm, const device::HandPath& path, double mm_a_tick, int pictures);

/// A hand of the closed loop: each number gives another one, always the same. 0 is a hand of average habits.
struct VariedHand {
  device::HandParams hand;
  device::HandPathParams path;
};
VariedHand varied_hand(int number, const device::HandPathParams& path);

/// The hand follows its target over the surface, and feels the force: as a session without a clock records it.
std::vector<haptics::ServoFrame> run_closed(ContactAlgorithm& algorithm, const device::HandParams& hand,
                                            const device::HandPath& path, double seconds);
/// The poses of a recording, whatever the force.
std::vector<haptics::ServoFrame> run_open(ContactAlgorithm& algorithm, const std::vector<haptics::ServoFrame>& poses);

/// How good forces are: the dissertation's coefficient beside what it leaves out.
struct RunFigures {
  session::ForceFigures force;
  double fallen_ratio = 0;  ///< of the judged frames: without force, deeper than fall_mm within the shape
  int falls = 0;            ///< times that such frames began
};
/// A device that is deeper than this within the shape and feels nothing has fallen through.
constexpr double fall_mm = 0.5;
/// Judges the frames from half a second after the first contact (session::force_window), without any contact the second
/// half. `truth` is the felt surface
/// in full, `contact` says what is inside.
RunFigures judge(const std::vector<haptics::ServoFrame>& frames, const PeerScene& truth);

}  // namespace trephine::peers
