// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
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

/// What is printed of it. The topology is that of voxels joined by faces.
struct SimplifyResult {
  std::int64_t euler_characteristic_before = 0;
  std::int64_t euler_characteristic_after = 0;
  std::int64_t handles_before_count = 0;
  std::int64_t handles_after_count = 0;
  std::int64_t cavities_before_count = 0;
  std::int64_t cavities_after_count = 0;
  std::size_t membranes_count = 0;
  std::int64_t cavities_filled_count = 0;
  std::size_t voxels_changed_count = 0;
  double volume_added_ml = 0;
  double moved_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = SimplifyResult;
    v.integer(&P::euler_characteristic_before, "euler_characteristic_before", Range{},
              "Euler characteristic of the surface before.");
    v.integer(&P::euler_characteristic_after, "euler_characteristic_after", Range{}, "The same after.");
    v.integer(&P::handles_before_count, "handles_before_count", Range{}, "Handles before.");
    v.integer(&P::handles_after_count, "handles_after_count", Range{}, "Handles after.");
    v.integer(&P::cavities_before_count, "cavities_before_count", Range{}, "Cavities before.");
    v.integer(&P::cavities_after_count, "cavities_after_count", Range{}, "Cavities after.");
    v.integer(&P::membranes_count, "membranes_count", Range{}, "Membranes that were added.");
    v.integer(&P::cavities_filled_count, "cavities_filled_count", Range{}, "Cavities that were filled.");
    v.integer(&P::voxels_changed_count, "voxels_changed_count", Range{}, "Voxels that changed.");
    v.number(&P::volume_added_ml, "volume_added_ml", Range{}, "Volume that was added.");
    v.number(&P::moved_max_mm, "moved_max_mm", Range{}, "Largest distance of the new surface to the old one.");
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
/// contour stage sees except in a few ambiguous places. The largest distance of the new surface to the old one is half
/// a voxel's diagonal more than that of the farthest membrane voxel.
///
/// Throws Error 65 where a voxel is not finite; Cancelled. The result has the same bits whatever the thread count.
Outcome<grid::Field, SimplifyResult> simplify_topology(const grid::Field& field, const SimplifyParams& params,
                                                       const Progress& progress = {});

}  // namespace trephine::mask
