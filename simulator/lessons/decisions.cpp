// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/decisions.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/hash.h"
#include "base/text.h"
#include "lessons/lesson_words.h"

namespace trephine::lessons {
namespace {

using lesson::Question;

// Each question and each answer has a number of its own in a command.
static_assert(haptics::belt_command::answer(int(lesson::most_questions) - 1, int(lesson::most_choices) - 1) == 0xff);

// What the wrong answers of a token or a task are drawn by.
std::string drawn(const std::string& seed, const std::string& name) { return sha256_of_bytes(seed + "\n" + name); }

std::set<std::string> words_of(const std::string& name) {
  std::set<std::string> words;
  for (const std::string& w : split_at(name, '_')) words.insert(w);
  return words;
}

// Tokens that look like the case's own: its number, or else its last letters, are others.
std::vector<std::string> tokens_beside(const std::string& token, const std::string& seed) {
  const std::size_t digits = token.find_last_not_of("0123456789") + 1;
  std::vector<std::string> all;
  if (digits < token.size()) {
    const std::size_t width = std::min<std::size_t>(token.size() - digits, 6);
    const std::string before = token.substr(0, token.size() - width);
    const int number = std::stoi(token.substr(before.size())), most = int(std::pow(10, width)) - 1;
    for (const int step : {-2, -1, 1, 2, 10})
      if (number + step > 0 && number + step <= most) {
        const std::string text = std::to_string(number + step);
        all.push_back(before + std::string(width - text.size(), '0') + text);
      }
    for (int other = 1; all.size() < 2; ++other)  // of one digit that leaves too few
      if (other != number) all.push_back(before + std::to_string(other));
  } else {
    for (std::size_t n = 0; all.size() < 3; ++n) {
      std::string other = token;
      const std::string letters = drawn(seed, std::to_string(n));  // of a to f and digits
      for (std::size_t at = other.size() > 2 ? other.size() - 2 : 0, k = 0; at < other.size(); ++at)
        other[at] = char('a' + (letters[k++] * 7 + int(n)) % 26);
      if (other != token && std::find(all.begin(), all.end(), other) == all.end()) all.push_back(other);
    }
  }
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return drawn(seed, a) < drawn(seed, b); });
  all.resize(2);
  return all;
}

// What else might have been asked for: first what shares most words with it, as the other side of the same level.
std::vector<std::string> tasks_beside(const LessonType& type, const cases::CaseManifest& manifest,
                                      const std::string& task, const std::string& seed) {
  std::vector<std::string> all;
  const std::set<std::string> own = words_of(task);
  const auto apart = [&](const std::string& name) {
    std::size_t shared = 0;
    for (const std::string& w : words_of(name)) shared += own.count(w);
    return own.size() - std::min(own.size(), shared);
  };
  if (type.tasks)
    for (const LessonTask& t : type.tasks(manifest))
      if (t.name != task) all.push_back(t.name);
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
    return std::make_pair(apart(a), drawn(seed, a)) < std::make_pair(apart(b), drawn(seed, b));
  });
  if (all.size() > 3) all.resize(3);
  return all;
}

// "pedicle 2 left", "Pedikel 2 links".
LessonText words_of_name(const std::string& name) {
  LessonText out;
  for (const texts::Language l : {texts::Language::english, texts::Language::german})
    for (const std::string& w : split_at(name, '_')) {
      std::string& text = out.in[std::size_t(l)];
      text += (text.empty() ? "" : " ") + lesson_words(l, w);
    }
  return out;
}

LessonText both(const std::string& english, const std::string& german) {
  return {{english, german.empty() ? english : german}};
}

std::string right_of(const Question& q, const std::string& task, const std::string& case_token) {
  if (q.offers == Question::Offers::patient) return case_token;
  if (q.offers == Question::Offers::task) return task;
  for (const lesson::QuestionChoice& c : q.choices)
    if (c.right) return c.choice;
  return "";
}

LessonText text_of_choice(const Question& q, const std::string& name) {
  if (name.empty()) return {};
  if (q.offers == Question::Offers::patient) return both(name, "");
  if (q.offers == Question::Offers::task) return words_of_name(name);
  for (const lesson::QuestionChoice& c : q.choices)
    if (c.choice == name) return both(c.text, c.text_de);
  return {};
}

}  // namespace

std::vector<OfferedQuestion> questions_for(const lesson::LessonRubric& rubric, const LessonType& type,
                                           const cases::CaseManifest& manifest, const std::string& task,
                                           const std::string& participant) {
  std::vector<OfferedQuestion> all;
  for (const Question& q : rubric.questions) {
    const std::string seed = manifest.case_token + "\n" + participant + "\n" + q.question;
    OfferedQuestion out;
    out.question = q.question;
    out.right = right_of(q, task, manifest.case_token);
    if (q.offers == Question::Offers::patient) out.choices = tokens_beside(manifest.case_token, seed);
    if (q.offers == Question::Offers::task) out.choices = tasks_beside(type, manifest, task, seed);
    for (const lesson::QuestionChoice& c : q.choices)
      if (!c.right) out.choices.push_back(c.choice);
    if (out.right.empty() || out.choices.empty()) continue;
    out.choices.push_back(out.right);
    std::sort(out.choices.begin(), out.choices.end(),
              [&](const auto& a, const auto& b) { return drawn(seed, a) < drawn(seed, b); });
    all.push_back(std::move(out));
  }
  return all;
}

std::vector<haptics::AskedQuestion> as_asked(const std::vector<OfferedQuestion>& questions) {
  return {questions.begin(), questions.end()};
}

const Question* question_of(const lesson::LessonRubric& rubric, const std::string& name) {
  for (const Question& q : rubric.questions)
    if (q.question == name) return &q;
  return nullptr;
}

QuestionText text_of(const lesson::LessonRubric& rubric, const haptics::AskedQuestion& asked) {
  QuestionText out;
  const Question* q = question_of(rubric, asked.question);
  if (!q) return out;
  out.question = both(q->text, q->text_de);
  out.why = both(q->why, q->why_de);
  for (const std::string& name : asked.choices) out.choices.push_back(text_of_choice(*q, name));
  return out;
}

void judge_decisions(LessonScore& score, const LessonFacts& facts, const std::vector<haptics::AskedQuestion>& asked,
                     const lesson::LessonRubric& rubric, const std::string& case_token, bool of_rubric) {
  if (!rubric.wrong_answers_count || asked.empty()) return;
  ScoreRow row;
  row.name = "decisions";
  row.title = "Time-out and decisions";
  row.beside = true;
  if (!of_rubric) {
    row.why = "it was asked by another rubric";
    score.rows.push_back(std::move(row));
    return;
  }
  // Whether the time-out was done before the patient was cut, and named this patient and what was asked for.
  bool timed_out = true, right_place = true;
  int wrong = 0;
  double decided_s = std::max(0.0, facts.first_cut_s);
  for (std::size_t n = 0; n < asked.size(); ++n) {
    const Question* q = question_of(rubric, asked[n].question);
    if (!q) continue;
    Decision d;
    d.question = q->question;
    d.when = q->when;
    const bool before = q->when == Question::before;
    std::optional<double> since_s;
    if (!before && q->when != Question::after) {  // the consequence of what may not have happened
      const auto error = std::find_if(score.critical.begin(), score.critical.end(),
                                      [&](const CriticalError& e) { return e.rule.error == q->when; });
      if (error == score.critical.end()) continue;
      since_s = error->at_s;
    }
    const std::string right = right_of(*q, facts.task, case_token);
    for (const GivenAnswer& a : facts.answers)
      if (a.question == int(n) && std::size_t(a.choice) < asked[n].choices.size() && a.time_s >= since_s.value_or(0)) {
        d.given = asked[n].choices[std::size_t(a.choice)];
        d.at_s = a.time_s;
        const bool late = before && facts.first_cut_s >= 0 && a.time_s > facts.first_cut_s;
        d.state = late ? AnswerState::late : d.given == right ? AnswerState::right : AnswerState::wrong;
        decided_s = std::max(decided_s, a.time_s);
      }
    timed_out = timed_out && !(before && (d.state == AnswerState::missing || d.state == AnswerState::late));
    right_place = right_place && (q->offers == Question::Offers::listed || d.state == AnswerState::right);
    wrong += d.state != AnswerState::right;
    d.text = both(q->text, q->text_de);
    d.why = both(q->why, q->why_de);
    d.given_text = text_of_choice(*q, d.given);
    d.right_text = text_of_choice(*q, right);
    score.decisions.push_back(std::move(d));
  }
  if (score.decisions.empty()) return;
  const lesson::FourLimits& limits = *rubric.wrong_answers_count;
  row.score = limits.score(wrong);
  row.why = wrong == 0 ? texts::Phrase("all were answered rightly and in time")
                       : texts::Phrase("{} of {} were not answered rightly and in time",
                                       {std::to_string(wrong), std::to_string(score.decisions.size())});
  row.measured = {{"wrong_answers_count", double(wrong)}};
  row.limits = {{"five_count", limits.five},
                {"four_count", limits.four},
                {"three_count", limits.three},
                {"two_count", limits.two}};
  row.decided_s = decided_s;
  const char* missing = !timed_out     ? "the time-out was left out"
                        : !right_place ? "the time-out named another patient or task"
                                       : "";
  if (*missing) lower(row, 1, missing, facts.first_cut_s >= 0 ? facts.first_cut_s : decided_s);
  score.rows.push_back(std::move(row));
  if (!*missing || !score.unreached.empty()) return;
  score.unreached = missing;
  for (ScoreRow& r : score.rows)  // what was saved counts for those alone who completed it
    if (r.name == "time" && r.score) lower(r, 1, {"not completed: {}", {score.unreached}}, facts.first_cut_s);
}

}  // namespace trephine::lessons
