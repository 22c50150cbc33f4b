// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/json_bounds.h"

namespace trephine::json {

BeyondBounds beyond_bounds(std::string_view text, const JsonBounds& bounds) {
  std::size_t keys = 0, values = 0;
  int levels = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      i += c == '\\';
      quoted = c != '"';
      continue;
    }
    quoted = c == '"';
    levels += (c == '[' || c == '{') - (c == ']' || c == '}');
    keys += c == ':';
    values += c == ',' || c == '[' || c == '{';
    if (levels > bounds.max_levels) return BeyondBounds::levels;
    if (keys > bounds.max_keys || values > bounds.max_values) return BeyondBounds::count;
  }
  return BeyondBounds::no;
}

}  // namespace trephine::json
