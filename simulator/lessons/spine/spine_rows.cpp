// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_rows.h"

namespace trephine::lessons {

ScoreRow four_limits_row(const char* name, const char* title, const lesson::FourLimits& limits,
                         const std::string& unit) {
  ScoreRow r;
  r.name = name;
  r.title = title;
  r.limits = {{"five_" + unit, limits.five},
              {"four_" + unit, limits.four},
              {"three_" + unit, limits.three},
              {"two_" + unit, limits.two}};
  return r;
}

ScoreRow exposure_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits, const texts::Phrase& nowhere) {
  ScoreRow r = four_limits_row("exposure", "Fluoroscopic exposure", limits, "s");
  if (facts.from_scan) return r.why = not_shown(facts), r;
  r.measured = {{"exposure_s", facts.exposure_s()}, {"shots_count", double(facts.shots.size())}};
  r.score = facts.shots.empty() || !nowhere.empty() ? 1 : limits.score(facts.exposure_s());
  r.why = facts.shots.empty() ? "no picture was taken" : nowhere.empty() ? "X-rays were on" : nowhere;
  if (!facts.shots.empty()) r.decided_s = facts.shots.back().end_s;
  if (!facts.shots.empty() && nowhere.empty())
    if (const std::optional<double> blind_s = facts.blind_s())
      lower(r, 1, "the tool went into bone without a picture before", *blind_s);
  return r;
}

int entries_count(const SpineNeedleFacts& facts) { return int(facts.passes.size()) + facts.empty_punctures(); }

ScoreRow bone_passes_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits, const char* title,
                         const std::optional<lesson::FourLimits>& mm_per_s, const texts::Phrase& nowhere) {
  ScoreRow r = four_limits_row("passes", title, limits, "count");
  if (facts.from_scan) return r.why = not_shown(facts), r;
  const int count = int(facts.passes.size()), empty = facts.empty_punctures();
  r.measured = {{"passes_count", double(count)}, {"punctures_count", double(empty)}};
  r.score = nowhere.empty() ? limits.score(entries_count(facts)) : 1;
  r.why = !nowhere.empty() ? nowhere
          : empty > 0      ? "punctures that met no bone count too"
                           : "times that a tool entered bone";
  if (count > 0) r.decided_s = facts.passes.back().begin_s;
  lower_by_speed(r, facts, mm_per_s);
  return r;
}

ScoreRow spine_time_row(const SpineNeedleFacts& facts, const lesson::FourLimits& limits,
                        const texts::Phrase& unreached) {
  ScoreRow r = four_limits_row("time", "Time to complete procedure", limits, "s");
  if (facts.from_scan) return r.why = not_shown(facts), r;
  const double time_s = facts.procedure_s();
  r.measured = {{"procedure_s", time_s}};
  if (facts.paused_s > 0) r.measured.emplace_back("paused_s", facts.paused_s);
  r.decided_s = facts.end_s;
  r.score = unreached.empty() ? limits.score(time_s) : 1;
  if (unreached.empty())
    r.why = "completed";
  else if (time_s > limits.two.limit)
    r.why = "not completed in the allotted time";
  else
    r.why = {"not completed: {}", {unreached}};
  return r;
}

}  // namespace trephine::lessons
