// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/vec3.h"
#include "grid/nrrd.h"

namespace trephine {

/// "skull=skull.vtp" -> skull, skull.vtp. Throws 64 naming the flag where there is no name or no value.
std::pair<std::string, std::string> named_value(const std::string& flag, const std::string& text);

/// Exactly `count` finite numbers with commas between them. Throws 64 naming the flag.
std::vector<double> numbers_of(const std::string& flag, const std::string& text, std::size_t count);

/// One number within the range. Throws 64 naming the flag.
double number_of(const std::string& flag, const std::string& text, double least, double most);

/// All "nasion=0,-95,10" of a repeated flag.
std::map<std::string, Vec3> named_positions(const std::string& flag, const std::vector<std::string>& texts);

/// A volume as `import` writes it, which no field may be taken for.
bool holds_hu(const NrrdKeys& keys);

}  // namespace trephine
