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
  /// What is wrong with a name of that kind ("anatomy", "material", ...) at that place, or "". May be empty.
  std::function<std::string(const std::string& kind, const std::string& name)> fault_of_name;
  /// Told of every value that was read, by its path. May be empty.
  std::function<void(const std::string& path, const YamlNode& at)> said;
};

/// Reads what the node says into the object and adds a fault for all that does not fit: a key that is not declared and
/// is none of `others`, a value out of range, a required key that is missing, more items than allowed, a name that
/// nobody knows, and what the struct itself says of its values together. `where` is the path to the node.
void read_declared(const DeclaredReading& reading, const YamlNode& node, const std::string& where,
                   const ParameterSet& set, void* object, const std::vector<std::string>& others = {});

/// 1 to 32 of a-z, 0-9 and _: the name of an anatomy, a shape or a material.
bool is_plain_name(const std::string& text);

/// Sets one value from YAML (a scalar, or a list of scalars). Returns what is wrong where it does not fit, else
/// nothing.
std::string set_parameter(void* object, const Parameter& parameter, const YamlNode& value);

/// ", did you mean brain?", or "" where no known name is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

}  // namespace trephine
