// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/hu_view.h"

namespace trephine::trunk {

struct CanalParams {
  double max_radius_mm = 18;
  double min_enclosure_ratio = 0.5;
  double min_length_mm = 30;
  double min_walled_ratio = 0.35;
  double gap_mm = 0;

  template <class V>
  static void describe(V& v) {
    using P = CanalParams;
    v.number(&P::max_radius_mm, "max_radius_mm", Range{5, 40},
             "Bone farther than this from the middle of the canal does not count as its wall.");
    v.number(&P::min_enclosure_ratio, "min_enclosure_ratio", Range{0.2, 0.9},
             "The canal continues as long as bone encloses it, within the slice, in more than this share of "
             "directions. Where the share is less for a few slices (discs), the slices above and below count.");
    v.number(&P::min_length_mm, "min_length_mm", Range{5, 1000}, "A shorter canal is refused.");
    v.number(
        &P::min_walled_ratio, "min_walled_ratio", Range{0, 1},
        "A canal with a smaller share of bone in its wall than this is refused, because the rest is interpolated.");
    v.number(&P::gap_mm, "gap_mm", Range{0, 5}, "Distance that the canal keeps from bone.");
  }
};

struct CanalResult {
  double length_mm = 0;
  mask::MaskSize size;
  double area_median_mm2 = 0;
  double area_least_mm2 = 0, area_least_z_mm = 0;  ///< over slices in which half of the wall is bone; 0: there are none
  double walled_ratio = 0;
  double tissue_hu = 0;
  template <class V>
  static void describe(V& v) {
    using P = CanalResult;
    v.number(&P::length_mm, "length_mm", Range{}, "Length.");
    v.all_of(&P::size);
    v.number(&P::area_median_mm2, "area_median_mm2", Range{}, "Median area of its cross-sections.");
    v.number(&P::area_least_mm2, "area_least_mm2", Range{}, "The least area.");
    v.number(&P::area_least_z_mm, "area_least_z_mm", Range{}, "Where that is.");
    v.number(&P::walled_ratio, "walled_ratio", Range{}, "Share of its wall that is bone.");
    v.number(&P::tissue_hu, "tissue_hu", Range{}, "What it holds.");
  }
};

/// The spinal canal: the space that the arches of the vertebrae enclose. The spine must be in axial slices, and its
/// canal must lean by less than about 55 degrees from their normal. `bone` is the filled bone (positive inside) on the
/// volume's raster or a part of it. Returns a field in mm, positive inside, on a part of that raster, as segment()
/// does.
///
/// - Its course is the tube through the bone that is best enclosed: the chain of points, one for each slice on a raster
///   of about 1.5 mm, with the largest sum of enclosure beyond min_enclosure_ratio (dynamic programming). The ends are
///   free.
/// - Its wall is, in each slice and direction from the course, the bone's own surface. Where bone is missing (foramina,
///   discs, between the arches) or the ray escapes (it hits far behind its neighbours), the wall is the smoothest one
///   through the bone around the gap (a membrane over angle and length).
///
/// The result is not the dural sac (epidural fat belongs to the canal), and a disc that bulges into it is not seen,
/// because discs are not bone. Cross-sections must be star-shaped about their centre. The longest such tube is taken:
/// one canal in each scan.
///
/// Warns where area or content are not
/// those of a canal. The result has the same bits whatever the thread count. Throws Error 65 where a raster differs; 80
/// where the bone is empty, no such space is found, it is shorter or less walled than required, or holds air;
/// Cancelled.
Outcome<grid::Field, CanalResult> find_canal(const grid::HuVolume& volume, const grid::Field& bone,
                                             const CanalParams& params, const Progress& progress = {});

}  // namespace trephine::trunk
