// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "grid/labels.h"

namespace trephine::segmentation {

/// A correction by hand: what a person changed of a shape, and nothing else. It is kept as a map of labels on the
/// voxels that changed, added (1) and removed (2), and not as the shape: so it survives another run, whose shape may
/// differ.

/// How much was changed.
struct CorrectionCounts {
  std::size_t added_voxels_count = 0, removed_voxels_count = 0;
  double added_ml = 0, removed_ml = 0;
  template <class V>
  static void describe(V& v) {
    using P = CorrectionCounts;
    v.integer(&P::added_voxels_count, "added_voxels_count", Range{}, "Voxels that were added.");
    v.integer(&P::removed_voxels_count, "removed_voxels_count", Range{}, "Voxels that were removed.");
    v.number(&P::added_ml, "added_ml", Range{}, "Volume of those that were added.");
    v.number(&P::removed_ml, "removed_ml", Range{}, "Volume of those that were removed.");
  }
};

/// What lies between two maps of labels, one as it was exported, and one as it came back. The label is picked of both
/// as pick_label does; `painted_label` is its name in the second, where that lost the names. The second map may cover
/// less or more of the same raster, in any order of its axes. Throws Error 65: the voxels of the second do not lie on
/// the first's; nothing is different; and as pick_label does, naming `before` or `after`.
Outcome<grid::LabelFile, CorrectionCounts> correction_between(const grid::LabelFile& before,
                                                              const grid::LabelFile& after, const std::string& label,
                                                              const std::string& painted_label);

/// The correction whose voxels hold 1 where they are added, 2 where they are removed, 0 elsewhere.
grid::LabelFile correction_of(grid::Mask voxels);

struct CorrectParams {
  std::string file;
  template <class V>
  static void describe(V& v) {
    v.text(&CorrectParams::file, "file",
           "The correction, as trephine correction writes it, or a list of edits by hand (.json).")
        .names("file");
  }
};

struct CorrectedResult {
  CorrectionCounts changed;
  double already_ratio = 0;  ///< the share of the correction that held before it
  bool resampled = false;
  template <class V>
  static void describe(V& v) {
    using P = CorrectedResult;
    v.all_of(&P::changed);
    v.number(&P::already_ratio, "already_ratio", Range{}, "Share of the correction that held without it.");
    v.flag(&P::resampled, "resampled", "Whether it was made on another raster.");
  }
};

/// The field with the correction: voxels that were added are positive, those that were removed negative. Within about
/// two voxels of a voxel that changed, the field follows the new mask, smoothed, at the scale of the field beside its
/// surface; everywhere else it keeps its values bit for bit. On another raster than the correction's, each voxel takes
/// what its nearest one says. The field grows where voxels are added beyond it, but not beyond the volume.
///
/// Warns where the correction was made on another raster, where more than half of it held
/// already (another segmentation, or another scan), and of voxels beyond the volume. Throws Error 65 for a map that is
/// no correction, or of which nothing lies in the volume, and for a field that is not finite; Cancelled.
Outcome<grid::Field, CorrectedResult> corrected(const grid::Field& field, const grid::Lattice& volume,
                                                const grid::LabelFile& correction, const Progress& progress = {});

}  // namespace trephine::segmentation
