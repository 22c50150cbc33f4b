// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>
#include <vector>

#include "cases/case.h"

namespace trephine::cases {

/// Reads points that a person placed, from 3D Slicer's markups JSON (.mrk.json; coordinateSystem LPS or RAS,
/// orientation ignored, controlPoints by label, without those that are "undefined" or "preview") or its older table
/// (.fcsv; "# CoordinateSystem = RAS | LPS | 0 | 1", where 0 means RAS in files before 4.10). The source is "given" and
/// the confidence 1; labels become lower case, with underscores for blanks and hyphens. Throws Error 65 naming the
/// field: no point, a name twice with different positions, a number that is not finite or beyond 1e5 mm, an unknown
/// coordinate system or unit.
std::vector<CaseLandmark> parse_slicer_markups(std::string_view text);
std::vector<CaseLandmark> parse_slicer_fcsv(std::string_view text);

}  // namespace trephine::cases
