// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine::haptics {

/// What a hand can do with a tool, by its mean over hand_window_s: a fast reach has about 2 m/s and 50 m/s2. What is
/// above is no hand's: the device jumped (DevicePort), and a lesson is not judged (lessons/hand_limits.h).
constexpr double max_hand_m_per_s = 4, max_hand_m_per_s2 = 150, hand_window_s = 0.02;

}  // namespace trephine::haptics
