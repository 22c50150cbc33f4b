// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "scene/scene.h"

namespace trephine::scene {

/// CSF as it comes out of a tube whose tip lies in it: beads that move outwards along the tube, and
/// drops that swell at its end, `to_mm` from the tip, and fall along `down` (unit). `axis` (unit) leads from the tip to
/// the tail. The same time gives the same drops.
std::vector<Marker> csf_drops(Vec3 tip_mm, Vec3 axis, Vec3 down, double tube_radius_mm, double to_mm, double time_s);

}  // namespace trephine::scene
