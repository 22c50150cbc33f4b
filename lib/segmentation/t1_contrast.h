// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
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

/// A T1-weighted MR in the cranial cavity as if it were a CT, so that stages made for CT read it: CSF at 8 HU and the
/// tissue of `bright` at 30, in proportion between them and up to 40 above them; outside of `cavity` the CT's values.
/// Both volumes lie on the same voxels.
///
/// Levels of CSF, grey and white matter and the coil's bias field are estimated together: a mixture of three Gaussians
/// of the logarithm, by expectation maximization, and a polynomial fitted to what the mixture leaves [VanLeemput1999].
/// The levels are then the medians of places whose neighbours 1.5 mm off are of the same class.
///
/// Reports csf_share_ratio, grey_share_ratio, white_share_ratio, csf_to_grey_ratio, grey_to_white_ratio, bias_ratio
/// (half of what the coil's brightness varies by over the cavity). Throws Error 65 where the volumes are on different
/// voxels or hold one that is not finite; 80 where more than 2 % of the cavity lies outside of the MR, and where the
/// contrast is not that of T1 (the darkest class is not what lies around the brain, or levels are too near to each
/// other). The same bits whatever the thread count.
grid::HuVolume t1_contrast(const grid::HuVolume& mr, const grid::HuVolume& ct, const mask::BitMask& cavity,
                           const T1ContrastParams& params, Report& report, const Progress& progress = {});

}  // namespace trephine::segmentation
