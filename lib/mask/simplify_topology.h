// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine::mask {

struct SimplifyParams {
  double close_handles_mm = 2;
  double close_cavities_ml = 1;
  template <class V>
  static void describe(V& v) {
    using P = SimplifyParams;
    v.number(&P::close_handles_mm, "close_handles_mm", Range{0, 60},
             "Tunnels and holes narrower than this are closed by a membrane of one voxel; 0: none.");
    v.number(&P::close_cavities_ml, "close_cavities_ml", Range{0, 10000},
             "Enclosed cavities smaller than this are filled, also those that a membrane encloses; 0: none.");
  }
};

/// The field of a simpler topology, for display: fewer tunnels that decimation must preserve, and fewer cavities. Only
/// the voxels that close something change their sign; everywhere else the field and its surface stay the same bit for
/// bit.
///
/// Tunnels: the shape is closed by a ball of close_handles_mm in diameter, and the added voxels are peeled off again as
/// long as the topology stays that of the closed shape (simple points, [Bertrand1994]). Bridges that would make a new
/// handle or join pieces are cut. What remains are membranes across tunnels, within close_handles_mm / 2 of the shape.
/// A membrane that would enclose a cavity larger than close_cavities_ml is taken back, so that a sinus stays open. Thin
/// bars that bridge a wider gap stay.
///
/// The topology is that of voxels joined by faces (and their complement also by edges and corners), which is what the
/// contour stage sees except in a few ambiguous places. The report: euler_characteristic_before, ..._after (of the
/// surface), handles_before_count, handles_after_count, cavities_before_count, cavities_after_count, membranes_count,
/// cavities_filled_count, voxels_changed_count, volume_added_ml, moved_max_mm (the largest distance of the new surface
/// to the old one, which is half a voxel's diagonal more than that of the farthest membrane voxel).
///
/// Throws Error 65 where a voxel is not finite; Cancelled. The result has the same bits whatever the thread count.
grid::Field simplify_topology(const grid::Field& field, const SimplifyParams& params, Report& report,
                              const Progress& progress = {});

}  // namespace trephine::mask
