// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/params.h"
#include "config/yaml_document.h"

namespace trephine {

/// How a file of declared keys is read.
struct DeclaredReading {
  const std::filesystem::path& file;
  ConfigFaults& faults;
  /// Returns what is wrong with a name of that kind ("anatomy", "material", ...) at that place, or "". May be empty.
  std::function<std::string(const std::string& kind, const std::string& name)> fault_of_name;
  /// Called for every value that was read, with its path. May be empty.
  std::function<void(const std::string& path, const YamlNode& at)> said;
};

/// Reads the node into the object and adds a fault for everything that does not fit: a key that is neither declared nor
/// in `others`, a value out of range, a missing required key, too many items, an unknown name, and what the struct's
/// fault() says of its values taken together. `where` is the path to the node.
void read_declared(const DeclaredReading& reading, const YamlNode& node, const std::string& where,
                   const ParameterSet& set, void* object, const std::vector<std::string>& others = {});

/// Whether the text has 1 to 32 characters of a-z, 0-9 and _, as the names of anatomies, shapes and materials must.
bool is_plain_name(const std::string& text);

/// Sets one value from YAML (a scalar, or a list of scalars). Returns what is wrong with it, or "".
std::string set_parameter(void* object, const Parameter& parameter, const YamlNode& value);

/// ", did you mean brain?", or "" where no known name is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace trephine
