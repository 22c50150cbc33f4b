// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The plane about which a head is most symmetric.
#include "base/progress.h"
#include "craniometry/skin_arc.h"

namespace trephine::craniometry {

struct MirrorPlane {
  Vec3 point_mm;           ///< the point of the plane nearest to the skull's middle
  Vec3 normal{1, 0, 0};    ///< unit, to the patient's left
  double residual_mm = 0;  ///< median distance of a mirrored surface point from the surface, over the whole head
  double midline_mm = 0;   ///< the same within 35 mm of the plane
  double matched = 0;      ///< share of the mirrored points in the scan that fit the surface to 4 mm
  double scanned = 0;      ///< share of the mirrored points that lie in the scan
  double rise_mm = 0;  ///< least rise of the mean residual where the plane is turned by 6 degrees or moved by 8 mm: 0
                       ///< where no plane is better than another (a ball)
  double confidence = 0;  ///< 0 to 1
};

/// Robust mirror registration of the surfaces of skin and skull on a raster of 2.5 mm. All planes up to 26 degrees off
/// the sagittal one (of the world's axes) are tried, and the best are refined. Then the plane is moved to where the
/// midline itself is symmetric (nose, brow, frontal crest, septum, clivus, occipital protuberance): heads are
/// asymmetric, and the plane that fits both halves best misses the nose by 3 mm. Residuals are cut off at 6 mm, so that
/// a mass, an operation or a bent nose does not pull the plane; points whose mirror image was not scanned do not count.
/// Deterministic. The confidence is 1 where the residual is at most 1 mm, 90 % match and rise_mm is at least 0.6; it
/// falls in proportion to 0 at 4 mm, 50 % and 0.1.
MirrorPlane find_mirror_plane(const FieldView& skin, const FieldView& skull, const Progress& progress = {});

}  // namespace trephine::craniometry
