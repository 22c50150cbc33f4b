// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/time_row.h"

namespace trephine::lessons {

ScoreRow time_row(const LessonFacts& facts, const lesson::TimeRubric& r, const texts::Phrase& unfinished) {
  if (facts.from_scan) return {"time", "Time to complete procedure", {}, not_shown(facts), {}, {}, {}};
  const double time = facts.procedure_s();
  ScoreRow row{"time", "Time to complete procedure", 1, "", {{"procedure_s", time}}, {}, facts.end_s};
  if (facts.paused_s > 0) row.measured.emplace_back("paused_s", facts.paused_s);
  row.limits = {
      {"ideal_s", r.ideal_s}, {"good_s", r.good_s}, {"acceptable_s", r.acceptable_s}, {"allotted_s", r.allotted_s}};
  if (!unfinished.empty()) {
    row.why = {"not completed: {}", {unfinished}};
    return row;
  }
  row.score = time < r.ideal_s.limit         ? 5
              : time < r.good_s.limit        ? 4
              : time <= r.acceptable_s.limit ? 3
              : time <= r.allotted_s.limit   ? 2
                                             : 1;
  row.why = *row.score == 1 ? "not completed in the allotted time" : "completed";
  return row;
}

}  // namespace trephine::lessons
