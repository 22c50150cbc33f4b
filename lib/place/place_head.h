// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the template of a head lies in a scan.
#include "base/progress.h"
#include "base/warning.h"
#include "mask/bits.h"
#include "place/head_template.h"

namespace trephine::place {

/// Where the template lies in a scan: rotated and stretched along its axes.
struct HeadPlace {
  Vec3 centre_mm;  ///< LPS of the template's middle
  Mat3 axes;       ///< the template's axes in LPS
  Vec3 scale{1, 1, 1};
  double residual_mm = 0;  ///< median distance of the template's cavity from the scan's, over what was scanned
  double scanned = 0;      ///< share of the template's cavity that lies in the scan
  double matched = 0;      ///< share of that which fits to 6 mm
  bool sure = false;       ///< fits well enough to tell places by it

  Vec3 to_template(Vec3 lps_mm) const;
  Vec3 to_lps(Vec3 template_mm) const;
};

/// Registers the template to the cranial cavity (or to the brain with its sulci closed): rotation, shift and a scale
/// along each axis, by Gauss-Newton steps on the cavity's distance field from several starts in pitch. What fits badly
/// (an open skull, a cavity that runs on into the neck) has no weight, nor has what lies beyond `scan`. Scales are held
/// near to those of adults as far as the scan leaves them open. `fluid` (may be null) is wide CSF deep in the brain:
/// the pose also brings it near to the template's ventricles and cisterns, because the shape of the cavity alone leaves
/// the pitch open by 10 degrees. Deterministic, the same whatever the thread count. Not
/// sure where less than half of the cavity was scanned or less than 60 % of that fits to 6 mm.
HeadPlace place_head(const mask::BitMask& cavity, const mask::BitMask* fluid, const grid::Lattice& scan,
                     const Progress& progress = {});

/// What is printed of a place.
struct PlaceFigures {
  double template_residual_mm = 0, template_matched_ratio = 0, template_scanned_ratio = 0, head_pitch_deg = 0;
  template <class V>
  static void describe(V& v) {
    using P = PlaceFigures;
    v.number(&P::template_residual_mm, "template_residual_mm", Range{}, "How far the template lies from the cavity.");
    v.number(&P::template_matched_ratio, "template_matched_ratio", Range{}, "Share of what was scanned that fits.");
    v.number(&P::template_scanned_ratio, "template_scanned_ratio", Range{}, "Share of the cavity that was scanned.");
    v.number(&P::head_pitch_deg, "head_pitch_deg", Range{}, "Pitch of the head; chin down: above 0.");
  }
};
PlaceFigures figures_of(const HeadPlace& place);
/// That the template is not sure, where it is not.
Warnings warnings_of(const HeadPlace& place);

}  // namespace trephine::place
