// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>

namespace trephine::grid {

/// How many mm a unit of length is, by the names that files use for it, in any case: nm, um, mm, cm, dm, m, km, in, ft
/// and their words; none where it is no unit that we know.
std::optional<double> mm_per_unit(const std::string& name);

}  // namespace trephine::grid
