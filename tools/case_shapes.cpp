// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_shapes.h"

#include <algorithm>

#include "export_parts.h"
#include "meshing/contour.h"
#include "voxel/shape_field.h"

namespace trephine::tools {

CaseShapes::CaseShapes(const cases::LoadedCase& loaded, const std::vector<std::string>& wanted,
                       const Progress& progress) {
  const cases::CaseManifest& m = loaded.manifest;
  std::vector<std::string> known;
  for (const cases::CaseAnatomy& a : m.anatomies) known.push_back(a.name);
  for (const std::string& name : wanted)
    if (!m.find_anatomy(name)) unknown_name("--anatomy", name, known);
  for (const cases::CaseAnatomy& a : m.anatomies) {
    progress.check();
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), a.name) == wanted.end()) continue;
    if (!a.file.empty()) {
      shown_.push_back({a.name, a.colour_rgb, a.opacity, loaded.find_surface(a.name), false});
      continue;
    }
    const voxel::HapticShape* shape = loaded.has_haptic() ? loaded.haptic.find_shape(a.name) : nullptr;
    if (!shape) continue;
    felt_.push_back(meshing::contour_to_look_at(voxel::shape_field(loaded.haptic, shape->number, progress), progress));
    shown_.push_back({a.name, a.colour_rgb, a.opacity, &felt_.back(), true});
  }
}

}  // namespace trephine::tools
