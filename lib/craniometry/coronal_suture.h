// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The coronal suture, as it shows in the outer table of the calvaria.
#include <functional>
#include <optional>

#include "base/vec3.h"
#include "grid/grid.h"

namespace trephine::craniometry {

/// Where the suture is looked for: parallel planes to both sides of the midsagittal one, swept from `front` to `up`
/// about axes through the centre, which lies inside the skull between nasion and inion. Unit vectors at right angles.
struct CalvariaFrame {
  Vec3 centre_mm, front, up, left;
  Vec3 nasion_mm;  ///< lengths over the bone are counted from its level
};

/// Where a ray (from, unit direction, length in mm) first meets the bone.
using BoneRay = std::function<std::optional<Vec3>(Vec3 from_mm, Vec3 direction, double length_mm)>;

struct CoronalSuture {
  Vec3 bregma_mm;                 ///< on the outer table, in the midsagittal plane
  double confidence = 0;          ///< 0 to 1; from 0.5 on the line is seen
  double arc_mm = 0;              ///< from the nasion's level to the bregma over the bone of the midline
  double visible_ratio = 0;       ///< share of the planes in which something is seen where the line runs
  double near_midline_ratio = 0;  ///< the same of the planes within 12 mm of the midline
  double distinct_ratio = 0;      ///< how much clearer the line is than the clearest other one
  double halves_apart_mm = 0;     ///< distance of the places at which its left and right half would cross the midline
};

/// Unrolls the outer 3 mm of the calvaria within 40 mm of the midline, and again its outer 6.5 mm, in which a suture
/// that has grown together outside may still show. In each it looks, 85 to 175 mm from the nasion, for the one line
/// from side to side that stands out most, and takes the clearer one; where both are clear and more than 8 mm apart,
/// its confidence stays below 0.5. An open suture is a dark cleft, one that grew together a dense ridge of some 5 mm,
/// and many are a dark cleft between dense margins: what is darker than 3 mm in front and behind, and what is denser
/// than 8 mm in front and behind, both count, as a share of the bone around. The rings that thick slices leave on a
/// vault are taken off first: they are alike wherever the bone crosses the slices alike. The line is the best of all
/// that run from plane to plane by at most a millimetre (dynamic programming). It crosses the midline where a straight
/// line through what is seen of it near there does, for at the midline itself many have grown together. A suture runs
/// obliquely through the vault: the bregma is that of the outer 3 mm where these show enough of it.
///
/// The two halves are independent of each other: where they would cross the midline more than 10 mm apart, the
/// confidence stays below 0.5. It is 1 where the line shows in 70 % of the planes and is twice as clear as any other
/// that lies 8 mm or more away, and falls to 0 at 40 % and 1.2. Empty where there is no bone along the midline.
/// May fail: a saw cut from side to side looks like a suture. The same bits whatever the thread count.
std::optional<CoronalSuture> find_coronal_suture(const grid::HuVolume& volume, const CalvariaFrame& frame,
                                                 const BoneRay& bone);

}  // namespace trephine::craniometry
