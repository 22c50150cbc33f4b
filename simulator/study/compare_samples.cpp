// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "study/observations.h"

namespace trephine::study::detail {
namespace {

// A participant's values by level, and their means: an observation each.
using Values = std::map<std::string, std::vector<double>>;
double mean_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / double(v.size());
}

// Of so few no test tells anything of the groups that they come from.
constexpr std::size_t few = 3;
void note_few(Comparison& c) {
  for (const Sample& s : c.samples)
    if (!s.values.empty() && s.values.size() < few)
      c.notes.push_back(fmt::format("{} has {} value{}: this says nothing of others like {}", s.name, s.values.size(),
                                    s.values.size() == 1 ? "" : "s", s.values.size() == 1 ? "it" : "them"));
}

void tell_means(Comparison& c, std::size_t averaged) {
  if (averaged > 0)
    c.notes.push_back(fmt::format("{} {} stand{} for the mean of several rows of one participant", averaged,
                                  averaged == 1 ? "value" : "values", averaged == 1 ? "s" : ""));
}

Sample sample_of(const std::string& name, const Values& of, std::size_t& averaged) {
  Sample sample;
  sample.name = name;
  for (const auto& [participant, values] : of) {
    sample.values.push_back(mean_of(values));
    sample.owners.push_back(participant);
    averaged += values.size() > 1;
  }
  return sample;
}

std::optional<double> change(double from, double to) {
  if (from == 0) return std::nullopt;
  return (to - from) / std::abs(from);
}

// The p values of one kind of test over all pairs, corrected together.
void correct(Comparison& c, Correction correction) {
  std::map<std::string, std::vector<NamedTest*>> families;
  for (PairTests& pair : c.pairs)
    for (NamedTest& test : pair.tests)
      if (test.result.tested()) families[test.name].push_back(&test);
  for (auto& [name, tests] : families) {
    std::vector<double> p;
    for (const NamedTest* test : tests) p.push_back(test->result.p);
    const std::vector<double> by_all = corrected(p, correction);
    for (std::size_t n = 0; n < tests.size(); ++n) tests[n]->corrected_p = by_all[n];
  }
}

void add_independent(PairTests& pair, const Sample& first, const Sample& second, const StudyParams& params) {
  pair.tests.push_back({"Welch", welch_t(first.values, second.values, params.confidence_ratio), {}});
  pair.tests.push_back({"Mann-Whitney", mann_whitney(first.values, second.values, params.confidence_ratio), {}});
}

}  // namespace

Comparison compare_groups(const Observations& all, std::size_t measure, const std::string& phase,
                          const StudyParams& params) {
  Comparison c;
  c.by = "group";
  c.phase = phase;
  std::size_t averaged = 0;
  for (const std::string& group : all.groups) {
    Values values;
    Sample rows;
    rows.name = group;
    for (const Observation& o : all.rows) {
      if (o.group != group || !o.measures[measure] || (!phase.empty() && o.phase != phase)) continue;
      values[o.participant].push_back(*o.measures[measure]);
      rows.values.push_back(*o.measures[measure]);
    }
    c.samples.push_back(all.by_participant(params) ? sample_of(group, values, averaged) : rows);
    c.samples.back().summary = summarised(c.samples.back().values, params.confidence_ratio);
    if (c.samples.back().values.empty()) c.notes.push_back("group " + group + " has no value here");
  }
  tell_means(c, averaged);
  note_few(c);
  if (all.has_participants && !all.by_participant(params))
    c.notes.push_back("rows are taken as independent; where a participant has several, p is too small");
  std::vector<std::vector<double>> groups;
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < c.samples.size(); ++n)
    if (!c.samples[n].values.empty()) {
      groups.push_back(c.samples[n].values);
      places.push_back(n);
    }
  c.all = NamedTest{"Kruskal-Wallis", kruskal_wallis(groups, params.confidence_ratio), {}};
  const std::vector<DunnPair> by_ranks = groups.size() > 2 ? dunn(groups) : std::vector<DunnPair>{};
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (std::size_t b = a + 1; b < groups.size(); ++b) {
      PairTests pair;
      pair.first = places[a];
      pair.second = places[b];
      pair.change_ratio = change(c.samples[places[a]].summary.mean, c.samples[places[b]].summary.mean);
      add_independent(pair, c.samples[places[a]], c.samples[places[b]], params);
      // Of each two by their own ranks, as the dissertation did.
      if (groups.size() > 2)
        pair.tests.push_back({"Kruskal-Wallis", kruskal_wallis({groups[a], groups[b]}, params.confidence_ratio), {}});
      for (const DunnPair& d : by_ranks)
        if (d.first == a && d.second == b) {
          TestResult r;
          r.statistic = d.z;
          r.p = d.p;
          pair.tests.push_back({"Dunn", r, {}});
        }
      c.pairs.push_back(pair);
    }
  correct(c, params.correction);
  return c;
}

Comparison compare_within(const Observations& all, std::size_t measure, const std::string& by,
                          const std::vector<std::string>& levels, const StudyParams& params) {
  Comparison c;
  c.by = by;
  c.paired = true;
  std::map<std::string, Values> by_level;
  for (const Observation& o : all.rows)
    if (const std::string level = by == "phase" ? o.phase : std::to_string(o.attempt); o.measures[measure])
      by_level[level][o.participant].push_back(*o.measures[measure]);
  std::size_t averaged = 0;
  for (const std::string& level : levels) {
    c.samples.push_back(sample_of(level, by_level[level], averaged));
    c.samples.back().summary = summarised(c.samples.back().values, params.confidence_ratio);
  }
  tell_means(c, averaged);
  note_few(c);
  // Of phases all pairs; of attempts the first against the second and the last, as a trend has its own test.
  std::vector<std::pair<std::size_t, std::size_t>> chosen;
  if (by == "attempt") {
    chosen.push_back({0, 1});
    if (levels.size() > 2) chosen.push_back({0, levels.size() - 1});
  } else {
    for (std::size_t a = 0; a < levels.size(); ++a)
      for (std::size_t b = a + 1; b < levels.size(); ++b) chosen.push_back({a, b});
  }
  for (const auto& [a, b] : chosen) {
    PairTests pair;
    pair.first = a;
    pair.second = b;
    std::vector<double> first, second;
    std::vector<std::string> alone;
    const Values &from = by_level[levels[a]], &to = by_level[levels[b]];
    for (const auto& [participant, values] : from) {
      const auto at = to.find(participant);
      if (at == to.end()) {
        alone.push_back(participant);
        continue;
      }
      first.push_back(mean_of(values));
      second.push_back(mean_of(at->second));
    }
    for (const auto& [participant, values] : to)
      if (!from.count(participant)) alone.push_back(participant);
    if (!alone.empty())
      c.notes.push_back(fmt::format("{} {} to {}: {} in one of both alone, and {} no pair: {}", by, levels[a],
                                    levels[b],
                                    alone.size() == 1 ? "one participant is" : std::to_string(alone.size()) + " are",
                                    alone.size() == 1 ? "makes" : "make", some_of(alone)));
    pair.pairs_count = first.size();
    if (!first.empty()) pair.change_ratio = change(mean_of(first), mean_of(second));
    pair.tests.push_back({"paired t", paired_t(first, second, params.confidence_ratio), {}});
    pair.tests.push_back({"signed rank", signed_rank(first, second), {}});
    add_independent(pair, c.samples[a], c.samples[b], params);
    c.pairs.push_back(pair);
  }
  c.notes.push_back(
      "Welch and Mann-Whitney take both as independent samples, as the dissertation did; the paired tests "
      "are those that fit");
  correct(c, params.correction);
  return c;
}

LearningCurve curve_of(const Observations& all, std::size_t measure, const StudyParams& params) {
  LearningCurve curve;
  std::map<std::string, std::map<int, std::vector<double>>> by_participant;
  for (const Observation& o : all.rows)
    if (o.attempt > 0 && o.measures[measure]) by_participant[o.participant][o.attempt].push_back(*o.measures[measure]);
  std::map<int, std::vector<double>> by_attempt;
  std::vector<double> slopes;
  std::vector<std::string> single;
  for (const auto& [participant, attempts] : by_participant) {
    std::vector<std::pair<double, double>> points;
    std::vector<std::pair<int, double>> line;
    for (const auto& [attempt, values] : attempts) {
      points.emplace_back(std::log2(double(attempt)), mean_of(values));
      line.emplace_back(attempt, points.back().second);
      by_attempt[attempt].push_back(points.back().second);
    }
    curve.lines.push_back(line);
    if (const std::optional<double> slope = slope_of(points))
      slopes.push_back(*slope);
    else
      single.push_back(participant);
  }
  for (const auto& [attempt, values] : by_attempt)
    curve.points.push_back({attempt, summarised(values, params.confidence_ratio)});
  curve.slope = one_sample_t(slopes, params.confidence_ratio);
  if (!single.empty())
    curve.notes.push_back(fmt::format("{} made a single attempt, and {} no slope: {}",
                                      single.size() == 1 ? "one participant" : std::to_string(single.size()),
                                      single.size() == 1 ? "has" : "have", some_of(single)));
  if (curve.points.size() > 1 && curve.points.back().summary.count < curve.points.front().summary.count)
    curve.notes.push_back(fmt::format("{} made the first attempt and {} the last: the curve's ends are of other people",
                                      curve.points.front().summary.count, curve.points.back().summary.count));
  return curve;
}

}  // namespace trephine::study::detail
