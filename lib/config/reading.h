// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "config/config.h"
#include "config/declared.h"
#include "config/values.h"
#include "config/yaml_document.h"

namespace trephine::config {

/// The state that the parts of read_case_config share. Each part adds its faults and goes on.
struct ConfigReading {
  ConfigReading(const std::filesystem::path& file, const ConfigOverrides& overrides);

  const std::filesystem::path file;  ///< the case's configuration
  const ConfigOverrides& overrides;
  std::vector<std::filesystem::path> roots;  ///< folders that paths may not leave
  ConfigFaults faults;
  CaseConfig out;
  ConfigValues values;
  Named<cases::MaterialParams> materials;                 ///< materials that the scene may name
  std::map<std::string, ValueOrigin> landmark_origins;    ///< of the landmarks that are given, by name
  std::filesystem::path recipe;                           ///< empty: the recipe could not be read
  std::vector<std::pair<std::string, ValueOrigin>> said;  ///< paths that the recipe and the scene set

  /// The path that a text in `from` means. Where it is not allowed, the path is empty and `fault` says why.
  std::filesystem::path in_root(const std::filesystem::path& from, const std::string& text, std::string& fault) const;
  ValueOrigin origin(ValueSource source, const std::filesystem::path& from, const YamlNode& at) const;
  std::vector<std::string> anatomy_names() const;
  /// A text such as "brain2, the pipeline has no such anatomy, did you mean brain?", or "".
  std::string fault_of_anatomy(const std::string& name) const;
  /// The same for a landmark that is neither given nor can be found.
  std::string fault_of_landmark(const std::string& name) const;
};

/// Reads the recipe: anatomies, stages of the whole scan, roles.
void read_recipe(ConfigReading& reading, const std::filesystem::path& file);

/// Makes the case's corrections, files by anatomy, steps of their anatomies: each right after the step whose field it
/// was made for, and who reads that field by its name gets the corrected one. A path in `set` such as
/// skull.correct.file makes the step too. Needs the recipe.
void add_corrections(ConfigReading& reading, const Named<SaidPath>& corrections, const std::vector<std::string>& set,
                     const std::function<void(const std::string& where, const std::string& what)>& fault);

/// Takes the further scans that the case's file and the command line name. Needs the recipe, whose anatomies have names
/// already, and the series.
void add_scans(ConfigReading& reading, const Named<CaseScanParams>& said,
               const std::function<void(const std::string& where, const std::string& what)>& fault);
/// Adds the parameters of their stages, NAME.import and NAME.register.
void add_scan_values(ConfigReading& reading);
/// Reads the scene and the materials that it names. Needs the recipe.
void read_scene(ConfigReading& reading, const std::filesystem::path& file);

/// Adds what no stage has as a parameter and no path sets, so that it can be shown with its source: what the recipe
/// says of its anatomies and their roles, and the materials.
void add_shown_values(ConfigReading& reading);
/// The same for the given landmarks that the case uses.
void add_given_landmarks(ConfigReading& reading);

/// Derives what the scene wants from its file and all that was set since: anatomies, landmarks, burr holes, haptic
/// volume, face policy.
void derive_scene(ConfigReading& reading);

/// Distributes the triangles and the deviation that the scene allows, and the accuracy that the case asks for, to the
/// stages: smoothing keeps its bound, and decimation gets the rest.
void share_out_limits(ConfigReading& reading);

}  // namespace trephine::config
