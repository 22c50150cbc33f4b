// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/params.h"
#include "lesson/questions.h"

namespace trephine::lesson {

/// A rubric says by which limits a lesson is scored. It is data: configs/rubrics/*.yaml, which `trephine rubric`
/// compiles to the JSON that `trephine-sim score` reads. Every limit says where it comes from.

/// One limit; its unit is the end of its name.
struct RubricLimit {
  enum class From { none, thesis, ours };
  double limit = 0;
  From from = From::none;
  std::string why, why_de = {};
  template <class V>
  static void describe(V& v) {
    using P = RubricLimit;
    v.number(&P::limit, "limit", Range{0, 1e6}, "The limit, in the unit that its name ends in.").is_required();
    v.choice(&P::from, "from", {{"thesis", From::thesis}, {"ours", From::ours}},
             "Where it comes from: the dissertation, or our own choice.")
        .is_required();
    v.text(&P::why, "why", "The dissertation's table, or the reason for our choice.").is_required();
    v.text(&P::why_de, "why_de", "The same in German; a German page shows `why` where it is left out.");
  }
  std::string fault() const {
    return why.find_first_not_of(" \t\r\n") == std::string::npos ? "why: is blank" : std::string();
  }
};

/// What comes out of a patient or a tool.
enum class Fluid { none, venous_blood, arterial_blood, csf, air };

/// What a critical error leads to that is seen: it flows where the error happened, until the question that follows the
/// error is rightly answered.
struct Consequence {
  Fluid fluid = Fluid::none;
  RubricLimit ml_per_min;
  template <class V>
  static void describe(V& v) {
    using P = Consequence;
    v.choice(&P::fluid, "fluid",
             {{"venous_blood", Fluid::venous_blood},
              {"arterial_blood", Fluid::arterial_blood},
              {"csf", Fluid::csf},
              {"air", Fluid::air}},
             "What flows.")
        .is_required();
    v.group(&P::ml_per_min, "ml_per_min", "How much of it.").is_required();
  }
};

/// A critical error: a lesson in which it happened is failed, whatever the sum of its rows. A rubric lists those that
/// fail; what it does not list does not.
struct CriticalRule {
  std::string error;  ///< as the lesson calls it; its name ends in the limit's unit, where it has one
  double limit = 0;
  RubricLimit::From from = RubricLimit::From::none;
  std::string why, why_de = {};
  std::optional<Consequence> leads_to = {};
  template <class V>
  static void describe(V& v) {
    using P = CriticalRule;
    using From = RubricLimit::From;
    v.text(&P::error, "error", "The critical error, by a name that the lesson knows.").is_required();
    v.number(&P::limit, "limit", Range{0, 1e6}, "More than this is the error, where its name ends in a unit.");
    v.choice(&P::from, "from", {{"thesis", From::thesis}, {"ours", From::ours}},
             "Where it comes from: the dissertation, or our own choice.")
        .is_required();
    v.text(&P::why, "why", "The dissertation's table, or the reason for our choice.").is_required();
    v.text(&P::why_de, "why_de", "The same in German; a German page shows `why` where it is left out.");
    v.group(&P::leads_to, "leads_to", "What is seen of it in a window.");
  }
};
/// "Time to complete procedure".
struct TimeRubric {
  RubricLimit ideal_s, good_s, acceptable_s, allotted_s;
  template <class V>
  static void describe(V& v) {
    using P = TimeRubric;
    v.group(&P::ideal_s, "ideal_s", "Less than this scores 5.").is_required();
    v.group(&P::good_s, "good_s", "Less than this scores 4.").is_required();
    v.group(&P::acceptable_s, "acceptable_s", "Up to this scores 3.").is_required();
    v.group(&P::allotted_s, "allotted_s", "Up to this scores 2, beyond it 1.").is_required();
  }
  std::string fault() const;
};

/// The name of the first limit that is below the one before it, as a struct's fault() says it; "" where they ascend.
std::string descending_limit(const std::vector<std::pair<const char*, double>>& limits);

/// Four limits of one figure: up to the first scores 5, up to the second 4, and so on; beyond the last 1.
struct FourLimits {
  RubricLimit five, four, three, two;
  std::string fault() const {
    return descending_limit({{"five", five.limit}, {"four", four.limit}, {"three", three.limit}, {"two", two.limit}});
  }
  int score(double value) const {
    return value <= five.limit ? 5 : value <= four.limit ? 4 : value <= three.limit ? 3 : value <= two.limit ? 2 : 1;
  }
  template <class V>
  static void describe(V& v) {
    using P = FourLimits;
    v.group(&P::five, "five", "Up to this scores 5.").is_required();
    v.group(&P::four, "four", "Up to this scores 4.").is_required();
    v.group(&P::three, "three", "Up to this scores 3.").is_required();
    v.group(&P::two, "two", "Up to this scores 2, beyond it 1.").is_required();
  }
};

/// The other hand, where there is one: how hard it pressed on what it must spare, and the blood that was left where it
/// bled.
struct SecondHandRubric {
  FourLimits force_n, blood_left_ml;
  template <class V>
  static void describe(V& v) {
    using P = SecondHandRubric;
    v.group(&P::force_n, "force_n", "Its largest force on what it must spare.").is_required();
    v.group(&P::blood_left_ml, "blood_left_ml", "What suction left at the end of what a critical error bled.")
        .is_required();
  }
};

/// What every lesson's rubric has beside its own limits; a lesson's rubric derives from it.
struct LessonRubric {
  std::vector<CriticalRule> critical_errors;
  std::vector<Question> questions;
  std::optional<FourLimits> wrong_answers_count;
  std::optional<SecondHandRubric> second_hand;
  template <class V>
  static void describe(V& v) {
    using P = LessonRubric;
    v.list(&P::critical_errors, "critical_errors", "What fails a lesson, whatever the sum.").at_most(16);
    v.list(&P::questions, "questions", "What the participant is asked.").at_most(most_questions).not_always();
    v.group(&P::wrong_answers_count, "wrong_answers_count",
            "How many questions were not answered rightly and in time: the row of decisions.");
    v.group(&P::second_hand, "second_hand", "A second hand's tool: the row of the other hand.");
  }
  /// `known`: the critical errors that the lesson knows.
  std::string fault(const std::vector<std::string>& known) const;
};

/// The rubric of a lesson: what its folder declares (simulator/lessons/rubric_types.h).
struct RubricType {
  std::string module;  ///< as the rubric's own key `module` says
  AnyParams (*make)() = nullptr;
  const LessonRubric& (*common)(const AnyParams&) = nullptr;
};
template <class R>
RubricType rubric_type(const char* module) {
  return {module, [] { return AnyParams::make<R>(); },
          [](const AnyParams& rubric) -> const LessonRubric& { return rubric.as<R>(); }};
}

/// The compiled rubric: JSON of all values, with a version and the SHA-256 of what it says. Version 1 had no critical
/// errors; such a file is read as before, and fails nobody.
std::string compile_rubric(const AnyParams& rubric);

struct CompiledRubric {
  std::string module;
  AnyParams rubric;
  std::string sha256;
  const LessonRubric* common = nullptr;  ///< of `rubric`, which keeps it
};
/// Throws Error 65, naming the field, where it is no compiled rubric, of another version, of a lesson that is not
/// `known`, changed since it was compiled, or says what the declaration does not allow.
CompiledRubric read_rubric(std::string_view json, const std::vector<RubricType>& known);

}  // namespace trephine::lesson
