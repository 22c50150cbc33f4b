// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/params.h"

namespace trephine::lesson {

/// What a lesson asks its participant, with the right answer: data of a rubric, in two languages. Before the first cut
/// (the time-out), before the lesson's end, or after a critical error, as its consequence with what to do next.

/// One of the answers that a question offers.
struct QuestionChoice {
  std::string choice, text, text_de;
  bool right = false;
  template <class V>
  static void describe(V& v) {
    using P = QuestionChoice;
    v.text(&P::choice, "choice", "Its name, as recordings and scripts have it: a-z, 0-9 and _.").is_required();
    v.text(&P::text, "text", "The answer in English.").is_required();
    v.text(&P::text_de, "text_de", "The answer in German; a German page shows `text` where it is left out.");
    v.flag(&P::right, "right", "Whether it is right; exactly one is.");
  }
};

constexpr std::size_t most_questions = 16, most_choices = 8;
/// Letters of all their names together, which a recording's header holds.
constexpr std::size_t most_name_letters = 1000;

struct Question {
  /// What is offered: the choices that are listed; the token of the case beside others; the task of the lesson beside
  /// others that the case offers. Of the last two the right one follows from the case and from what is asked for.
  enum class Offers { listed, patient, task };
  static constexpr const char *before = "before", *after = "after";

  std::string question, when;
  Offers offers = Offers::listed;
  std::string text, text_de, why, why_de;
  std::vector<QuestionChoice> choices;
  template <class V>
  static void describe(V& v) {
    using P = Question;
    v.text(&P::question, "question", "Its name, as recordings and scripts have it: a-z, 0-9 and _.").is_required();
    v.text(
         &P::when, "when",
         "before: it is to be answered before anything is cut or pierced; after: before the lesson is finished; or the "
         "name of a critical error that the rubric lists: once that has happened.")
        .is_required();
    v.choice(&P::offers, "offers", {{"listed", Offers::listed}, {"patient", Offers::patient}, {"task", Offers::task}},
             "The answers: those that are listed; the case's token among others; what is asked for among what the case "
             "offers beside it.");
    v.text(&P::text, "text", "The question in English.").is_required();
    v.text(&P::text_de, "text_de", "The question in German; a German page shows `text` where it is left out.");
    v.text(&P::why, "why", "Why the right answer is right.").is_required();
    v.text(&P::why_de, "why_de", "The same in German.");
    v.list(&P::choices, "choices", "The answers of a question that lists them.").at_most(most_choices);
  }
  std::string fault() const;
};

/// What is wrong with such a list, as a struct's fault() says it; "": nothing. `errors`: the critical errors that the
/// rubric lists.
std::string questions_fault(const std::vector<Question>& questions, const std::vector<std::string>& errors);

}  // namespace trephine::lesson
