// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/reading.h"
#include "stages/points.h"

namespace trephine::config {
namespace {

// Adds all values of a copy under the prefix; setting one is refused with `why`.
template <class P>
void add_fixed(ConfigValues& values, const std::string& prefix, const P& params, const std::string& why) {
  const AnyParams copy = AnyParams::make(params);
  for (const ParameterLeaf& leaf : leaves_of(copy)) {
    const std::string path = prefix.empty() ? leaf.path : prefix + "." + leaf.path;
    if (values.has(path)) continue;
    values.add_one(path, copy, leaf);
    values.fix(path, why);
  }
}

}  // namespace

void add_shown_values(ConfigReading& r) {
  const std::string by_recipe = "is set by the recipe, change it there";
  for (const RecipeAnatomy& anatomy : r.out.anatomies)
    add_fixed(r.values, anatomy.name, static_cast<const RecipeAnatomyParams&>(anatomy), by_recipe);
  add_fixed(r.values, "", r.out.roles, by_recipe);
  for (const auto& [name, material] : r.materials)
    add_fixed(r.values, "materials." + name, material, "is set by the scene's file of materials, change it there");
}

void add_given_landmarks(ConfigReading& r) {
  for (const cases::CaseLandmark& l : r.out.landmarks) {
    const stages::PointParams point{{l.position_mm.x, l.position_mm.y, l.position_mm.z}, l.confidence, l.source};
    const std::string prefix = "given_landmarks.landmarks." + l.name;
    add_fixed(r.values, prefix, point, "is given with the case's landmarks, change it there");
    r.values.note(prefix + ".position_mm", r.landmark_origins[l.name]);
  }
}

}  // namespace trephine::config
