// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <string_view>

namespace trephine::json {

/// How much JSON of unknown origin may hold. Looking for a key walks over all keys before it.
struct JsonBounds {
  std::size_t max_keys = 10000, max_values = 100000;
  int max_levels = 16;
};
enum class BeyondBounds { no, levels, count };
/// Which bound the text is beyond, before anything is allocated for it. It need be no JSON.
BeyondBounds beyond_bounds(std::string_view text, const JsonBounds& bounds);

}  // namespace trephine::json
