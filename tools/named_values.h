// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/vec3.h"
#include "grid/nrrd.h"

namespace trephine::tools {

/// Splits "skull=skull.vtp" into skull and skull.vtp. Throws Error 64 naming the flag where the name or the value is
/// missing.
std::pair<std::string, std::string> named_value(const std::string& flag, const std::string& text);

/// Reads exactly `count` finite numbers with commas between them. Throws Error 64 naming the flag.
std::vector<double> numbers_of(const std::string& flag, const std::string& text, std::size_t count);

/// Reads one number within the range. Throws Error 64 naming the flag.
double number_of(const std::string& flag, const std::string& text, double least, double most);

/// Reads every "nasion=0,-95,10" of a repeated flag.
std::map<std::string, Vec3> named_positions(const std::string& flag, const std::vector<std::string>& texts);

/// Reads every "mr=folder" of a repeated flag.
std::vector<std::pair<std::string, std::filesystem::path>> named_paths(const std::string& flag,
                                                                       const std::vector<std::string>& texts);

/// Whether the file is a volume as `import` writes it, which must not be taken for a field.
bool holds_hu(const grid::NrrdKeys& keys);

}  // namespace trephine::tools
