// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace trephine {

/// Whether a text is of a shape: A stands for a capital, a for a small letter or none, 9 for a digit, 8 for a digit or
/// none, all else for itself. "Aa99a" is the shape of B30f and of Hr38s.
bool has_shape(std::string_view text, std::string_view shape);

}  // namespace trephine
