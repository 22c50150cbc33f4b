// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "picture/image.h"

namespace trephine::picture {

/// A line's colour for each surface, for lines on a grey slice: of a palette that people with any of the usual colour
/// vision deficiencies tell apart (Okabe and Ito, "Color Universal Design", 2008; on a dark ground white and violet
/// stand in place of black, and blue is lighter). Each surface gets the free colour that is nearest to its own hue, in
/// the order of the list, so that the same list gives the same colours; the palette has nine, and begins anew after
/// that.
std::vector<Rgb> line_colours(const std::vector<Rgb>& surfaces);

}  // namespace trephine::picture
