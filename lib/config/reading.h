// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "config/config.h"
#include "config/declared.h"
#include "config/values.h"
#include "config/yaml_document.h"

namespace trephine {

/// What the parts of read_case_config share. Each adds its faults and goes on.
struct ConfigReading {
  ConfigReading(const std::filesystem::path& file, const ConfigOverrides& overrides);

  const std::filesystem::path file;  ///< the case's
  const ConfigOverrides& overrides;
  std::vector<std::filesystem::path> roots;  ///< what paths may not leave
  ConfigFaults faults;
  CaseConfig out;
  ConfigValues values;
  Named<MaterialFileParams> materials;                    ///< that the scene may name
  std::filesystem::path recipe;                           ///< empty: it could not be read
  std::vector<std::pair<std::string, ValueOrigin>> said;  ///< paths that the recipe and the scene say

  /// The path that a text in `from` means, or nothing and what is wrong with it.
  std::filesystem::path in_root(const std::filesystem::path& from, const std::string& text, std::string& fault) const;
  ValueOrigin origin(ValueSource source, const std::filesystem::path& from, const YamlNode& at) const;
  std::vector<std::string> anatomy_names() const;
  /// "brain2, the pipeline has no such anatomy, did you mean brain?", or "".
  std::string fault_of_anatomy(const std::string& name) const;
  /// The same of a landmark that is neither given nor can be found.
  std::string fault_of_landmark(const std::string& name) const;
};

/// The recipe: anatomies, stages of the whole scan, roles.
void read_recipe(ConfigReading& reading, const std::filesystem::path& file);

/// The scene and the materials that it names. Needs the recipe.
void read_scene(ConfigReading& reading, const std::filesystem::path& file);

/// What the scene wants, from its file with all that was set since: anatomies, landmarks, burr holes, haptic volume,
/// face policy.
void derive_scene(ConfigReading& reading);

/// The triangles and the deviation that the scene allows, and the accuracy that the case asks for, shared out to the
/// stages: smoothing keeps its bound, decimation gets the rest.
void share_out_limits(ConfigReading& reading);

}  // namespace trephine
