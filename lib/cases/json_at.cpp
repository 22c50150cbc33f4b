// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/json_at.h"

namespace trephine::detail {

Json parse_json(std::string_view text) {
  constexpr int most_levels = 16;
  // Looking for a key walks over all keys before it.
  constexpr std::size_t most_keys = 10000, most_events = 200000;
  std::size_t keys = 0, events = 0;
  const auto bounded = [&](int depth, Json::parse_event_t event, Json&) {
    if (event == Json::parse_event_t::key) ++keys;
    if (depth > most_levels || keys > most_keys || ++events > most_events)
      throw Error(ExitCode::bad_input, "", "json", "holds too much, or is nested too deeply");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), bounded);
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, "", "json", "is damaged");
  }
}

}  // namespace trephine::detail
