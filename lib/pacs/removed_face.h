// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "pacs/slices.h"

namespace trephine::pacs {

/// A CT from which a face was taken off, for slices that are not its own: with more air around what was removed, as far
/// as whoever makes a volume of the slices again, as import_series does, mixes neighbours: two pixels within a slice,
/// two slices along the normal. So a volume of the slices shows nothing nearer to the face than the CT does, which the
/// face gate has passed. What was removed is known by voxels of exactly removed_hu among 26 others of the same. Slices
/// that are the CT's own voxels leave it as it is.
grid::Grid<std::int16_t> with_room_around_removed(const grid::Grid<std::int16_t>& ct, const SliceSet& slices,
                                                  const Progress& progress = {});

}  // namespace trephine::pacs
