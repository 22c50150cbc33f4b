// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "pacs/slices.h"

namespace trephine::pacs {

/// A closed line on a slice: mm along its rows (x) and columns (y) from its first voxel's middle. The last point joins
/// the first. Seen with x to the right and y downwards, as a slice is shown, the inside of the surface is on its right.
struct PlanePoint {
  double x = 0, y = 0;
};
using PlaneLine = std::vector<PlanePoint>;

/// Where a closed surface meets the plane of a slice; exactly, in doubles. A corner on the plane counts as above it, so
/// that lines are closed whatever the surface does there. The lines' order and first points follow from the surface
/// alone.
std::vector<PlaneLine> contours_on(const surface::TriMesh& mesh, const SliceSet& slices, std::size_t slice);

double signed_area_mm2(const PlaneLine& line);
/// Whether the point lies within, by parity.
bool is_within(const PlaneLine& line, PlanePoint p);

/// Each line that lies within another one, an odd number of times, is cut out of the innermost that holds it by a
/// keyhole: a bridge of no width that is walked twice, between their nearest points. Lines within those are lines
/// again.
std::vector<PlaneLine> with_keyholes(std::vector<PlaneLine> lines);

/// Pixels whose middles lie within an odd number of the lines; bridges count for nothing. One byte a pixel.
std::vector<std::uint8_t> filled(const std::vector<PlaneLine>& lines, int columns, int rows, double dx_mm,
                                 double dy_mm);

}  // namespace trephine::pacs
