// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "segmentation/segment.h"

namespace trephine::head {

/// What brain and ventricles have in common: declares edge, smoothing_sigma_mm, roi_min_mm and roi_max_mm of P.
template <class P, class V>
void describe_tissue(V& v) {
  v.choice(&P::edge, "edge",
           {{"fixed", segmentation::SegmentEdge::fixed}, {"half_maximum", segmentation::SegmentEdge::half_maximum}},
           "Where the surface lies. fixed: at the given HU. half_maximum: the given HU are for a scan whose brain is "
           "at 30, and are shifted with this scan's brain.");
  v.number(&P::smoothing_sigma_mm, "smoothing_sigma_mm", Range{0, 5},
           "Sigma of a Gaussian against noise, in addition to the denoising that is always done.");
  v.numbers(&P::roi_min_mm, "roi_min_mm", Range{-1e6, 1e6}, "Lower corner of the region of interest, LPS.");
  v.numbers(&P::roi_max_mm, "roi_max_mm", Range{-1e6, 1e6}, "Upper corner of the region of interest, LPS.");
}

/// And grow_mm, which comes last.
template <class P, class V>
void describe_grow(V& v) {
  v.number(&P::grow_mm, "grow_mm", Range{-20, 20},
           "Moves the surface outwards (inwards, if negative) by this distance at the end; the field is then in mm.");
}

}  // namespace trephine::head
