// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

enum class T1Bright { grey, white };

struct T1ContrastParams {
  T1Bright bright = T1Bright::grey;
  int bias_degree_count = 3;

  template <class V>
  static void describe(V& v) {
    using P = T1ContrastParams;
    v.choice(&P::bright, "bright", {{"grey", T1Bright::grey}, {"white", T1Bright::white}},
             "Which tissue becomes 30 HU. grey: all that is as bright as cortex or brighter, for the brain, which ends "
             "in cortex; white: white matter, for the ventricles, which mostly lie in it.");
    v.integer(&P::bias_degree_count, "bias_degree_count", Range{0, 4},
              "Degree of the polynomial in space that the coil's brightness is taken for; 0: the scan has no bias.");
  }
};

struct T1ContrastResult {
  std::optional<double> cranial_cavity_ml;  ///< where it was looked for
  double csf_share_ratio = 0, grey_share_ratio = 0, white_share_ratio = 0;
  double csf_to_grey_ratio = 0, grey_to_white_ratio = 0;
  double bias_ratio = 0;  ///< half of what the coil's brightness varies by over the cavity
  template <class V>
  static void describe(V& v) {
    using P = T1ContrastResult;
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", "Volume of the cranial cavity.");
    v.number(&P::csf_share_ratio, "csf_share_ratio", Range{}, "Share of CSF in the cavity.");
    v.number(&P::grey_share_ratio, "grey_share_ratio", Range{}, "Share of grey matter.");
    v.number(&P::white_share_ratio, "white_share_ratio", Range{}, "Share of white matter.");
    v.number(&P::csf_to_grey_ratio, "csf_to_grey_ratio", Range{}, "Brightness of CSF, of grey matter's.");
    v.number(&P::grey_to_white_ratio, "grey_to_white_ratio", Range{}, "Brightness of grey matter, of white matter's.");
    v.number(&P::bias_ratio, "bias_ratio", Range{}, "How much the coil's brightness varies.");
  }
};

/// A T1-weighted MR in the cranial cavity as if it were a CT, so that stages made for CT read it: CSF at 8 HU and the
/// tissue of `bright` at 30, in proportion between them and up to 40 above them; outside of `cavity` the CT's values.
/// Both volumes lie on the same voxels.
///
/// Levels of CSF, grey and white matter and the coil's bias field are estimated together: a mixture of three Gaussians
/// of the logarithm, by expectation maximization, and a polynomial fitted to what the mixture leaves [VanLeemput1999].
/// The levels are then the medians of places whose neighbours 1.5 mm off are of the same class.
///
/// Throws Error 65 where the volumes are on different
/// voxels or hold one that is not finite; 80 where more than 2 % of the cavity lies outside of the MR, and where the
/// contrast is not that of T1 (the darkest class is not what lies around the brain, or levels are too near to each
/// other). The same bits whatever the thread count.
Outcome<grid::HuVolume, T1ContrastResult> t1_contrast(const grid::HuVolume& mr, const grid::HuVolume& ct,
                                                      const mask::BitMask& cavity, const T1ContrastParams& params,
                                                      const Progress& progress = {});

}  // namespace trephine::segmentation
