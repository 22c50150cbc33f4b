// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec3.h"

namespace trephine::grid::detail {

/// What the reader of a NRRD header needs of its fields' texts, and the fields that change the scale; for the sources
/// of this room only.
using Fields = std::map<std::string, std::string>;

[[noreturn]] void refuse(const std::string& field, const std::string& what);  ///< throws Error 65
std::string lower(std::string s);
std::vector<std::string> words(const std::string& s);
double number_of(const std::string& word, const std::string& field);

/// Whether the format has a field of that name, of whatever meaning.
bool is_known_field(const std::string& name);

/// mm of a unit along each axis of space, by `space units`: "mm" "mm" "mm"; 1 where there is no such field. Throws
/// Error 65 for a unit that is not known.
Vec3 units_of(const Fields& fields);

/// Throws Error 65 for fields that would give the axes or the samples another scale than those that are read, or that
/// contradict them: spacings, axis mins and maxs, units, kinds, old min and old max.
void check_scales(const Fields& fields, const std::array<Vec3, 3>& steps, std::size_t list_axes);

}  // namespace trephine::grid::detail
