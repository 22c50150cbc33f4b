// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pipeline/config.h"
#include "pipeline/yaml_document.h"

namespace trephine {

/// Parameters of a case by their paths: "import.series", "resample.spacing_mm", "skull.decimate.max_deviation_mm",
/// "landmarks.lateral_mm", "haptic.spacing_mm", "burr_hole_1.diameter_mm"; "*.decimate.max_deviation_mm" stands for
/// those of every anatomy that has one. Part of read_case_config.
class ConfigPaths {
 public:
  /// Both are changed in place and must outlive this.
  ConfigPaths(CaseConfig& config, AnyParams& import) : config_(config), import_(import) {}

  bool has(const std::string& path) const { return targets().count(path) > 0; }
  bool was_set(const std::string& path) const { return set_in_.count(path) > 0; }
  /// Where it was set: the folder of the file that says so, empty for the command line; nothing where it was not.
  std::optional<std::filesystem::path> set_in(const std::string& path) const;

  /// Returns the fault, or "". Where the recipe could not be read, nothing is known of its paths, and nothing is said.
  std::string set(const std::string& path, const YamlNode& value, const std::filesystem::path& said_in);
  /// "path=value" as --set has it; faults are of usage (64).
  void set_from_text(const std::string& text, ConfigFaults& faults);

 private:
  struct Target {
    AnyParams* params = nullptr;
    const Parameter* parameter = nullptr;
  };
  std::map<std::string, Target> targets() const;

  CaseConfig& config_;
  AnyParams& import_;
  std::map<std::string, std::filesystem::path> set_in_;
};

}  // namespace trephine
