// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "base/joined.h"
#include "lessons/lesson.h"

namespace trephine::lessons {
namespace {

bool ends_with(std::string_view name, std::string_view end) {
  return name.size() >= end.size() && name.substr(name.size() - end.size()) == end;
}

}  // namespace

const char* name_of(LessonOutcome outcome) {
  constexpr const char* names[] = {"not completed", "completed", "failed"};
  return names[int(outcome)];
}

const char* name_of(AnswerState state) {
  constexpr const char* names[] = {"not answered", "right", "wrong", "after the cut"};
  return names[int(state)];
}

const LessonFigure& LessonScore::figure(const std::string& name) const {
  for (const LessonFigure& f : figures)
    if (f.name == name) return f;
  throw Error(ExitCode::internal, "", name, "is a figure that the lesson does not have");
}

const ScoreRow* LessonScore::row(const std::string& name) const {
  for (const ScoreRow& r : rows)
    if (r.name == name) return &r;
  return nullptr;
}

const char* not_shown(const LessonFacts& facts) {
  return facts.from_volume ? "a drilled volume does not show it" : "a CT does not show it";
}

texts::Phrase unsaved_by(const texts::Phrase& missed, bool harmed) {
  return !missed.empty() ? missed : harmed ? "a critical error happened" : "";
}

void lower(ScoreRow& row, int score, const texts::Phrase& why, std::optional<double> at_s) {
  if (!row.score || score >= *row.score) return;
  row.score = score;
  row.why = why;
  row.decided_s = at_s;
}

void lower_by_speed(ScoreRow& row, const LessonFacts& facts, const std::optional<lesson::FourLimits>& limits) {
  if (!limits) return;
  row.measured.emplace_back("fastest_mm_per_s", facts.fastest_mm_per_s);
  row.limits.insert(row.limits.end(), {{"five_mm_per_s", limits->five},
                                       {"four_mm_per_s", limits->four},
                                       {"three_mm_per_s", limits->three},
                                       {"two_mm_per_s", limits->two}});
  lower(row, limits->score(facts.fastest_mm_per_s), "it went in too fast", facts.fastest_s);
}

void doubt_places(LessonScore& score, double place_error_mm) {
  for (ScoreRow& row : score.rows) {
    double least = 1e300;
    for (const auto& [name, limit] : row.limits)
      if (ends_with(name, "_mm") && limit.limit > 0) least = std::min(least, limit.limit);
    if (!row.score || !(least < place_error_mm)) continue;
    row.score.reset();
    row.decided_s.reset();
    row.why = {"the tool may have been {} mm off, and a limit is {} mm",
               {fmt::format("{:.1f}", place_error_mm), fmt::format("{:g}", least)}};
    score.advice.erase(
        std::remove_if(score.advice.begin(), score.advice.end(), [&](const Advice& a) { return a.row == row.name; }),
        score.advice.end());
  }
}

texts::Phrase doubtful(const texts::Phrase& what) { return {"{} of this case is doubtful", {what}}; }

std::vector<texts::Phrase> LessonScore::reasons() const {
  std::vector<texts::Phrase> all;
  for (const CriticalError& e : critical) all.push_back(e.what);
  if (critical.empty() && !unreached.empty()) all.push_back(unreached);
  return all;
}

std::string LessonScore::reason() const {
  return joined(reasons(), "; ", [](const texts::Phrase& r) { return r.english(); });
}

void CriticalErrors::happened(const std::string& error, const texts::Phrase& what, std::optional<double> at_s,
                              const SeenAt& seen) {
  above(error, 1e300, what, at_s, seen);
}

void CriticalErrors::above(const std::string& error, double figure, const texts::Phrase& what,
                           std::optional<double> at_s, const SeenAt& seen) {
  for (const CriticalError& e : score_.critical)
    if (e.rule.error == error) return;
  for (const lesson::CriticalRule& rule : rules_)
    if (rule.error == error && figure > rule.limit) score_.critical.push_back({what, rule, at_s, seen});
}

}  // namespace trephine::lessons
