// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::body {

struct BodyParams {
  double tissue_hu = -300;
  double air_hu = -900;
  double core_mm = 7;
  double thinnest_mm = 2.4;
  double reach_mm = 55;
  double most_part_ml = 80;
  double edge_mm = 1.6;
  double least_ml = 0.5;
  double strand_mm = 4;

  template <class V>
  static void describe(V& v) {
    using P = BodyParams;
    v.number(&P::tissue_hu, "tissue_hu", Range{-700, 100}, "Lowest HU of skin and fat.");
    v.number(&P::air_hu, "air_hu", Range{-1000, -500},
             "Outside of the body, only what is brighter than this is taken away; hair and the noise of air stay.");
    v.number(&P::core_mm, "core_mm", Range{3, 15},
             "The body's inside is where a ball of this radius fits into tissue and bone.");
    v.number(&P::thinnest_mm, "thinnest_mm", Range{0, 6},
             "What stands out from the body and is thinner than this (the sheet of a mask, a tube) is apparatus; ears "
             "and nose are thicker.");
    v.number(&P::reach_mm, "reach_mm", Range{5, 80},
             "How far ears and nose reach beyond the body's inside; what reaches farther is apparatus.");
    v.number(&P::most_part_ml, "most_part_ml", Range{1, 1000},
             "What stands out from the body (an ear, the nose) is smaller than this; what is larger is apparatus.");
    v.number(&P::edge_mm, "edge_mm", Range{0.5, 5},
             "How far the skin's blurred edge reaches beyond tissue_hu, as long as the HU fall outwards.");
    v.number(&P::least_ml, "least_ml", Range{0, 100}, "Where there is less apparatus than this, the scan stays as is.");
    v.number(&P::strand_mm, "strand_mm", Range{0, 8},
             "Where a perforated mask lies, bumps of the skin that are lower than this are its strands; 0: they stay.");
  }
};

struct ApparatusFigures {
  double body_ml = 0;
  double apparatus_ml = 0;       ///< brighter than tissue_hu
  double thin_apparatus_ml = 0;  ///< its sheets and strands
  std::int64_t apparatus_pieces_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = ApparatusFigures;
    v.number(&P::body_ml, "body_ml", Range{}, "The body, with what it encloses.");
    v.number(&P::apparatus_ml, "apparatus_ml", Range{}, "Apparatus as bright as tissue.");
    v.number(&P::thin_apparatus_ml, "thin_apparatus_ml", Range{}, "Its sheets and strands.");
    v.integer(&P::apparatus_pieces_count, "apparatus_pieces_count", Range{}, "Its pieces.");
  }
};
struct BodyResult {
  std::optional<double> board_thickness_mm;  ///< where there is a board
  std::optional<double> strands_on_skin_ml;  ///< where there is a perforated mask
  std::optional<ApparatusFigures> found;     ///< where the body was found
  template <class V>
  static void describe(V& v) {
    using P = BodyResult;
    v.number(&P::board_thickness_mm, "board_thickness_mm", "Thickness of the board under the body.");
    v.number(&P::strands_on_skin_ml, "strands_on_skin_ml", "Strands of a mask that lie on the skin.");
    v.all_of(&P::found);
  }
};

/// Takes apparatus off a scan: radiotherapy masks, couch, head holder, clamps, pillows, leads and tubes. The result is
/// the volume with air in the place of everything outside of the body that is brighter than `air_hu`: -1000 and -999 HU
/// in turn, so that mask/field_edge.h does not take it for padding. What the body encloses (sinuses, airways, ear
/// canals) stays, and so does the blurred edge of the skin.
///
/// The body is found from inside out. Its inside is the largest piece of tissue and bone in which a ball of core_mm
/// fits. What grows out of it, is at least thinnest_mm thick, smaller than most_part_ml and ends within reach_mm (ears,
/// nose) belongs to it; other pieces (holder, cushion) do not, and where one touches the body, the plate's own
/// thickness goes and what is left of an ear stays. The skin's edge is followed outwards as long as the HU fall; where
/// they rise again, something lies on the skin.
///
/// A flat board under the body is taken off first (body/board.h): it may touch the body over a wide place.
///
/// Where there is a perforated mask, its strands that lie on the skin without a gap are bumps of the skin: those lower
/// than strand_mm are smoothed off (body/pressed_strands.h).
///
/// What it cannot do: a sheet without holes that touches the skin without a gap that the scan shows stays with its
/// thickness where it is wider than it is high.
///
/// Warns where the body was not found; the scan then stays as it is. The result has the same bits whatever the thread
/// count. Throws Error 65 where a voxel is not finite; Cancelled.
Outcome<grid::HuVolume, BodyResult> keep_body(const grid::HuVolume& volume, const BodyParams& params,
                                              const Progress& progress = {});

}  // namespace trephine::body
