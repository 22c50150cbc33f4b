// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "config/yaml_document.h"

namespace trephine::config {

/// The sources of a value, the weakest first: of two that set the same value, the later in this list wins.
enum class ValueSource {
  standard,      ///< the parameter's default
  recipe,        ///< the pipeline's file
  trade,         ///< the point of a measured front that a rule of the case chose
  scene,         ///< the scene's file, with its limits on deviation and triangles
  set,           ///< the case's own file
  library,       ///< the file of a library, for its cases
  command_line,  ///< --set
  rule,          ///< the accuracy that the case asks for, which holds whatever other sources say
};
const char* to_text(ValueSource source);

/// Which source set a value, and where: "pipelines/head.yaml:12:7", "point bound/0.3 of head.json"; "" for a default.
struct ValueOrigin {
  ValueSource source = ValueSource::standard;
  std::string where;
  std::filesystem::path folder;  ///< folder of the file that sets it; relative paths in the value start there
};

/// A parameter of a case by its path, with its value as text and the origin of that value.
struct ValueRow {
  std::string path, value;
  ValueOrigin origin;
  std::string about;  ///< what its declaration says of it, one line
};

/// The parameters of a case by their paths: "import.series", "resample.spacing_mm", "skull.decimate.max_deviation_mm",
/// "landmarks.lateral_mm", "haptic.spacing_mm", "scene.triangles_ratio", "burr_hole_1.diameter_mm".
/// "*.decimate.max_deviation_mm" stands for that parameter of every anatomy that has it. This is the one table of which
/// source set which value: a weaker source never replaces the value of a stronger one.
class ConfigValues {
 public:
  /// Adds a params object under a prefix, or one of its leaves under a path of its own. The object is changed in place,
  /// and its lists and maps must keep their items.
  void add(const std::string& prefix, const AnyParams& params);
  void add_one(const std::string& path, const AnyParams& params, const ParameterLeaf& leaf) {
    targets_[path] = {leaf.parameter, leaf.object, params.object};
  }

  /// A value that follows from another: set() refuses it with `why`. set_value() may still change it.
  void fix(const std::string& path, const std::string& why) { fixed_[path] = why; }

  bool has(const std::string& path) const { return targets_.count(path) > 0; }
  const ValueOrigin& origin(const std::string& path) const;
  /// Whether set() or set_from_text() gave the value.
  bool is_set(const std::string& path) const { return set_.count(path) > 0; }
  /// Records the origin of the value that the object has already.
  void note(const std::string& path, const ValueOrigin& origin) { origins_[path] = origin; }

  /// Sets a value given as text, "0.2" or "[1, 1, 1]". Returns the fault, or ""; it returns "" also where a stronger
  /// source has set the value. `anatomies` says whether the recipe could be read; where it could not, its paths are
  /// unknown and no fault is reported for them. A near name is sought, which takes long, only to `explain` the fault.
  std::string set(const std::string& path, const std::string& value, const ValueOrigin& origin, bool explain = true);
  /// Sets "path=value" as --set gives it. Faults are those of usage (64).
  void set_from_text(const std::string& text, const ValueOrigin& origin, ConfigFaults& faults);
  /// Sets a value that has passed its checks already, unless a stronger source has set it or there is no such path.
  void set_value(const std::string& path, const ParameterValue& value, const ValueOrigin& origin);
  double number(const std::string& path, double where_absent) const;

  /// Checks what was set after the files were read (by a trade point, `set` or --set) as the reading of the files would
  /// have: names of that kind, and what a struct's fault() says of its values taken together. The params lie under
  /// `prefix`; the paths of `scene.haptic` begin with `haptic`.
  void check(const std::string& prefix, const AnyParams& params,
             const std::function<std::string(const std::string& kind, const std::string& name)>& fault_of_name,
             ConfigFaults& faults) const;

  /// All parameters, by path.
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
  std::map<std::string, std::string> fixed_;
  std::set<std::string> set_;
};

}  // namespace trephine::config
