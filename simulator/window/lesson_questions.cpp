// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/lesson_questions.h"

#include <algorithm>
#include <utility>

namespace trephine::window {

using lesson::Question;

LessonQuestions::LessonQuestions(std::vector<haptics::AskedQuestion> asked, const lesson::LessonRubric& rubric)
    : asked_(std::move(asked)), rubric_(rubric), answered_(asked_.size()) {
  for (const haptics::AskedQuestion& a : asked_) texts_.push_back(lessons::text_of(rubric, a));
}

LessonQuestions::~LessonQuestions() { wait(); }

void LessonQuestions::wait() const {
  if (looking_.valid()) looking_.wait();
}

const std::string& LessonQuestions::when(std::size_t n) const {
  return lessons::question_of(rubric_, asked_[n].question)->when;
}

int LessonQuestions::open(const lessons::LessonFacts& facts) const {
  int open = -1;
  if (facts.end != lessons::LessonEnd::running) return open;
  for (std::size_t n = asked_.size(); n-- > 0;) {
    if (answered_[n]) continue;
    if (errors_.count(when(n))) return int(n);  // what has just happened goes before all else
    if (when(n) == Question::before ? facts.first_cut_s < 0 : when(n) == Question::after && ending_) open = int(n);
  }
  return open;
}

std::vector<std::string> LessonQuestions::choices(const lessons::LessonFacts& facts) const {
  const int n = open(facts);
  return n < 0 ? std::vector<std::string>() : asked_[std::size_t(n)].choices;
}

bool LessonQuestions::comes_before_end(const lessons::LessonFacts& facts) {
  return !std::exchange(ending_, true) && open(facts) >= 0;
}

int LessonQuestions::answer(const lessons::LessonFacts& facts, const std::string& choice) {
  const int n = open(facts);
  const std::vector<std::string> all = choices(facts);
  const auto at = std::find(all.begin(), all.end(), choice);
  if (at == all.end()) return haptics::belt_command::none;
  answered_[std::size_t(n)] = true;
  ++answers_given_;
  return haptics::belt_command::answer(n, int(at - all.begin()));
}

void LessonQuestions::found(Happened happened) {
  errors_.merge(happened.errors);
  flows_ = std::move(happened.flows);
  answers_seen_ = happened.answers_count;
}

bool LessonQuestions::waits_for_errors() const {
  if (!flows_.empty() && answers_seen_ < answers_given_) return true;
  for (const lesson::CriticalRule& rule : rubric_.critical_errors)
    if (rule.leads_to && !errors_.count(rule.error)) return true;
  return asks_after_errors();
}

bool LessonQuestions::asks_after_errors() const {
  for (std::size_t n = 0; n < asked_.size(); ++n)
    if (when(n) != Question::before && when(n) != Question::after && !errors_.count(when(n))) return true;
  return false;
}

bool LessonQuestions::wants_errors(const lessons::LessonFacts& facts) {
  constexpr double least_s = 1, share = 0.2;  // between looks, and of a core that they may take
  if (looking_.valid()) {
    if (looking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    found(looking_.get());
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - asked_at_).count();
    next_look_s_ = facts.end_s + std::max(least_s, took_s / share);
  }
  return waits_for_errors() && facts.first_cut_s >= 0 && facts.end_s >= next_look_s_;
}

void LessonQuestions::ask(std::function<Happened()> happened) {
  asked_at_ = std::chrono::steady_clock::now();
  looking_ = std::async(std::launch::async, std::move(happened));
}

}  // namespace trephine::window
