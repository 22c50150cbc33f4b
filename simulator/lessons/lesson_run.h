// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "haptics/recording.h"
#include "haptics/servo.h"
#include "lesson/rubric.h"
#include "lessons/lesson_type.h"
#include "session/felt_case.h"

namespace trephine::lessons {

struct LessonOptions {
  LessonScript script;
  device::HandParams hand;
  ScriptAim aim;
  haptics::ServoParams servo;  ///< paced and realtime are ignored: a scripted hand has a time of its own
  contact::ContactParams contact;
  haptics::ForceParams force;
  haptics::ShaftParams shaft;
  haptics::DrillingParams drilling;  ///< `drill` is set where the case has bone to be drilled
  drill::DrillParams law;
  std::string participant = "anonymous";
  std::string task;  ///< what is asked for; empty: what the script says, else what is usual in the case
  const lesson::CompiledRubric* rubric = nullptr;  ///< by which it will be judged, and whose questions a script answers
  double most_s = 7200;                            ///< of the lesson's time; then it ends unfinished
  std::optional<haptics::RecordedSecondHand> second;  ///< the other hand, whose device is as fast as the script's
  device::Device* second_device = nullptr;            ///< then
};

struct LessonResult {
  haptics::Recording recording;
  haptics::ServoStatistics statistics;
  double wall_s = 0;
};

/// Does the script in the case, through the servo loop as fast as it goes, and returns the recording as it would be
/// read from a file. The case's haptic volume is drilled. Throws as the module does, and ToolBelt; Error 64 where the
/// script answers questions and no rubric is given, or one of another lesson is;
/// Cancelled through `stop`: what was done until then is lost.
LessonResult run_lesson(session::FeltCase& felt, const LessonOptions& options, const std::atomic<bool>& stop);

/// Whose answers to the hand are judged: those that the program finds anew, or those that stand in the recording.
enum class Answers { replayed, trusted };

/// What happened in a recorded lesson, and what the tools cut is cut again. `felt` must be as loaded; its volume is
/// drilled. Throws Error 65 where the recording is no lesson, or one that is not known, 80 where it leaves another
/// volume than it says; for Answers::replayed also where any bit of an answer, time or outcome is another.
std::shared_ptr<const LessonFacts> facts_of_recording(session::FeltCase& felt, const std::string& file,
                                                      const haptics::Recording& recording,
                                                      Answers answers = Answers::trusted);

}  // namespace trephine::lessons
