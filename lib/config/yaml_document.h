// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/params.h"

namespace trephine {

/// A YAML file as a plain tree in which every node knows where it stood. Scalars stay text: `010`, `.nan` and `0,5` are
/// judged by the parameter that they are for, not by YAML's guess. Anchors, aliases, tags and several documents in a
/// file are refused: a configuration has no use for them.
struct YamlNode {
  enum class Kind { null, scalar, list, map } kind = Kind::null;
  std::string text;                                    ///< scalar
  std::vector<YamlNode> items;                         ///< list
  std::vector<std::pair<YamlNode, YamlNode>> entries;  ///< map, in the file's order; keys are scalars
  int line = 1, column = 1;

  const YamlNode* find(const std::string& key) const;
};

/// All faults of a configuration at once, each an Error 78 of its own (file:line:column, key, what).
class ConfigFaults {
 public:
  /// `position` is "file:line:column"; what names the value and what is allowed.
  void add(const std::filesystem::path& file, const YamlNode& at, const std::string& key, const std::string& what);
  void add(Error fault) { faults_.push_back(std::move(fault)); }
  bool empty() const { return faults_.empty(); }
  std::size_t count() const { return faults_.size(); }
  /// Throws ErrorList where there are faults.
  void raise() const;

 private:
  std::vector<Error> faults_;
};

/// Reads and parses. Throws 66 where the file is missing; ErrorList (78) with line and column for a syntax error, a
/// repeated key, nesting above 32, a file above 1 MiB or bytes that are not UTF-8 text.
YamlNode read_yaml(const std::filesystem::path& file);

/// read_yaml for a file that another one names: nothing where it cannot be read, its faults added to the others'.
std::optional<YamlNode> read_yaml_or_fault(const std::filesystem::path& file, ConfigFaults& faults);

}  // namespace trephine
