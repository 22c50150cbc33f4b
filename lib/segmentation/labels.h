// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "grid/labels.h"

namespace trephine::segmentation {

struct LabelParams {
  std::string file, label;
  double smooth_mm = 0;
  double max_outside_ratio = 0.5;
  double max_air_ratio = 0.5;

  template <class V>
  static void describe(V& v) {
    using P = LabelParams;
    v.text(&P::file, "file", "Labels to read: .nrrd, .seg.nrrd, .nii, .nii.gz, .mha, .mnc, .gipl, .vtk.").names("file");
    v.text(&P::label, "label",
           "Which label to take: its value, or a segment's name or ID; several with commas between them; empty for "
           "everything that is not 0.");
    v.number(&P::smooth_mm, "smooth_mm", Range{0, 10},
             "Sigma of the Gaussian that smooths the voxels' steps; no voxel changes sides. With 0, each voxel has the "
             "mean of its own side.");
    v.number(&P::max_outside_ratio, "max_outside_ratio", Range{0, 1},
             "Refuse where more of the label than this lies outside of the volume.");
    v.number(&P::max_air_ratio, "max_air_ratio", Range{0, 1},
             "Refuse where more of the label than this lies in air (below -900 HU): a mirrored or moved frame.");
  }
};

/// A label as a field on the volume's raster, positive inside, cropped to the label and a margin where the volume has
/// room. Where the label's grid is the volume's raster (its axes may be flipped or swapped, it may cover a part, or
/// reach beyond), voxels keep their side and the surface lies within half a voxel of theirs; where smoothing would
/// change a thin label's volume by more than 0.02, it is moved between the voxels to keep it. Otherwise the mask is
/// smoothed in the same way on its own grid and becomes a signed distance in mm, which is interpolated linearly at the
/// volume's voxels (shape-based interpolation [Raya1990]) and moved by up to half a voxel of the label, so that it
/// holds as many ml as before. Parts thinner than a voxel of the volume may vanish.
///
/// Report: label (its name), format, label_voxels_count, label_ml, resampled, offset_max_ratio (how far the label's
/// voxels lie off the volume's, as a share of a voxel; not where resampled), outside_ratio (share of the label outside
/// of the volume), air_ratio, moved_mm (how far the surface was moved outwards, where resampled), balanced_ratio (the
/// factor of the values inside, where a thin label kept its volume), volume_ml (within the surface, between voxels
/// too), volume_change_ratio (compared with the label's part in the volume). Warns where that change is beyond 0.02;
/// where some of the label lies outside, or much of it in air; where the label ends at its own grid's edge within the
/// volume (cut off there); and of anything suspicious in the file itself.
///
/// Throws Error 80 where the label is empty, lies outside of the volume or in air by more than is allowed (saying
/// whether it would fit with x and y negated, because RAS was taken for LPS or the reverse), or nothing of it is left;
/// 65 where the volume's voxels are not finite; Cancelled. The result has the same bits whatever the thread count.
grid::Field label_field(const grid::HuVolume& volume, const grid::LabelFile& map, const LabelParams& params,
                        Report& report, const Progress& progress = {});

}  // namespace trephine::segmentation
