// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>

#include "base/progress.h"
#include "mask/hu_view.h"

namespace trephine::segmentation {

/// The largest piece of a shape's inside that is as even as a liquid.
struct EvenCore {
  double ml = 0;  ///< 0: there is none
  double mean_hu = 0;
  Vec3 middle_mm;
};

/// Looks for blood with contrast medium in what a threshold took for bone. Bone is uneven: 2.5 mm below its surface the
/// standard deviation within 3.5 mm was at least 1.6 times the noise of soft tissue but for 0.3 ml in one place, in
/// eight scans of heads, chests and a spine (docs/validation/trunk.md); of a vessel it is the noise itself. Vessels of
/// less than some 6 mm radius have no such inside and are not found, nor is anything denser than 480 HU looked at.
///
/// `shape` lies on a part of hu's raster that begins at `begin`. The noise is measured in the whole volume;
/// nothing is returned where it cannot be, as of a scan without soft tissue or noise.
std::optional<EvenCore> even_core(const mask::BitMask& shape, const mask::HuView& hu, std::array<int, 3> begin,
                                  const Progress& progress);

}  // namespace trephine::segmentation
