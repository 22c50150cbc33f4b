// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::print {

struct WallMeasure {
  double up_to_mm = 10;     ///< no more is looked for
  double touch_mm = 0.2;    ///< a ball that comes so near to a place counts as touching it
  double from_z_mm = -1e3;  ///< corners below do not count
};
/// The smallest wall of a part: of each corner of its surface, the diameter of the largest ball within the part that
/// touches it; the least of these. It is that of outer edges too, which are as sharp as the ball is small. Each ball
/// was looked for by climbing from the corner inwards, so that a wall is never said to be wider than a ball that was
/// found.
double smallest_wall_mm(const surface::TriMesh& mesh, const WallMeasure& how, const Progress& progress = {});

/// The least distance between two surfaces from the corners of each to the other; below 0 where a corner lies within
/// the other part. `far_mm` where they are farther apart.
double smallest_gap_mm(const surface::TriMesh& a, const surface::TriMesh& b, double far_mm,
                       const Progress& progress = {});

}  // namespace trephine::print
