// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// The share of the shape's rim, seen within the slices, that is not the surface of a body but the edge of the scanned
/// field: within 2 mm outwards lies the volume's side, a value below -1100 HU (padding that no tag declares), or the
/// largest circle that fits into the slices (where scanners end the reconstructed field). It is a share of area, 0 to
/// 1. The volume's first and last slice do not count, because every scan cuts the body there.
/// Where in a body the field ends is told by mask/field_edge.h, from the values alone.
double scan_edge_ratio(const mask::HuView& hu, const grid::Field& field);

}  // namespace trephine::segmentation
