// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
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
    v.text(
         &P::file, "file",
         "Labels to read: .nrrd, .seg.nrrd, .nii, .nii.gz, .mha, .mnc, .gipl, .vtk, a DICOM SEG, an RT structure set.")
        .names("file");
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

struct LabelResult {
  std::string label;  ///< its name
  std::string format;
  std::size_t label_voxels_count = 0;
  double label_ml = 0;
  double outside_ratio = 0, air_ratio = 0;  ///< shares of the label outside of the volume, and in air
  bool resampled = false;
  std::optional<double> offset_max_ratio;  ///< how far its voxels lie off the volume's, in voxels; not if resampled
  std::optional<double> moved_mm;          ///< how far the surface was moved outwards, where resampled
  std::optional<double> balanced_ratio;    ///< the factor of the values inside, where a thin label kept its volume
  double volume_ml = 0;                    ///< within the surface, between voxels too
  double volume_change_ratio = 0;          ///< compared with the label's part in the volume
  template <class V>
  static void describe(V& v) {
    using P = LabelResult;
    v.text(&P::label, "label", "The label's name.");
    v.text(&P::format, "format", "The format of its file.");
    v.integer(&P::label_voxels_count, "label_voxels_count", Range{}, "Its voxels.");
    v.number(&P::label_ml, "label_ml", Range{}, "Their volume.");
    v.number(&P::outside_ratio, "outside_ratio", Range{}, "Share of it outside of the volume.");
    v.number(&P::air_ratio, "air_ratio", Range{}, "Share of it in air.");
    v.flag(&P::resampled, "resampled", "Whether its voxels are not the volume's.");
    v.number(&P::offset_max_ratio, "offset_max_ratio", "How far its voxels lie off the volume's.");
    v.number(&P::moved_mm, "moved_mm", "How far its surface was moved outwards.");
    v.number(&P::balanced_ratio, "balanced_ratio", "Factor of the values inside.");
    v.number(&P::volume_ml, "volume_ml", Range{}, "Volume within the surface.");
    v.number(&P::volume_change_ratio, "volume_change_ratio", Range{}, "How much that differs from the label's.");
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
/// Warns where the volume changes by more than a share of 0.02; where some of the label lies outside, or much of it in
/// air; where the label ends at its own grid's edge within the volume (cut off there); and of anything suspicious in
/// the file itself.
///
/// Throws Error 80 where the label is empty, lies outside of the volume or in air by more than is allowed (saying
/// whether it would fit with x and y negated, because RAS was taken for LPS or the reverse), or nothing of it is left;
/// 65 where the volume's voxels are not finite; Cancelled. The result has the same bits whatever the thread count.
Outcome<grid::Field, LabelResult> label_field(const grid::HuVolume& volume, const grid::LabelFile& map,
                                              const LabelParams& params, const Progress& progress = {});

}  // namespace trephine::segmentation
