// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For bench_drilled_hole: what a session drilled beside the boolean's hole, and its bricks beside a fresh contour.
#include <string>

#include "drill/live_surface.h"
#include "haptics/recording.h"
#include "session/felt_case.h"

namespace trephine {

/// Bit n: shape n of the volume is drilled.
std::uint64_t bits_of(const drill::DrillShapes& shapes);

/// Prints the walls of the drilled hole beside the cylinder that its path was meant to make, and the volumes that only
/// one of the two takes away. `drilled_case`, where not empty: a case of the same head whose hole the pipeline cut; its
/// axis and its volume are compared, too.
void beside_boolean(const voxel::HapticVolume& before, const voxel::HapticVolume& after,
                    const drill::DrillShapes& shapes, const haptics::Recording& recording, double ball_radius_mm,
                    const std::string& drilled_case);

/// Prints how many bricks of a surface that followed the session differ from one made anew, and how far its vertices
/// lie from those of a contour of the volume.
void beside_contour(const voxel::HapticVolume& after, int number, const drill::LiveSurface& followed);

}  // namespace trephine
