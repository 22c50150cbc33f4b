// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/pi.h"

namespace trephine {
constexpr double degree = pi / 180;  ///< in radians
}  // namespace trephine
