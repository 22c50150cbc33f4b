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

namespace trephine::config {

/// A YAML file as a plain tree in which every node knows its position in the file. Scalars stay text: the parameter
/// that reads them judges `010`, `.nan` and `0,5`, not YAML's guess. Anchors, aliases, tags and several documents in
/// one file are refused, because a configuration does not need them.
struct YamlNode {
  enum class Kind { null, scalar, list, map } kind = Kind::null;
  std::string text;                                    ///< for a scalar
  bool quoted = false;                                 ///< for a scalar: a text, even where it looks like a number
  std::vector<YamlNode> items;                         ///< for a list
  std::vector<std::pair<YamlNode, YamlNode>> entries;  ///< for a map, in the file's order; keys are scalars
  int line = 1, column = 1;

  const YamlNode* find(const std::string& key) const;
};

/// SHA-256 of what the tree says, in its order: comments, layout and the kind of quotation marks make no difference.
std::string digest_of(const YamlNode& tree);

/// Collects all faults of a configuration, each an Error 78 of its own (file:line:column, key, what).
class ConfigFaults {
 public:
  /// `position` is "file:line:column"; `what` names the value and what is allowed.
  void add(const std::filesystem::path& file, const YamlNode& at, const std::string& key, const std::string& what);
  void add(Error fault);
  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }
  /// Whether more of them would only be counted: what they say need not be made up.
  bool full() const { return faults_.size() >= max_told; }
  /// Throws ErrorList with the first faults, and how many more there are, where there are any.
  void raise() const;

  static constexpr std::size_t max_told = 20;

 private:
  std::vector<Error> faults_;
  std::size_t count_ = 0;
};

/// Reads and parses a file. Throws Error 66 where it is missing; ErrorList (78) with line and column for a syntax
/// error, a repeated key, nesting above 32, a file above 1 MiB or bytes that are not UTF-8 text.
YamlNode read_yaml(const std::filesystem::path& file);

/// read_yaml for a file that another file names. Where it cannot be read, nothing is returned and its faults are added
/// to the others.
std::optional<YamlNode> read_yaml_or_fault(const std::filesystem::path& file, ConfigFaults& faults);

}  // namespace trephine::config
