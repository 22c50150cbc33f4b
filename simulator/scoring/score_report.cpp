// SPDX-License-Identifier: GPL-3.0-or-later
#include "scoring/score_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }
Json moment(double time_s) { return time_s < 0 ? Json(nullptr) : Json(time_s); }

Json json_of(const ScoreRow& row) {
  Json measured = Json::object(), limits = Json::object();
  for (const auto& [name, value] : row.measured) measured[name] = value;
  for (const auto& [name, l] : row.limits)
    limits[name] = {
        {"limit", l.limit}, {"from", l.from == RubricLimit::From::thesis ? "thesis" : "ours"}, {"why", l.why}};
  return {
      {"name", row.name}, {"title", row.title},   {"score", row.score ? Json(*row.score) : Json("not judged")},
      {"why", row.why},   {"measured", measured}, {"decided_s", row.decided_s ? Json(*row.decided_s) : Json(nullptr)},
      {"limits", limits}};
}

Json json_of(const VentriculostomyFacts& f) {
  Json traces = Json::array(), incisions = Json::array(), passes = Json::array();
  for (const MarkerTrace& t : f.traces)
    traces.push_back({{"begin_s", t.begin_s},
                      {"end_s", t.end_s},
                      {"length_mm", t.length_mm},
                      {"erased", t.erased},
                      {"from_mm", list_of(t.points_mm.front())},
                      {"to_mm", list_of(t.points_mm.back())}});
  for (const LessonIncision& i : f.incisions) incisions.push_back({{"time_s", i.time_s}, {"at_mm", list_of(i.at_mm)}});
  for (const CatheterPass& p : f.passes)
    passes.push_back({{"begin_s", p.begin_s},
                      {"end_s", p.end_s},
                      {"entry_mm", list_of(p.entry_mm)},
                      {"tip_mm", list_of(p.path.back().tip_mm)},
                      {"csf_s", moment(p.csf_s)},
                      {"in_place", p.in_place}});
  Json out = {{"end", name_of(f.end)},
              {"begin_s", f.begin_s},
              {"end_s", f.end_s},
              {"procedure_s", f.procedure_s()},
              {"paused_s", f.paused_s},
              {"pauses", f.pauses},
              {"most_force_n", f.most_force_n},
              {"drilled_beforehand", f.drilled_beforehand},
              {"traces", traces},
              {"incisions", incisions},
              {"drill_begin_s", moment(f.drill_begin_s)},
              {"drill_s", f.drill_s},
              {"through_s", moment(f.through_s)},
              {"hole", nullptr},
              {"passes", passes}};
  if (f.hole)
    out["hole"] = {{"outer_mm", list_of(f.hole->outer_mm)},
                   {"inner_mm", list_of(f.hole->inner_mm)},
                   {"out", list_of(f.hole->out)},
                   {"removed_mm3", f.hole->removed_mm3},
                   {"through", f.hole->through},
                   {"drilled", f.hole->drilled}};
  return out;
}

}  // namespace

ScoreSum sum_of(const LessonScore& score) {
  ScoreSum sum;
  for (const ScoreRow& row : score.rows)
    if (row.score) {
      sum.points += *row.score;
      sum.most += 5;
    }
  return sum;
}

std::string score_json(const ReportHead& head, const VentriculostomyFacts& facts, const LessonScore& score) {
  Json rows = Json::array();
  for (const ScoreRow& row : score.rows) rows.push_back(json_of(row));
  const LessonFigures& f = score.figures;
  const ScoreSum sum = sum_of(score);
  const Json out = {{"trephine_score", 1},
                    {"module", head.module},
                    {"case", head.case_token},
                    {"participant", head.participant},
                    {"recording_sha256", head.recording_sha256},
                    {"haptic_sha256", head.case_sha256},
                    {"rubric_sha256", head.rubric_sha256},
                    {"points", sum.points},
                    {"most_points", sum.most},
                    {"rows", rows},
                    {"figures",
                     {{"passes_count", f.passes_count},
                      {"in_ventricle", f.in_ventricle},
                      {"first_pass", f.first_pass},
                      {"contralateral", f.contralateral},
                      {"third_ventricle", f.third_ventricle}}},
                    {"facts", json_of(facts)}};
  return out.dump(1) + "\n";
}

std::string score_text(const VentriculostomyFacts& facts, const LessonScore& score) {
  std::string text;
  for (const ScoreRow& row : score.rows) {
    text += fmt::format("{:<33} {:>10}  {}", row.title, row.score ? std::to_string(*row.score) : "not judged", row.why);
    std::string figures;
    for (const auto& [name, value] : row.measured)
      figures += fmt::format("{}{} {:.1f}", figures.empty() ? "" : ", ", name, value);
    if (!figures.empty()) text += " (" + figures + ")";
    if (row.decided_s) text += fmt::format(", at {:.1f} s", *row.decided_s);
    text += "\n";
  }
  const ScoreSum sum = sum_of(score);
  text += fmt::format("{} of {} points; {}, catheter passes: {}, {}\n", sum.points, sum.most, name_of(facts.end),
                      score.figures.passes_count,
                      score.figures.first_pass     ? "success at the first pass"
                      : score.figures.in_ventricle ? "the catheter lies in a ventricle"
                                                   : "the catheter lies in no ventricle");
  return text;
}

}  // namespace trephine
