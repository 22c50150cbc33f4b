// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/json_at.h"

namespace trephine::json {

namespace {

// Bounds the nesting and the number of keys and values before anything is allocated.
void check_structure(std::string_view text) {
  constexpr int max_levels = 16;
  // Looking for a key walks over all keys before it.
  constexpr std::size_t max_keys = 10000, max_values = 100000;
  int levels = 0;
  std::size_t keys = 0, values = 0;
  bool within_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (within_text) {
      if (c == '\\') ++i;
      within_text = c != '"';
      continue;
    }
    within_text = c == '"';
    levels += (c == '[' || c == '{') - (c == ']' || c == '}');
    keys += c == ':';
    values += c == ',' || c == '[' || c == '{';
    if (levels > max_levels || keys > max_keys || values > max_values)
      throw Error(ExitCode::bad_input, "", "json", "holds too much, or is nested too deeply");
  }
}

}  // namespace

Json parse_json(std::string_view text) {
  check_structure(text);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, "", "json", "is damaged");
  }
}

}  // namespace trephine::json
