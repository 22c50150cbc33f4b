// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons that a scripted hand does rightly, with something else done before, during or after the right thing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <map>

#include "lessons/lesson_type.h"
#include "lessons_run.h"

namespace lesson_cases {

/// What was done beside the right thing, ever worse: steps of a script, each with a comma at its end.
struct Excess {
  std::string name;
  std::vector<std::string> steps;
  bool replaces = false;     ///< each is a whole lesson without "finish", done in place of the right one
  bool begins_only = false;  ///< it is done before the right thing alone
};

/// A lesson and how it is done rightly.
struct RightLesson {
  std::string name;
  session::FeltCase& felt;
  const voxel::HapticVolume& whole;
  std::string module, task;
  AnyParams rubric;
  std::string prelude;  ///< what comes before all else
  std::string begun;    ///< a part of the right thing, after which something else is done
  std::string right, again;
};

inline lessons::LessonScore score_of(const RightLesson& lesson, const std::string& steps) {
  lesson.felt.loaded.haptic = lesson.whole;
  lessons::LessonOptions o;
  o.script =
      lessons::parse_lesson_script("{\"module\": \"" + lesson.module + "\", \"steps\": [" + steps + "\"finish\"]}");
  o.servo.rate_hz = 500;
  o.task = lesson.task;
  o.most_s = 9000;
  const std::atomic<bool> stop{false};
  const haptics::Recording recording = lessons::run_lesson(lesson.felt, o, stop).recording;
  lesson.felt.loaded.haptic = lesson.whole;
  const auto facts = lessons::facts_of_recording(lesson.felt, "test", recording);
  return lessons::lesson_type(lesson.module).score(*facts, lesson.felt.loaded, lesson.whole, lesson.rubric);
}

// How good it is: a failure is worse than any sum, and what is not completed worse than what is.
inline int worth_of(const lessons::LessonScore& s) {
  return lessons::sum_of(s).points + (s.outcome() == lessons::LessonOutcome::completed ? 100 : 0);
}

// The rows that lost points against the control, and what they say, or why it failed.
inline std::string said_of(const lessons::LessonScore& now, const lessons::LessonScore& control) {
  std::string said = now.outcome() == lessons::LessonOutcome::completed ? "" : lessons::headline_of(now);
  if (said.empty())
    for (std::size_t n = 0; n < now.rows.size(); ++n)
      if (now.rows[n].score.value_or(0) < control.rows[n].score.value_or(0))
        said += (said.empty() ? "" : "; ") + now.rows[n].name + ": " + now.rows[n].why.english();
  return said;
}

/// Does the excess at each of these places (0 before, 1 during, 2 after the right thing) in its first `most` degrees,
/// beside the same lesson without it. Each must lose points, and a worse one never wins any back; both are lost in
/// silence where no row and no critical error says why. Prints a line of docs/validation/lessons.md for each place.
inline void check_excess(const RightLesson& lesson, const Excess& excess, const std::vector<int>& places,
                         std::size_t most) {
  constexpr const char* names[] = {"before", "during", "after"};
  for (const int place : excess.replaces ? std::vector<int>{1} : places) {
    if (excess.begins_only && place != 0) continue;
    const std::string first =
        lesson.prelude + (place == 1 && !excess.replaces ? lesson.begun : "") + (place == 2 ? lesson.right : "");
    const std::string last = place == 2 ? lesson.again : lesson.right;
    // The control is the same for all that is done at that place.
    static std::map<std::string, lessons::LessonScore> controls;
    const std::string key = lesson.name + first + last;
    if (controls.count(key) == 0) controls[key] = score_of(lesson, first + last);
    const lessons::LessonScore& control = controls[key];
    EXPECT_EQ(control.outcome(), lessons::LessonOutcome::completed) << lesson.name << ": " << control.reason();
    std::string sums = std::to_string(lessons::sum_of(control).points);
    int before = worth_of(control);
    std::string said;
    for (std::size_t n = 0; n < std::min(most, excess.steps.size()); ++n) {
      const lessons::LessonScore now =
          score_of(lesson, excess.replaces ? excess.steps[n] : first + excess.steps[n] + last);
      const std::string where = fmt::format("{}, {}, {}, degree {}", lesson.name, excess.name, names[place], n + 1);
      said = said_of(now, control);
      EXPECT_LT(lessons::sum_of(now).points, lessons::sum_of(control).points) << where << ": " << said;
      EXPECT_LE(worth_of(now), before) << where << ": " << said;
      EXPECT_NE(said, "") << where;
      before = worth_of(now);
      sums += " " + std::to_string(lessons::sum_of(now).points);
    }
    std::printf("| %s | %s | %s | %s | %s |\n", lesson.name.c_str(), excess.name.c_str(),
                excess.replaces ? "instead" : names[place], sums.c_str(), said.c_str());
    std::fflush(stdout);
  }
}

/// Each excess at one place, in its first degree; the places take turns.
inline void check_in_short(const RightLesson& lesson, const std::vector<Excess>& all) {
  for (std::size_t n = 0; n < all.size(); ++n) check_excess(lesson, all[n], {all[n].begins_only ? 0 : int(n % 3)}, 1);
}
inline void check_all(const RightLesson& lesson, const std::vector<Excess>& all) {
  for (const Excess& excess : all) check_excess(lesson, excess, {0, 1, 2}, 9);
}

inline std::string times(int count, const std::string& steps) {
  std::string all;
  for (int n = 0; n < count; ++n) all += steps;
  return all;
}

}  // namespace lesson_cases
