// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/critical_zones.h"

namespace trephine::lessons {

CriticalZones::CriticalZones(const cases::LoadedCase& loaded) {
  for (const char* name : critical_names)
    if (const surface::TriMesh* surface = loaded.find_surface(name); surface && !surface->triangles.empty())
      zones_.emplace(name, surface::PointToMesh(*surface));
}

bool CriticalZones::holds(const std::string& name, Vec3 p) const {
  const auto zone = zones_.find(name);
  return zone != zones_.end() && zone->second.signed_distance_mm(p) <= 0;
}

}  // namespace trephine::lessons
