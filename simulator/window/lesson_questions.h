// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <functional>
#include <future>
#include <set>
#include <string>
#include <vector>

#include "lessons/decisions.h"

namespace trephine::window {

/// What a lesson in the window asks: before the first cut the time-out, once a critical error happened its consequence,
/// and what comes after the procedure when its end was asked for. In the window's thread.
class LessonQuestions {
 public:
  /// None: nothing is asked. The rubric must outlive it.
  LessonQuestions(std::vector<haptics::AskedQuestion> asked, const lesson::LessonRubric& rubric);
  ~LessonQuestions();

  const std::vector<haptics::AskedQuestion>& asked() const { return asked_; }
  /// The number of the question that waits for its answer; -1: none.
  int open(const lessons::LessonFacts& facts) const;
  const lessons::QuestionText& text(int n) const { return texts_[std::size_t(n)]; }
  /// The names of its answers; none where nothing is asked.
  std::vector<std::string> choices(const lessons::LessonFacts& facts) const;
  /// These happened, as somebody found out who asked.
  void found(std::set<std::string> errors) { errors_.merge(errors); }
  /// Whether a question follows a critical error that is not known to have happened.
  bool waits_for_errors() const;
  /// The end is asked for; true where questions come before it, and it is asked for the first time.
  bool comes_before_end(const lessons::LessonFacts& facts);
  /// The command that answers the open question by the answer's name, which is no longer open then; none where it has
  /// no such answer.
  int answer(const lessons::LessonFacts& facts, const std::string& choice);
  /// Whether it is time to ask which critical errors happened: now and then, as long as a question follows one that
  /// did not.
  bool wants_errors(const lessons::LessonFacts& facts);
  /// Then: asks that in a thread. What `critical_errors` needs must outlive it.
  void ask(std::function<std::set<std::string>()> critical_errors);

 private:
  const std::string& when(std::size_t n) const;

  const std::vector<haptics::AskedQuestion> asked_;
  const lesson::LessonRubric& rubric_;
  std::vector<lessons::QuestionText> texts_;
  std::vector<bool> answered_;
  bool ending_ = false;
  std::set<std::string> errors_;  // that happened, as far as was looked
  std::future<std::set<std::string>> looking_;
  double next_look_s_ = 0;
  std::chrono::steady_clock::time_point asked_at_;
};

}  // namespace trephine::window
