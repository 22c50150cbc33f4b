// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "config/yaml_document.h"

namespace trephine {

/// Who says a value, the weakest first: of two that say one, the later of this list wins.
enum class ValueSource {
  standard,      ///< the parameter's default
  recipe,        ///< the pipeline's file
  trade,         ///< the point of a measured front that a rule of the case chose
  scene,         ///< the scene's file, and what it allows of deviation and triangles
  set,           ///< the case's own file
  command_line,  ///< --set
  rule,          ///< the accuracy that the case asks for, which holds whatever else is said
};
const char* to_text(ValueSource source);

/// Who said a value, and where: "pipelines/head.yaml:12:7", "point bound/0.3 of head.json"; "" for a default.
struct ValueOrigin {
  ValueSource source = ValueSource::standard;
  std::string where;
  std::filesystem::path folder;  ///< of the file that says it: what a relative path in the value is meant from
};

/// A parameter of a case by its path, its value as text, and where that is from.
struct ValueRow {
  std::string path, value;
  ValueOrigin origin;
};

/// The parameters of a case by their paths: "import.series", "resample.spacing_mm", "skull.decimate.max_deviation_mm",
/// "landmarks.lateral_mm", "haptic.spacing_mm", "scene.triangles_ratio", "burr_hole_1.diameter_mm";
/// "*.decimate.max_deviation_mm" stands for those of every anatomy that has one. One table of who said which value:
/// a value of a weaker source never replaces that of a stronger one.
class ConfigValues {
 public:
  /// Adds a params object under a prefix, or one of its leaves under a path of its own; it is changed in place, and its
  /// lists and maps must keep their items.
  void add(const std::string& prefix, const AnyParams& params);
  void add_one(const std::string& path, const AnyParams& params, const ParameterLeaf& leaf) {
    targets_[path] = {leaf.parameter, leaf.object, params.object};
  }

  bool has(const std::string& path) const { return targets_.count(path) > 0; }
  const ValueOrigin& origin(const std::string& path) const;
  /// Says that the value that the object has already is from there.
  void note(const std::string& path, const ValueOrigin& origin) { origins_[path] = origin; }

  /// Returns the fault, or ""; "" too where a stronger source has said it. `anatomies`: whether the recipe could be
  /// read; where not, nothing is known of its paths, and nothing is said.
  std::string set(const std::string& path, const YamlNode& value, const ValueOrigin& origin);
  /// "path=value" as --set has it; faults are of usage (64).
  void set_from_text(const std::string& text, const ValueOrigin& origin, ConfigFaults& faults);
  /// Sets a value that must have passed its checks, where no stronger source has said it and there is such a path.
  void set_value(const std::string& path, const ParameterValue& value, const ValueOrigin& origin);
  double number(const std::string& path, double where_absent) const;

  /// All of them, by path.
  std::vector<ValueRow> rows() const;

 private:
  struct Target {
    const Parameter* parameter = nullptr;
    void* object = nullptr;
    std::shared_ptr<void> owner;
  };
  std::vector<std::string> matching(const std::string& path) const;

  std::map<std::string, Target> targets_;
  std::map<std::string, ValueOrigin> origins_;
};

}  // namespace trephine
