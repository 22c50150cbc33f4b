// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/questions.h"

#include <algorithm>

#include "base/text.h"

namespace trephine::lesson {
namespace {

bool is_name(const std::string& s) {
  return !s.empty() && s.size() <= 32 && s.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == s.npos;
}
bool is_blank(const std::string& s) { return s.find_first_not_of(" \t\r\n") == s.npos; }

}  // namespace

std::string Question::fault() const {
  if (!is_name(question)) return "question: " + printable(question) + " is no name of a-z, 0-9 and _";
  if (is_blank(text)) return "text: is blank";
  if (is_blank(why)) return "why: is blank";
  if (offers != Offers::listed) return choices.empty() ? "" : "choices: follow from the case where `offers` says so";
  if (choices.size() < 2) return "choices: must be two at least";
  for (std::size_t n = 0; n < choices.size(); ++n) {
    if (!is_name(choices[n].choice))
      return "choices: " + printable(choices[n].choice) + " is no name of a-z, 0-9 and _";
    if (is_blank(choices[n].text)) return "choices: " + choices[n].choice + ": text is blank";
    for (std::size_t m = 0; m < n; ++m)
      if (choices[m].choice == choices[n].choice) return "choices: " + choices[n].choice + " is listed twice";
  }
  const auto right = std::count_if(choices.begin(), choices.end(), [](const QuestionChoice& c) { return c.right; });
  return right == 1 ? "" : "choices: " + std::to_string(right) + " are right, must be exactly one";
}

std::string questions_fault(const std::vector<Question>& questions, const std::vector<std::string>& errors) {
  std::size_t letters = 0;
  for (std::size_t n = 0; n < questions.size(); ++n) {
    const Question& q = questions[n];
    letters += q.question.size() + (q.offers == Question::Offers::listed ? 0 : 3 * 32);  // tokens and tasks
    for (const QuestionChoice& c : q.choices) letters += c.choice.size() + 1;
    if (letters > most_name_letters)
      return "questions: " + q.question + ": the names of questions and choices up to here have " +
             std::to_string(letters) + " letters, at most " + std::to_string(most_name_letters) + ": shorten them";
    const bool known = q.when == Question::before || q.when == Question::after ||
                       std::find(errors.begin(), errors.end(), q.when) != errors.end();
    if (!known)
      return "questions: " + q.question + ": when: " + printable(q.when) +
             " is neither before nor after, nor a critical error that the rubric lists";
    for (std::size_t m = 0; m < n; ++m)
      if (questions[m].question == q.question) return "questions: " + q.question + " is listed twice";
  }
  return "";
}

}  // namespace trephine::lesson
