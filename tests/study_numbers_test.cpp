// SPDX-License-Identifier: GPL-3.0-or-later
// Every number of an evaluation against R's, to 1e-9 of its size (tests/data/study/expected.R).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "study/numbers.h"

namespace {

using namespace trephine::study;
const std::string folder = TREPHINE_SOURCE_DIR "/tests/data/study/";

std::vector<std::pair<std::string, double>> pairs_of(const std::string& file) {
  std::ifstream in(folder + file);
  std::vector<std::pair<std::string, double>> out;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    const std::size_t comma = line.find(',');
    out.emplace_back(line.substr(0, comma), std::stod(line.substr(comma + 1)));
  }
  return out;
}

const std::map<std::string, std::vector<double>>& samples() {
  static const auto all = [] {
    std::map<std::string, std::vector<double>> s;
    for (const auto& [name, value] : pairs_of("samples.csv")) s[name].push_back(value);
    return s;
  }();
  return all;
}
std::vector<double> sample(char name) { return samples().at(std::string(1, name)); }

// Every value of R must be asked for.
class Expected {
 public:
  Expected() {
    for (const auto& [name, value] : pairs_of("expected.csv")) values_[name] = value;
  }
  void near(const std::string& name, double value) {
    ASSERT_TRUE(values_.count(name)) << name;
    const double r = values_[name];
    EXPECT_LE(std::abs(value - r), 1e-9 * std::max(1.0, std::abs(r))) << name << ": " << value << ", R: " << r;
    if (std::abs(r) < 1e-3 && r != 0) EXPECT_LE(std::abs(value / r - 1), 1e-9) << name << ": " << value;
    asked_.insert(name);
  }
  void all_of(const std::string& prefix) {
    for (const auto& [name, value] : values_)
      if (name.rfind(prefix, 0) == 0) EXPECT_TRUE(asked_.count(name)) << name << " was not compared";
  }

 private:
  std::map<std::string, double> values_;
  std::set<std::string> asked_;
};

void near_estimate(Expected& r, const std::string& name, const std::string& value, const Estimate& e) {
  r.near(name + value, e.value);
  const std::string end = value == "difference" ? "" : value + "_";
  r.near(name + end + "low", e.interval->low);
  r.near(name + end + "high", e.interval->high);
}
void near_t(Expected& r, const std::string& name, const TestResult& t) {
  ASSERT_TRUE(t.tested()) << name;
  r.near(name + "t", t.statistic);
  r.near(name + "df", *t.degrees);
  r.near(name + "p", t.p);
  near_estimate(r, name, "difference", *t.difference);
  near_estimate(r, name, "d", *t.effect);
}

TEST(StudyNumbers, SummariesAreR) {
  Expected r;
  for (const auto& [name, values] : samples()) {
    const Summary s = summarised(values, 0.95);
    const std::string n = "summary." + name + ".";
    r.near(n + "mean", s.mean);
    r.near(n + "sd", *s.sd);
    r.near(n + "q1", s.lower_quartile);
    r.near(n + "median", s.median);
    r.near(n + "q3", s.upper_quartile);
    r.near(n + "low", s.mean_interval->low);
    r.near(n + "high", s.mean_interval->high);
  }
  r.all_of("summary.");
}

TEST(StudyNumbers, PairedTestsAreR) {
  Expected r;
  for (const char* pair : {"ab", "cd", "ef"}) {
    near_t(r, std::string("paired.") + pair + ".", paired_t(sample(pair[0]), sample(pair[1]), 0.95));
    const TestResult w = signed_rank(sample(pair[0]), sample(pair[1]));
    const std::string n = std::string("signed.") + pair + ".";
    r.near(n + "v", w.statistic);
    // R takes the normal distribution where differences are tied; of few pairs we take all ways (below).
    if (w.note.rfind("exact, given", 0) != 0) r.near(n + "p", w.p);
    r.near(n + "r", w.effect->value);
  }
  r.all_of("paired.");
}

TEST(StudyNumbers, TwoSampleTestsAreR) {
  Expected r;
  for (const char* pair : {"ab", "cd", "ef", "gh", "ij"}) {
    near_t(r, std::string("welch.") + pair + ".", welch_t(sample(pair[0]), sample(pair[1]), 0.95));
    const TestResult w = mann_whitney(sample(pair[0]), sample(pair[1]), 0.95);
    const std::string n = std::string("mann.") + pair + ".";
    r.near(n + "u", w.statistic);
    if (w.note.rfind("exact, given", 0) != 0) r.near(n + "p", w.p);
    near_estimate(r, n, "delta", *w.effect);
  }
  r.all_of("welch.");
}

TEST(StudyNumbers, KruskalWallisAndDunnAreR) {
  Expected r;
  for (const std::string names : {"abe", "cdi", "gh", "afij"}) {
    std::vector<std::vector<double>> groups;
    for (const char name : names) groups.push_back(sample(name));
    const TestResult k = kruskal_wallis(groups, 0.95);
    const std::string n = "kruskal." + names + ".", d = "dunn." + names + ".";
    r.near(n + "h", k.statistic);
    r.near(n + "df", *k.degrees);
    r.near(n + "p", k.p);
    near_estimate(r, n, "epsilon", *k.effect);
    std::vector<double> p;
    const std::vector<DunnPair> pairs = dunn(groups);
    for (const DunnPair& one : pairs) p.push_back(one.p);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const std::string at = std::to_string(i + 1);
      r.near(d + "z" + at, pairs[i].z);
      r.near(d + "p" + at, p[i]);
      r.near(d + "holm" + at, corrected(p, Correction::holm)[i]);
      r.near(d + "bonferroni" + at, corrected(p, Correction::bonferroni)[i]);
    }
  }
  r.all_of("kruskal.");
  r.all_of("dunn.");
}

TEST(StudyNumbers, SharesAreR) {
  Expected r;
  const std::size_t some[] = {17, 20, 24}, all[] = {26, 24, 26};
  for (int n = 0; n < 3; ++n) {
    const Interval i = share_interval(some[n], all[n], 0.95);
    r.near("share." + std::to_string(n + 1) + ".low", i.low);
    r.near("share." + std::to_string(n + 1) + ".high", i.high);
  }
  r.near("fisher.12", fisher_p(some[0], all[0], some[1], all[1]));
  r.near("fisher.13", fisher_p(some[0], all[0], some[2], all[2]));
  r.near("fisher.23", fisher_p(some[1], all[1], some[2], all[2]));
  r.all_of("share.");
  r.all_of("fisher.");
}

// Twice the smaller tail over all signs, or over all choices of as many, each as likely; ranks of ties at their mean.
double share_of_signs(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  std::vector<double> ranks(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const double a = std::abs(differences[i]), b = std::abs(differences[j]);
      ranks[i] += b < a ? 1 : b > a ? 0 : i == j ? 1 : 0.5;
    }
  double seen = 0, below = 0, above = 0;
  for (std::size_t i = 0; i < n; ++i) seen += differences[i] > 0 ? ranks[i] : 0;
  for (unsigned signs = 0; signs < (1u << n); ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += signs >> i & 1 ? ranks[i] : 0;
    below += sum <= seen;
    above += sum >= seen;
  }
  return std::min(1.0, 2 * std::min(below, above) / double(1u << n));
}
double share_of_choices(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> all = first;
  all.insert(all.end(), second.begin(), second.end());
  std::vector<double> ranks(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j)
      ranks[i] += all[j] < all[i] ? 1 : all[j] > all[i] ? 0 : i == j ? 1 : 0.5;
  double seen = 0, below = 0, above = 0, count = 0;
  for (std::size_t i = 0; i < first.size(); ++i) seen += ranks[i];
  for (unsigned taken = 0; taken < (1u << all.size()); ++taken) {
    if (std::size_t(__builtin_popcount(taken)) != first.size()) continue;
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) sum += taken >> i & 1 ? ranks[i] : 0;
    ++count;
    below += sum <= seen;
    above += sum >= seen;
  }
  return std::min(1.0, 2 * std::min(below, above) / count);
}

TEST(StudyNumbers, SmallTiedSamplesAreExact) {
  // Six pairs that all rise by the same: 2 of 64 ways, where the normal distribution said 0.0197.
  const std::vector<double> before = {1, 2, 3, 4, 5, 6}, after = {3, 4, 5, 6, 7, 8};
  EXPECT_NEAR(signed_rank(before, after).p, 2.0 / 64, 1e-15);
  EXPECT_EQ(signed_rank(before, after).note, "exact, given the ties");
  for (const auto& [a, b] : std::vector<std::pair<std::vector<double>, std::vector<double>>>{
           {{1, 2, 2, 3, 5, 8, 8}, {2, 2, 3, 3, 8, 8, 9, 9}},
           {{1, 1, 1, 4}, {1, 2, 2}},
           {{5, 5, 6, 7}, {1, 5, 6, 6, 6}}}) {
    EXPECT_NEAR(mann_whitney(a, b, 0.95).p, share_of_choices(a, b), 1e-12);
    EXPECT_NEAR(mann_whitney(b, a, 0.95).p, share_of_choices(a, b), 1e-12) << "whichever comes first";
  }
  for (const std::vector<double>& d : {std::vector<double>{1, 1, -1, 2, 2, 3}, {-2, -2, 1, 4, 4, 4, 5, -1}, {1, -1}}) {
    const std::vector<double> zero(d.size());
    EXPECT_NEAR(signed_rank(zero, d).p, share_of_signs(d), 1e-12);
  }
  // Of 49 in each with ties: no sum overflows, and it is near the normal distribution.
  std::vector<double> many_a, many_b;
  for (int n = 0; n < 49; ++n) many_a.push_back(n % 7), many_b.push_back(n % 7 + (n % 3 == 0));
  const double exact = mann_whitney(many_a, many_b, 0.95).p;
  many_a.push_back(3), many_b.push_back(3);
  EXPECT_NEAR(mann_whitney(many_a, many_b, 0.95).p, exact, 0.03);
}

TEST(StudyNumbers, McNemarIsTheBinomial) {
  EXPECT_NEAR(mcnemar_p(5, 1), 2 * 7.0 / 64, 1e-12);
  EXPECT_NEAR(mcnemar_p(1, 5), 2 * 7.0 / 64, 1e-12);
  EXPECT_NEAR(mcnemar_p(0, 6), 2.0 / 64, 1e-12);
  EXPECT_EQ(mcnemar_p(3, 3), 1);
  EXPECT_EQ(mcnemar_p(0, 0), 1);
}

// The sums over all pairs, as they are defined.
TEST(StudyNumbers, CliffsDeltaIsThatOfAllPairs) {
  std::vector<double> a, b;
  for (int n = 0; n < 40; ++n) a.push_back(n * 7 % 11), b.push_back(n * 5 % 13);
  double delta = 0;
  for (const double x : a)
    for (const double y : b) delta += (y > x) - (y < x);
  EXPECT_NEAR(mann_whitney(a, b, 0.95).effect->value, delta / 1600, 1e-12);
}

TEST(StudyNumbers, WhatCannotBeTestedSaysWhy) {
  EXPECT_EQ(paired_t({1}, {2}, 0.95).why_not, "fewer than two pairs");
  EXPECT_EQ(paired_t({1, 2, 3}, {2, 3, 4}, 0.95).why_not,
            "all differences are equal, so nothing is known of their spread");
  EXPECT_EQ(welch_t({1, 2}, {3}, 0.95).why_not, "fewer than two values on a side");
  EXPECT_EQ(welch_t({1, 1}, {2, 2}, 0.95).why_not, "all values of both sides are equal to each other");
  EXPECT_EQ(mann_whitney({1, 1}, {1}, 0.95).why_not, "all values of both sides are equal");
  EXPECT_EQ(signed_rank({1, 2}, {1, 2}).why_not, "no pair differs");
  EXPECT_EQ(kruskal_wallis({{1}, {}}, 0.95).why_not, "a group has no value");
  EXPECT_TRUE(dunn({{1, 1}, {1}}).empty());
  EXPECT_FALSE(summarised({3}, 0.95).sd);
}

// Two samples that do not overlap: delta is 1, and its interval is not a point.
TEST(StudyNumbers, CliffsDeltaOfSeparateSamples) {
  const TestResult r = mann_whitney({1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}, 0.95);
  EXPECT_EQ(r.effect->value, 1);
  EXPECT_NEAR(r.effect->interval->low, (5 - 3.8414588206941236) / (5 + 3.8414588206941236), 1e-12);
  EXPECT_NEAR(r.p, 2.0 / 462, 1e-15);
}

// The pass mark between two groups: between equal deviations it is the middle; the densities are equal there.
TEST(StudyNumbers, NormalDensitiesCross) {
  EXPECT_DOUBLE_EQ(*crossing(20, 3, 30, 3), 25);
  const double at = *crossing(20, 5, 30, 2);
  const auto density = [](double x, double m, double s) { return std::exp(-(x - m) * (x - m) / (2 * s * s)) / s; };
  EXPECT_NEAR(density(at, 20, 5), density(at, 30, 2), 1e-12);
  EXPECT_GT(at, 25);
  EXPECT_FALSE(crossing(20, 0, 30, 2));
  EXPECT_FALSE(crossing(20, 3, 20, 3));
}

}  // namespace
