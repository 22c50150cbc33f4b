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
  lesson,
  step_finish,
  last_trace,
  passes,
  paused,
  next,
  back,
  erase,
  incise_key,
  aspirate_key,
  pause_key,
  finish_key,
  judging,
  not_judged,
  points,
  report,
  review_help,
  without_darkening,
  without_grain,
  coarse_surfaces,
  without_shadow,
  half_the_pixels,
  shots,
  xrays,
  fluoroscopy,
  xrays_on,
  picture_held,
  no_xray,
  arm_ap,
  arm_lateral,
  arm_oblique,
  arm_turned,
  arm_tilted,
  arm_keys,
  notes,
  count
};
enum class Language { english, german };
const std::vector<std::pair<std::string, Language>>& languages();
const char* text_of(Language language, Text text);
/// The word in that language for a lesson's step or figure, which has an English name; the name where there is none.
std::string translated(Language language, const std::string& english);
/// The name of a tool, a view or a cut as the panels show it; the remote takes the English one.
std::string translated_name(Language language, const std::string& english);
/// A note of the window, or its answer to a key, in that language, with its names and figures; the note where there is
/// none.
std::string translated_note(Language language, const std::string& english);

}  // namespace trephine
