// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "scene/tool_solid.h"
#include "surface/trimesh.h"

namespace trephine::scene {

/// How a patient lies on a table, and what lies ready.
struct RoomParams {
  surface::Bounds patient_mm;  ///< of what the case shows, world
  Vec3 down{0, 1, 0};     ///< unit, LPS: to the back for a patient who lies on it, to the front for one who does not
  bool head = false;      ///< else a part of the trunk, which goes on at both ends
  double tray_side = -1;  ///< on which side of the patient the tray stands: -1 right, 1 left
  std::vector<haptics::ToolParams> tools;  ///< lie on the tray, in that order
};

/// What is drawn of it, mm from an origin, and the box of all that with the patient's, world.
struct Room {
  Solid solid;
  surface::Bounds bounds_mm;
};

/// The table with its pad, what holds the head, the rest of the body under a drape, and the instruments on a tray
/// beside the patient. Of the patient it covers no more than `drape_over_mm` at the ends where the scan cuts the body.
/// Nothing of it is felt.
Room make_room(const RoomParams& params, Vec3 origin_mm);
constexpr double drape_over_mm = 8;

}  // namespace trephine::scene
