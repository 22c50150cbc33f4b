// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>

namespace trephine {

/// Light from 0 to 1 of a value of sRGB, and back (IEC 61966-2-1).
inline double linear_of_srgb(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }
inline double srgb_of_linear(double v) { return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

}  // namespace trephine
