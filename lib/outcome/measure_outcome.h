// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "cases/load_case.h"
#include "grid/grid.h"
#include "lesson/outcome_record.h"
#include "print/print_record.h"

namespace trephine::outcome {

struct OutcomeParams {
  double doubtful_residual_mm = 0.3, largest_residual_mm = 0.5;
  double doubtful_scale_ratio = 0.008, largest_scale_ratio = 0.02;
  double mirrored_ratio = 1.3, level_ratio = 1.3, least_matched_ratio = 0.7, least_overlap_ratio = 0.3;
  double doubtful_marks_mm = 0.4, largest_marks_mm = 0.8;
  template <class V>
  static void describe(V& v) {
    using P = OutcomeParams;
    v.number(&P::doubtful_residual_mm, "doubtful_residual_mm", Range{0.05, 2},
             "Bone that lies farther off on the average makes the scan doubtful.");
    v.number(&P::largest_residual_mm, "largest_residual_mm", Range{0.05, 2}, "And farther than this, it is refused.");
    v.number(&P::doubtful_scale_ratio, "doubtful_scale_ratio", Range{0, 0.2},
             "A scan that would stretch by more along an axis is doubtful.");
    v.number(&P::largest_scale_ratio, "largest_scale_ratio", Range{0, 0.2}, "And by more than this, it is refused.");
    v.number(&P::mirrored_ratio, "mirrored_ratio", Range{1, 10},
             "The mirrored case must lie so many times worse, or the scan may be mirrored: doubtful; where it lies "
             "better by as much, refused.");
    v.number(&P::level_ratio, "level_ratio", Range{1, 10},
             "Vertebrae that are shifted by a level must lie so many times worse, or the level is doubtful.");
    v.number(&P::least_matched_ratio, "least_matched_ratio", Range{0, 1},
             "Share of the bone in the scan that must have an edge of bone within 2 mm.");
    v.number(&P::least_overlap_ratio, "least_overlap_ratio", Range{0.2, 1},
             "Share of the case's bone that must lie in the scan.");
    v.number(&P::doubtful_marks_mm, "doubtful_marks_mm", Range{0.05, 5},
             "Marks of a print that lie farther off on the average make the scan doubtful.");
    v.number(&P::largest_marks_mm, "largest_marks_mm", Range{0.05, 5}, "And farther than this, it is refused.");
  }
  std::string fault() const {
    return doubtful_residual_mm > largest_residual_mm   ? "doubtful_residual_mm: is above largest_residual_mm"
           : doubtful_marks_mm > largest_marks_mm       ? "doubtful_marks_mm: is above largest_marks_mm"
           : doubtful_scale_ratio > largest_scale_ratio ? "doubtful_scale_ratio: is above largest_scale_ratio"
                                                        : "";
  }
};

/// Lays a scan after a procedure on the case by its bone, or by the marks of a print of it where that is given, and
/// measures what was put in and drilled: in a head catheters and burr holes, in a spine pedicle screws, in a chest
/// central lines. The record lacks the hashes and the program's name. The same bytes whatever the thread count. Throws
/// Error 65 where the case has neither skull and brain, nor bone with pedicles, nor clavicles to be felt, or the print
/// is another case's by name; 80 where the scan shows another head, a mirrored one, or too little of it; Cancelled.
lesson::OutcomeRecord measure_outcome(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                      const OutcomeParams& params, const Progress& progress = {},
                                      const print::PrintRecord* print = nullptr);

}  // namespace trephine::outcome
