// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lesson/rubric.h"
#include "lessons/directions.h"
#include "lessons/lesson_text.h"
#include "texts/phrase.h"

namespace trephine::lessons {

struct LessonFacts;
struct LessonScore;

/// One row of a rubric's table.
struct ScoreRow {
  std::string name, title;
  std::optional<int> score;                              ///< 1 to 5; none: not judged
  texts::Phrase why;                                     ///< what of the table applies, or why it is not judged
  std::vector<std::pair<std::string, double>> measured;  ///< by names that end in the unit
  std::vector<std::pair<std::string, lesson::RubricLimit>> limits;  ///< those by which it was decided
  std::optional<double> decided_s;  ///< when in the recording; none: nothing ever happened that could decide it
  bool beside = false;              ///< ours, beside the rows of a printed table
};

/// What the table does not score, and studies count: yes or no, a count, or a measure whose name ends in its unit.
struct LessonFigure {
  std::string name;
  std::variant<bool, int, double, std::monostate> value;  ///< nothing where it could not be judged
};

/// An open way from what was hurt to where a surgeon sees it.
struct Wound {
  Vec3 source_mm, mouth_mm;
  double width_mm = 5;
};
/// Where what a critical error leads to is seen: in an open wound, or at the end of a hollow tool as long as its tip is
/// in that haptic shape (0: none).
struct SeenAt {
  std::optional<Wound> wound;
  int shape = 0;
};

/// A critical error that happened.
struct CriticalError {
  texts::Phrase what;  ///< "the needle came through the front of the vertebra"
  lesson::CriticalRule rule;
  std::optional<double> at_s;
  SeenAt seen;
};

/// late: after the patient was cut, of a question that comes before that.
enum class AnswerState { missing, right, wrong, late };
const char* name_of(AnswerState state);

/// What was asked and what was answered, with the texts in each language of texts/language.h.
struct Decision {
  std::string question, when;  ///< as the rubric has them
  std::string given;           ///< the answer's name; empty: none
  AnswerState state = AnswerState::missing;
  std::optional<double> at_s;
  LessonText text, given_text, right_text, why;
};

/// failed: a critical error happened, whatever the sum. completed: the goal was reached, and nothing of that sort.
enum class LessonOutcome { not_completed, completed, failed };
const char* name_of(LessonOutcome outcome);

/// Why nothing that was saved (passes, X-rays, time) or spared counts in rows of ours: what was missed, or else that
/// harm was done by a critical error; empty: it counts.
texts::Phrase unsaved_by(const texts::Phrase& missed, bool harmed);

/// Lowers a row that is judged to that score, for that reason, where it is above it.
void lower(ScoreRow& row, int score, const texts::Phrase& why, std::optional<double> at_s);
/// The same by how fast a tool went into the patient, with the figure and its limits; nothing without limits.
void lower_by_speed(ScoreRow& row, const LessonFacts& facts, const std::optional<lesson::FourLimits>& mm_per_s);

/// Takes the points, and the advice, from rows of which a limit in mm is smaller than how far the tool may really have
/// been from its poses (RecordingHeader::place_error_mm): these are not judged. Limits of 0 and speeds do not count.
void doubt_places(LessonScore& score, double place_error_mm);
/// Why a row is not judged that was measured on a CT after a procedure, or on a volume that another program drilled.
const char* not_shown(const LessonFacts& facts);
/// Why a row is not judged: what the case does not know well enough.
texts::Phrase doubtful(const texts::Phrase& what);

struct LessonScore {
  std::vector<ScoreRow> rows;
  std::vector<CriticalError> critical;
  std::vector<Decision> decisions;  ///< in the order of the recording; those that were asked
  texts::Phrase unreached;          ///< why the lesson's goal was not reached; empty: it was
  LessonOutcome outcome() const {
    return !critical.empty()   ? LessonOutcome::failed
           : unreached.empty() ? LessonOutcome::completed
                               : LessonOutcome::not_completed;
  }
  /// unsaved_by() of the lesson's goal and its critical errors.
  texts::Phrase unsaved() const { return unsaved_by(unreached, !critical.empty()); }
  /// The reasons: of a failure all critical errors, of what is not completed what is missing; else none.
  std::vector<texts::Phrase> reasons() const;
  std::string reason() const;  ///< the same in English, with semicolons between
  std::vector<LessonFigure> figures;
  std::vector<Advice> advice;  ///< of the rows that lost points by a place or a direction, in their order
  const ScoreRow* row(const std::string& name) const;  ///< null where there is none of that name
  /// Whether that row was judged and lost points, so that it is worth an advice.
  bool lost(const std::string& name) const { return row(name) && row(name)->score && *row(name)->score < 5; }
  /// The figure of that name; throws Error 70 where the module has none.
  const LessonFigure& figure(const std::string& name) const;
  bool known(const std::string& name) const { return !std::holds_alternative<std::monostate>(figure(name).value); }
  bool flag(const std::string& name) const { return std::get<bool>(figure(name).value); }
  int count(const std::string& name) const { return std::get<int>(figure(name).value); }
};

/// Notes critical errors in a score, each once, where the rubric lists them.
class CriticalErrors {
 public:
  CriticalErrors(const std::vector<lesson::CriticalRule>& rules, LessonScore& score) : rules_(rules), score_(score) {}
  /// It happened, at that moment of the recording.
  void happened(const std::string& error, const texts::Phrase& what, std::optional<double> at_s,
                const SeenAt& seen = {});
  /// It happened where the figure is above the rule's limit.
  void above(const std::string& error, double figure, const texts::Phrase& what, std::optional<double> at_s,
             const SeenAt& seen = {});

 private:
  const std::vector<lesson::CriticalRule>& rules_;
  LessonScore& score_;
};

}  // namespace trephine::lessons
