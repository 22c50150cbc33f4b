// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "texts/language.h"

namespace trephine::texts {

/// What can be told to a user. note.cpp has a wording for each, in the same order.
enum class NoteId {
  verbatim,  ///< what is said elsewhere already: the message of an Error, the name of a file
  // Faults of the servo loop, in the order of their bits (haptic_fault).
  fault_pose,
  fault_time_step,
  fault_force,
  fault_device_lost,
  fault_jump,
  fault_gap,
  force_is_zero,
  force_comes_back,
  second_force_is_zero,
  second_force_comes_back,
  // Of devices.
  waiting_for_device,
  waiting_for_tracker,
  softer_walls,
  undamped_device,
  mesh_not_cut,
  holding_mouse_3d,
  holding,
  // Of pictures.
  coarse_beyond,
  coarse,
  memory_coarse,
  memory_edges,
  memory_no_ct,
  memory_ct,
  memory_old_incisions,
  memory_new_incision,
  memory_pictures,
  many_incisions,
  // Of sessions.
  frames_lost,
  ticks,
  ticks_with_faults,
  removed,
  target_followed,
  outcome_not_completed,
  outcome_completed,
  outcome_failed,
  judged,
  judged_in,
  file_not_written,
  // Answers to what the user does.
  nothing_there,
  no_volume,
  nothing_cast,
  several_functions,
  no_transfer_point,
  no_more_points,
  no_lesson,
  no_arm,
  no_ct,
  no_target,
  no_view,
  no_cut,
  no_arm_place,
  no_anatomy,
  no_opacity,
  no_tool_of_lesson,
  no_lesson_command,
  no_command,
  recording_shown,
  after_lesson,
  enter_again,
  only_end_left,
  lesson_is_paused,
  questions_first,
  no_question,
  no_answer,
  marker_untouched,
  last_step,
  first_step,
  choose_tool,
  no_other_burr,
  not_now,
  count
};

/// Something to be told: which of them, and the names and figures in it. It is put into a language when it is shown.
struct Note {
  NoteId id;
  std::vector<std::string> values;  ///< for each {} of the wording, in its order; the same in each language
  std::vector<NoteId> words;        ///< for the last {}: said in the language, with commas between
  Note(NoteId id_, std::vector<std::string> values_ = {}, std::vector<NoteId> words_ = {})
      : id(id_), values(std::move(values_)), words(std::move(words_)) {}
};
bool operator==(const Note& a, const Note& b);

/// What an action answers: nothing, or why it cannot be done.
using Answer = std::optional<Note>;

const Wording& wording_of(NoteId id);
/// Whether it tells how the program does (times, memory, coarser surfaces), not what somebody at work should know.
bool is_for_log(NoteId id);
std::string text_of(const Note& note, Language language);

}  // namespace trephine::texts
