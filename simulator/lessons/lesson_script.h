// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>

#include "base/params.h"

namespace trephine::lessons {

/// A lesson as a simulated hand is to do it: a JSON file of steps (docs/how-to/lesson-by-script.md).

/// A place on or in the head. It begins at a landmark, target or burr hole of the case. From there it goes along the
/// midline of the skin, away from the nasion, then to the side over the skin, then by an offset.
struct ScriptPlace {
  std::string at;
  double along_mm = 0, right_mm = 0;
  std::array<double, 3> offset_mm{0, 0, 0};
  template <class V>
  static void describe(V& v) {
    using P = ScriptPlace;
    v.text(&P::at, "at", "Landmark, target or burr hole of the case; hole: the one that was drilled.").is_required();
    v.number(&P::along_mm, "along_mm", Range{-300, 300}, "From there over the skin along the midline, backwards.");
    v.number(&P::right_mm, "right_mm", Range{-120, 120}, "Then over the skin to the patient's right.");
    v.numbers(&P::offset_mm, "offset_mm", Range{-200, 200}, "Then by so much, LPS.");
  }
};

struct TakeStep {
  std::string tool;
  template <class V>
  static void describe(V& v) {
    v.text(&TakeStep::tool, "tool", "The tool, as the lesson calls it.").is_required();
  }
};

struct InsertStep {
  ScriptPlace toward;
  ScriptPlace from{"hole", 0, 0, {0, 0, 0}};
  double short_of_mm = 0, speed_mm_per_s = 15;
  template <class V>
  static void describe(V& v) {
    using P = InsertStep;
    v.group(&P::toward, "toward", "The place that the line goes to.").is_required();
    v.group(&P::from, "from", "Where the line enters; by default the middle of the hole.");
    v.number(&P::short_of_mm, "short_of_mm", Range{-150, 150}, "How far before that place it stops.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

struct WithdrawStep {
  double by_mm = 120, speed_mm_per_s = 60;
  template <class V>
  static void describe(V& v) {
    using P = WithdrawStep;
    v.number(&P::by_mm, "by_mm", Range{0, 300}, "How far the tool is drawn back along its axis.");
    v.number(&P::speed_mm_per_s, "speed_mm_per_s", Range{1, 1000}, "How fast.");
  }
};

struct WaitStep {
  double seconds = 1;
  template <class V>
  static void describe(V& v) {
    v.number(&WaitStep::seconds, "seconds", Range{0, 86400}, "How long the hand stays where it is.");
  }
};

struct AnswerStep {
  std::string question, choice;
  template <class V>
  static void describe(V& v) {
    v.text(&AnswerStep::question, "question", "The question, as the rubric calls it.").is_required();
    v.text(&AnswerStep::choice, "choice", "The answer by its name; by default the right one.");
  }
};

struct LessonScript {
  std::string module, task;
  Steps steps;
  template <class V>
  static void describe(V& v) {
    using P = LessonScript;
    v.word(&P::module, "module", modules(), "The lesson that it does.").is_required();
    v.text(&P::task, "task",
           "What is asked for, as `right` or `pedicle_2_left`; by default what is usual in the case.");
    v.steps(&P::steps, "steps", steps_of_all(), "What the hand does, in this order.").is_required();
  }
  bool answers() const;  ///< whether there is a step `answer`: only then is the hand asked
  static std::vector<std::string> modules();
  static std::vector<StepChoice> steps_of_all();
};

/// The step of that name, as every lesson may have it.
template <class P = NothingDeclared>
StepChoice script_step(const char* name, const char* help) {
  return {name, help, &parameters_of<P>()};
}
/// What a script of any lesson may say: take, withdraw, wait, answer, pause, resume, finish,
/// lose_device. `own` are the
/// module's further steps.
std::vector<StepChoice> with_common_steps(std::vector<StepChoice> own);

/// Throws Error 66; 65 naming the step and the key, also where it is a step of another lesson.
LessonScript read_lesson_script(const std::filesystem::path& file);
LessonScript parse_lesson_script(const std::string& json);

}  // namespace trephine::lessons
