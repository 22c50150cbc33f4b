// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"
#include "head/head_landmarks.h"

namespace trephine {

struct LandmarkParams {
  double along_mm = 110;
  double lateral_mm = 27.5;
  double bregma_mm = 125;

  template <class V>
  static void describe(V& v) {
    using P = LandmarkParams;
    v.number(&P::along_mm, "along_mm", Range{10, 250},
             "Kocher's points: so far from the nasion, over the midline of the skin.");
    v.number(&P::lateral_mm, "lateral_mm", Range{0, 100}, "Kocher's points: and so far to the side, over the skin.");
    v.number(&P::bregma_mm, "bregma_mm", Range{80, 180},
             "The coronal suture is taken to cross the midline so far from the nasion, over the skin.");
  }
};

/// What the landmarks are found from: fields (positive inside) on the volume's raster, maybe only a part of it.
struct LandmarkInputs {
  const Field* skin = nullptr;        ///< required
  const Field* skull = nullptr;       ///< required
  const Field* brain = nullptr;       ///< may be null
  const Field* ventricles = nullptr;  ///< may be null: then no foramina of Monro
  std::vector<CaseLandmark> given;    ///< what a person says: it wins, and what hangs on it is measured from it
};

/// The landmarks of a head that lies straight to about 20 degrees (LPS axes), whole or cut. docs/landmarks.md says how
/// each is found and what its confidence (0 to 1) is computed from: 0.5 and more is to be relied on.
///
/// midsagittal plane  mirror symmetry of skull and skin, then of the midline's own structures; from nasion, inion (or
///                    vertex) and tragi where those are given
/// nasion             the point of greatest concavity of the midline skin between brow and nose
/// inion              over the point of the occiput that stands out most in the midline
/// tragus_left, _right  the rim in front of the concha
/// vertex             the highest midline skin, with the line from the tragi to the nasion rising by 20 degrees
/// bregma             `bregma_mm` from the nasion over the skin; source "estimated"
/// kocher_left, _right  `along_mm` from the nasion over the midline of the skin, `lateral_mm` to the side; as
///                    place_burr_hole measures them, to about 0.3 mm
/// monro_left, _right narrowest place between the lateral ventricle and the third
///
/// What lies outside the scan, or is not there to be seen (no face), is left out and said in the report's warnings;
/// nothing is invented. Given landmarks are in the result as they are, with a warning for a name that is not looked for
/// (and the one that it is nearly). The report: symmetry_residual_mm and, for each
/// landmark, its position and confidence. The same bits whatever the thread count. Safe to call from several threads.
/// Throws Error 64 without skin or skull; 65 where a field is of another raster or a given landmark is not finite,
/// there twice or more than 30 mm outside of the skin; 80 where the volume is of one value, there is no skull, or none
/// that is symmetric, and the plane is not given; Cancelled.
HeadLandmarks find_landmarks(const HuVolume& volume, const LandmarkInputs& inputs, const LandmarkParams& params,
                             Report& report, const Progress& progress = {});

/// `found` with those of `given` in the place of the like-named ones, and the others after them. The plane and Kocher's
/// points stay what they were: find_landmarks with `given` measures them anew.
HeadLandmarks merged(const HeadLandmarks& found, const std::vector<CaseLandmark>& given);

}  // namespace trephine
