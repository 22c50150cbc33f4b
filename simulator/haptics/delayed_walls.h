// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/device_port.h"
#include "haptics/feel.h"

namespace trephine::haptics {

/// The shares of stiffness, of drag, and of FreeParams' guide and viscosity that can be felt through a device with a
/// delay.
struct DelayedWalls {
  double stiffness_ratio = 1, drag_ratio = 1, free_ratio = 1;
};

/// What is felt behind a delay must not give the hand energy that the device's own damping b cannot take. A wall of
/// stiffness K and damping B gives none where K (T / 2 + delay) + B <= b, T being a tick: the bound of [Colgate1994]
/// for a sampled wall, with the delay added to the half tick by which a sampled force is late. Of b a fifth is kept, so
/// that a motion in the wall also dies away. One ratio for all shapes, so that what is harder remains harder; the
/// delayed drag of tissue may have a quarter of b, and so may guide and viscosity. All are 1 without a delay, and where
/// the device's damping is not known.
DelayedWalls walls_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz);
/// `feels` and `free` with those ratios: of these a session and its replay are made.
Feels feels_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz);
FreeParams free_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz);

}  // namespace trephine::haptics
