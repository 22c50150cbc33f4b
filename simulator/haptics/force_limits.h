// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/feel.h"
#include "haptics/haptic_state.h"

namespace trephine::haptics {

/// What a device may be asked for after it was `sent` something: neither the force nor the torque changes by more than
/// the rates of the limits allow in one period, however long the frame was. After a stall the device holds less than it
/// was sent (device::ForceHold). A torque is also limited in size; what is not finite becomes zero.
Vec3 limited_force(const ForceParams& limits, Vec3 force_n, Vec3 sent_n, const HapticInput& in);
Vec3 limited_torque(const ForceParams& limits, Vec3 torque_n_mm, Vec3 sent_n_mm, const HapticInput& in);

}  // namespace trephine::haptics
