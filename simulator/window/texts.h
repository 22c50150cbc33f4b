// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "texts/language.h"
#include "texts/phrase.h"

namespace trephine::window {

/// The words of the window. texts.cpp has a table of them, one row a word and one column a language.
enum class Text {
  anatomies,
  view,
  cut_away,
  cast,
  shows_ct,
  move_plane,
  tool,
  time,
  inside,
  nothing,
  depth,
  force,
  to_target,
  behind_target,
  picture,
  servo,
  late,
  under_cursor,
  pedal,
  playback,
  speed,
  pause,
  go_on,
  keys,
  lost_device,
  trace,
  reduced,
  lesson,
  last_trace,
  passes,
  paused,
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
  arm_turned,
  arm_tilted,
  notes,
  log,
  sign,
  opacity,
  colour,
  felt_from_opacity,
  felt_from,
  not_felt,
  count
};
const char* text_of(texts::Language language, Text text);
/// The word in that language for a lesson's step or figure, which has an English name; the name where there is none.
std::string translated(texts::Language language, const texts::Phrase& phrase);
/// The name of a tool, a view, a cut or a place of the C-arm as the panels show it; the remote takes the English one.
std::string translated_name(texts::Language language, const std::string& english);

}  // namespace trephine::window
