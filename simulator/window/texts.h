// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace trephine {

/// The words of the window. texts.cpp has a table of them, one row a word and one column a language.
enum class Text {
  anatomies,
  view,
  cut_away,
  shows_ct,
  move_plane,
  tool,
  hand,
  step,
  time,
  inside,
  nothing,
  depth,
  force,
  to_target,
  picture,
  servo,
  late,
  under_cursor,
  pedal,
  incise,
  playback,
  speed,
  pause,
  go_on,
  keys,
  keys_help,
  lost_device,
  trace,
  reduced,
  places,
  ct_slices,
  count
};
enum class Language { english, german };
const std::vector<std::pair<std::string, Language>>& languages();
const char* text_of(Language language, Text text);

}  // namespace trephine
