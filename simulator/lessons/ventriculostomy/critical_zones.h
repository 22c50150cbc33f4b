// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>

#include "cases/load_case.h"
#include "surface/point_to_mesh.h"

namespace trephine::lessons {

/// The structures that no catheter may pass through, as closed surfaces that the case holds: its anatomies named
/// sagittal_sinus, third_ventricle, brainstem and eloquent_zone (`zone` of `trephine` makes them). They refer to the
/// loaded case, which must outlive them. A structure that the case holds neither as such nor as a haptic shape is told
/// by the rubric's distances from landmarks.
class CriticalZones {
 public:
  CriticalZones() = default;
  explicit CriticalZones(const cases::LoadedCase& loaded);
  bool has(const std::string& name) const { return zones_.count(name) > 0; }
  /// Whether the point lies in that zone; false where the case has none of that name.
  bool holds(const std::string& name, Vec3 lps_mm) const;

 private:
  std::map<std::string, surface::PointToMesh> zones_;
};

/// In the order in which they are asked.
constexpr const char* critical_names[] = {"sagittal_sinus", "third_ventricle", "brainstem", "eloquent_zone"};

}  // namespace trephine::lessons
