// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"
#include "face/deface.h"
#include "grid/grid.h"
#include "head/head_landmarks.h"

namespace trephine::face {

/// Where the face is, when a person gave landmarks: what is removed, and what the gate checks, must not rest on a point
/// that nobody checked. The face is the union of what the given and the found landmarks say; where they lie more than
/// 15 mm apart, or a given one could not be found, somebody must have said which to believe, and why.

/// From one landmark as given to the same as found.
constexpr double landmarks_agree_mm = 15;

/// `known`: the landmarks as they are used, given ones in place of found ones. `found`: the same search without any
/// that is given; null where none is given. Returns one region, or two of which the face is the union. Throws Error 81
/// as face_region does; where given and found contradict each other and `params` does not say which to believe with a
/// reason; where what is believed is not there; and where the tragi of a region cannot be those of this head
/// (check_tragi).
std::vector<FaceRegion> face_regions(const head::HeadLandmarks& known, const head::HeadLandmarks* found,
                                     const grid::Field& skin, const FaceBeliefParams& params);

/// The same without check_tragi, for whom that was done already.
std::vector<FaceRegion> believed_regions(const head::HeadLandmarks& known, const head::HeadLandmarks* found,
                                         const FaceBeliefParams& params);

/// Where between the nasion (0) and the back of the head (1) the tragi lie, along the region's `front`; none where the
/// scan ends before the back of the head.
std::optional<double> tragi_position_ratio(const FaceRegion& region, const grid::Field& skin);

/// Throws Error 81 where the tragi lie too far to the front: a face in front of them would be published.
void check_tragi(const FaceRegion& region, const grid::Field& skin);

/// deface for each region, and the union of what was removed. Of what was removed the result has the larger of the two,
/// of depths the least.
Outcome<grid::HuVolume, DefaceResult> deface(const grid::HuVolume& volume, const grid::Field& skin,
                                             const std::vector<FaceRegion>& regions, const DefaceParams& params,
                                             const Progress& progress = {});

}  // namespace trephine::face
