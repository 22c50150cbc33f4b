// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// How much of the shape's rim, seen within the slices, is no surface of a body but the edge of what was scanned:
/// within 2 mm outwards lies the volume's side, a value below -1100 HU (padding that no tag declares), or the circle
/// that just fits into the slices (where scanners end the reconstructed field). By area, 0 to 1; the volume's first and
/// last slice do not count, for every scan cuts the body there.
double scan_edge_ratio(const HuView& hu, const Field& field);

}  // namespace trephine::segmentation
