// SPDX-License-Identifier: GPL-3.0-or-later
#include "json/json_at.h"

#include "json/json_bounds.h"

namespace trephine::json {

Json parse_json(std::string_view text) {
  if (beyond_bounds(text, {}) != BeyondBounds::no)
    throw Error(ExitCode::bad_input, "", "json", "holds too much, or is nested too deeply");
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, "", "json", "is damaged");
  }
}

}  // namespace trephine::json
