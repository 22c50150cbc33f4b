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
  std::size_t answers_count = 0;  ///< that were known when it was looked
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
  /// Whether a question follows a critical error that is not known to have happened.
  bool asks_after_errors() const;
  /// The same also of what is seen; or an answer may have ended that.
  bool waits_for_errors() const;
  /// Until nobody looks any more.
  void wait() const;
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
  std::size_t answers_given_ = 0, answers_seen_ = 0;  // seen: by the last look
  std::future<Happened> looking_;
  double next_look_s_ = 0;
  std::chrono::steady_clock::time_point asked_at_;
};

}  // namespace trephine::window
