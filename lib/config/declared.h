// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/params.h"
#include "config/yaml_document.h"

namespace trephine::config {

/// How a file of declared keys is read.
struct DeclaredReading {
  const std::filesystem::path& file;
  ConfigFaults& faults;
  /// Returns what is wrong with a name of that kind ("anatomy", "material", ...) at that place, or "". May be empty.
  std::function<std::string(const std::string& kind, const std::string& name)> fault_of_name;
  /// Called for every value that was read, with its path. May be empty.
  std::function<void(const std::string& path, const YamlNode& at)> said;
};

/// Where everything that was read stands in its file, by its path: "cases[2].set", "anatomies.skull.stages.segment".
/// The places point into the tree that was read.
class Places {
 public:
  void add(const std::string& path, const YamlNode& value, const YamlNode* key = nullptr);
  bool has(const std::string& path) const { return places_.count(path) > 0; }
  /// The value with that path; where there is none, the nearest one around it.
  const YamlNode& at(const std::string& path) const;
  /// The key of that path; where it has none, its value.
  const YamlNode& key(const std::string& path) const;

 private:
  struct Place {
    const YamlNode *value = nullptr, *key = nullptr;
  };
  const Place& find(std::string path) const;
  std::map<std::string, Place> places_;
};

/// Reads the whole file into the object, in the order of declaration, and adds a fault for everything that does not
/// fit: a key that is not declared, a value out of range, a missing required key, too many items, an unknown name, and
/// what the struct's fault() says of its values taken together.
Places read_declared(const DeclaredReading& reading, const YamlNode& tree, const ParameterSet& set, void* object);

/// Whether the text has 1 to 32 characters of a-z, 0-9 and _, as the names of anatomies, shapes and materials must.
bool is_plain_name(const std::string& text);

/// Sets one value from YAML (a scalar, or a list of scalars). Returns what is wrong with it, or "".
std::string set_parameter(void* object, const Parameter& parameter, const YamlNode& value);

/// ", did you mean brain?", or "" where no known name is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace trephine::config
