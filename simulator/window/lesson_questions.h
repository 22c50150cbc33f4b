// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <functional>
#include <future>
#include <set>
#include <string>
#include <vector>

#include "lessons/consequences.h"
#include "lessons/decisions.h"

namespace trephine::window {

/// The critical errors that happened, by name, and what they lead to.
struct Happened {
  std::set<std::string> errors;
  std::vector<lessons::Flow> flows;
};

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
  /// As somebody found out who asked.
  void found(Happened happened);
  /// Whether a question, or something that is seen, follows a critical error that is not known to have happened; or
  /// an answer may have ended what is seen.
  bool waits_for_errors() const;
  /// What flows, as far as was looked.
  const std::vector<lessons::Flow>& flows() const { return flows_; }
  /// The end is asked for; true where questions come before it, and it is asked for the first time.
  bool comes_before_end(const lessons::LessonFacts& facts);
  /// The command that answers the open question by the answer's name, which is no longer open then; none where it has
  /// no such answer.
  int answer(const lessons::LessonFacts& facts, const std::string& choice);
  /// Whether it is time to ask what happened: now and then, as long as it waits for errors.
  bool wants_errors(const lessons::LessonFacts& facts);
  /// Then: asks that in a thread. What `happened` needs must outlive it.
  void ask(std::function<Happened()> happened);

 private:
  const std::string& when(std::size_t n) const;

  const std::vector<haptics::AskedQuestion> asked_;
  const lesson::LessonRubric& rubric_;
  std::vector<lessons::QuestionText> texts_;
  std::vector<bool> answered_;
  bool ending_ = false;
  std::set<std::string> errors_;  // that happened, as far as was looked
  std::vector<lessons::Flow> flows_;
  bool answered_since_ = false;  // the last look that found something
  std::future<Happened> looking_;
  double next_look_s_ = 0;
  std::chrono::steady_clock::time_point asked_at_;
};

}  // namespace trephine::window
