// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "study/study.h"
#include "study/words.h"

namespace trephine::study {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); }
Json json_of(const std::optional<Interval>& i) { return i ? Json{{"low", i->low}, {"high", i->high}} : Json(nullptr); }
Json json_of(const std::optional<Estimate>& e) {
  return e ? Json{{"value", e->value}, {"interval", json_of(e->interval)}} : Json(nullptr);
}
Json json_of(const Summary& s) {
  Json out = {{"n", s.count}};
  if (s.count > 0)
    out.update({{"mean", s.mean},
                {"mean_interval", json_of(s.mean_interval)},
                {"sd", json_of(s.sd)},
                {"least", s.least},
                {"lower_quartile", s.lower_quartile},
                {"median", s.median},
                {"upper_quartile", s.upper_quartile},
                {"most", s.most}});
  return out;
}
Json json_of(const NamedTest& t) {
  Json out = {{"test", t.name}};
  const TestResult& r = t.result;
  if (!r.tested()) {
    out["not_tested"] = r.why_not;
    return out;
  }
  out.update({{"statistic", r.statistic},
              {"degrees", json_of(r.degrees)},
              {"p", r.p},
              {"corrected_p", json_of(t.corrected_p)},
              {"difference", json_of(r.difference)},
              {"effect", effect_name(t.name)},
              {"effect_size", json_of(r.effect)},
              {"note", r.note}});
  return out;
}
Json json_of(const Comparison& c) {
  Json samples = Json::array(), pairs = Json::array();
  for (const Sample& s : c.samples) {
    Json one = {{"name", s.name}};
    one.update(json_of(s.summary));
    samples.push_back(one);
  }
  for (const PairTests& p : c.pairs) {
    Json tests = Json::array();
    for (const NamedTest& t : p.tests) tests.push_back(json_of(t));
    Json one = {{"first", c.samples[p.first].name}, {"second", c.samples[p.second].name}};
    if (c.paired) one["pairs"] = p.pairs_count;
    one["mean_change_ratio"] = json_of(p.change_ratio);
    one["tests"] = tests;
    pairs.push_back(one);
  }
  return {{"by", c.by},
          {"within", c.within()},
          {"paired", c.paired},
          {"samples", samples},
          {"all", c.all ? json_of(*c.all) : Json(nullptr)},
          {"pairs", pairs},
          {"notes", c.notes}};
}

const char* name_of(Correction c) {
  return c == Correction::holm ? "holm" : c == Correction::bonferroni ? "bonferroni" : "none";
}

std::string cell(const std::optional<double>& v) { return v ? to_text(*v) : ""; }

}  // namespace

std::string study_json(const Study& study) {
  Json measures = Json::array(), acceptable = Json::array();
  for (const MeasureStudy& m : study.measures) {
    Json comparisons = Json::array();
    for (const Comparison& c : m.comparisons) comparisons.push_back(json_of(c));
    Json one = {{"measure", m.name}, {"values", m.values_count}, {"notes", m.notes}, {"comparisons", comparisons}};
    if (m.curve) {
      Json points = Json::array();
      for (const CurvePoint& p : m.curve->points) {
        Json point = {{"attempt", p.attempt}};
        point.update(json_of(p.summary));
        points.push_back(point);
      }
      one["learning_curve"] = {{"points", points},
                               {"slope_over_log2_attempt", json_of(NamedTest{"one-sample t", m.curve->slope, {}})},
                               {"notes", m.curve->notes}};
    }
    measures.push_back(one);
  }
  for (const AcceptableRow& r : study.acceptable)
    acceptable.push_back({{"group", r.name},
                          {"acceptable", r.acceptable},
                          {"n", r.all},
                          {"share_ratio", r.share()},
                          {"share_interval", json_of(std::optional<Interval>(r.interval))},
                          {"more_points_percent", r.more_points_percent},
                          {"relative_change_ratio", json_of(r.relative_ratio)},
                          {"fisher_p", json_of(r.fisher_p)},
                          {"corrected_p", json_of(r.corrected_p)}});
  Json out = {{"trephine_study", 1},
              {"rows", study.rows_count},
              {"participants", study.participants_count},
              {"confidence_ratio", study.params.confidence_ratio},
              {"correction", name_of(study.params.correction)},
              {"notes", study.notes},
              {"measures", measures}};
  if (!study.acceptable.empty()) out["acceptable"] = acceptable;
  for (const AcceptableChange& c : study.acceptable_changes)
    out["acceptable_changes"].push_back({{"from", c.from},
                                         {"to", c.to},
                                         {"pairs", c.pairs_count},
                                         {"gained", c.gained},
                                         {"lost", c.lost},
                                         {"mcnemar_p", json_of(c.mcnemar_p)},
                                         {"corrected_p", json_of(c.corrected_p)}});
  return out.dump(1) + "\n";
}

std::string study_csv(const Study& study) {
  Table t;
  t.columns = {"measure",     "by",         "within",         "first",           "second",  "test",
               "n_first",     "n_second",   "pairs",          "statistic",       "degrees", "p",
               "corrected_p", "difference", "difference_low", "difference_high", "effect",  "effect_low",
               "effect_high", "note"};
  const auto add = [&](const MeasureStudy& m, const std::string& by, const std::string& within,
                       std::vector<std::string> ends, const NamedTest& test) {
    const TestResult& r = test.result;
    std::vector<std::string> row = {m.name, by, within, ends[0], ends[1], test.name, ends[2], ends[3], ends[4]};
    const auto estimate = [&](const std::optional<Estimate>& e) {
      row.push_back(e ? to_text(e->value) : "");
      row.push_back(e && e->interval ? to_text(e->interval->low) : "");
      row.push_back(e && e->interval ? to_text(e->interval->high) : "");
    };
    row.push_back(r.tested() ? to_text(r.statistic) : "");
    row.push_back(cell(r.degrees));
    row.push_back(r.tested() ? to_text(r.p) : "");
    row.push_back(cell(test.corrected_p));
    estimate(r.difference);
    estimate(r.effect);
    row.push_back(r.tested() ? r.note : "not tested: " + r.why_not);
    t.rows.push_back(row);
  };
  for (const MeasureStudy& m : study.measures) {
    for (const Comparison& c : m.comparisons) {
      if (c.all) add(m, c.by, c.within(), {"", "", "", "", ""}, *c.all);
      for (const PairTests& p : c.pairs)
        for (const NamedTest& test : p.tests) {
          const Sample &first = c.samples[p.first], &second = c.samples[p.second];
          add(m, c.by, c.within(),
              {first.name, second.name, std::to_string(first.summary.count), std::to_string(second.summary.count),
               c.paired ? std::to_string(p.pairs_count) : ""},
              test);
        }
    }
    if (m.curve) add(m, "attempt", "", {"", "", "", "", ""}, {"slope over log2 attempt", m.curve->slope, {}});
  }
  return table_csv(t);
}

}  // namespace trephine::study
