// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "study/distributions.h"
#include "study/numbers.h"
#include "study/ranks.h"

namespace trephine::study {
namespace {

constexpr std::size_t max_exact = 49;  // values in a sample, as R has it

double sign(double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

// Of how many of the sorted values `v` is larger, less of how many it is smaller.
double dominance(const std::vector<double>& sorted, double v) {
  const auto [low, high] = std::equal_range(sorted.begin(), sorted.end(), v);
  return double(low - sorted.begin()) - double(sorted.end() - high);
}

// Cliff's delta, second over first, with his asymmetric interval by an unbiased variance [Cliff1993, equations 9, 12].
// Sums over all pairs are taken from sorted values, for there are many pairs.
Estimate cliff_delta(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio) {
  const double m = double(first.size()), n = double(second.size());
  std::vector<double> sorted_first = first, sorted_second = second, rows, columns;
  std::sort(sorted_first.begin(), sorted_first.end());
  std::sort(sorted_second.begin(), sorted_second.end());
  double delta = 0, unequal = 0;
  for (const double v : first) {
    const auto [low, high] = std::equal_range(sorted_second.begin(), sorted_second.end(), v);
    unequal += n - double(high - low);
    rows.push_back(-dominance(sorted_second, v) / n);
    delta += rows.back() / m;
  }
  for (const double v : second) columns.push_back(dominance(sorted_first, v) / m);
  const double z = detail::normal_quantile(0.5 + confidence_ratio / 2);
  if (std::abs(delta) >= 1 - 1e-12) {
    // No pair says otherwise: the interval of Feng and Cliff (2004) for samples that do not overlap.
    const double least = std::min(m, n), end = (least - z * z) / (least + z * z);
    return {sign(delta), delta > 0 ? Interval{end, 1} : Interval{-1, -end}};
  }
  if (first.size() < 2 || second.size() < 2) return {delta, {}};
  double a = 0, b = 0;
  for (const double row : rows) a += (row - delta) * (row - delta);
  for (const double column : columns) b += (column - delta) * (column - delta);
  const double square = delta * delta, c = unequal - m * n * square;  // of (sign - delta)^2 over all pairs
  const double variance =
      std::max((n * n * a + m * m * b - c) / (m * n * (m - 1) * (n - 1)), (1 - square) / (m * n - 1));
  const double half = z * std::sqrt(variance) * std::sqrt((1 - square) * (1 - square) + z * z * variance);
  const double middle = delta - square * delta, under = 1 - square + z * z * variance;
  return {delta, Interval{std::max(-1.0, (middle - half) / under), std::min(1.0, (middle + half) / under)}};
}

struct Pooled {
  detail::Ranks ranks;
  std::vector<double> sums;  // of ranks, by group
  double count = 0;
};
Pooled pooled(const std::vector<std::vector<double>>& groups) {
  std::vector<double> all;
  for (const auto& g : groups) all.insert(all.end(), g.begin(), g.end());
  Pooled out{detail::ranked(all), {}, double(all.size())};
  std::size_t at = 0;
  for (const auto& g : groups) {
    double sum = 0;
    for (std::size_t n = 0; n < g.size(); ++n) sum += out.ranks.of[at++];
    out.sums.push_back(sum);
  }
  return out;
}
bool nothing_differs(const Pooled& p) { return p.ranks.ties >= p.count * p.count * p.count - p.count; }

}  // namespace

TestResult mann_whitney(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio) {
  if (first.empty() || second.empty()) return untested("no value on a side");
  const Pooled all = pooled({first, second});
  if (nothing_differs(all)) return untested("all values of both sides are equal");
  const double n1 = double(first.size()), n2 = double(second.size()), middle = n1 * n2 / 2;
  TestResult r;
  r.statistic = all.sums[1] - n2 * (n2 + 1) / 2;
  if (first.size() <= max_exact && second.size() <= max_exact) {
    r.p = all.ranks.ties == 0 ? detail::two_sided(detail::mann_whitney_ways(first.size(), second.size()), r.statistic)
                              : detail::two_sided_sum(all.ranks.of, first.size(), all.sums[0]);
    r.note = all.ranks.ties == 0 ? "exact" : "exact, given the ties";
  } else {
    const double n = all.count;
    const double sigma = std::sqrt(n1 * n2 / 12 * ((n + 1) - all.ranks.ties / (n * (n - 1))));
    const double off = r.statistic - middle;
    r.p = detail::normal_p((off - sign(off) * 0.5) / sigma);
    r.note = all.ranks.ties > 0 ? "normal, for values are tied" : "normal";
  }
  r.effect = cliff_delta(first, second, confidence_ratio);
  return r;
}

TestResult signed_rank(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> differences, sizes;
  for (std::size_t n = 0; n < first.size(); ++n)
    if (second[n] != first[n]) {
      differences.push_back(second[n] - first[n]);
      sizes.push_back(std::abs(differences.back()));
    }
  const std::size_t equal = first.size() - differences.size();
  if (differences.empty()) return untested(first.empty() ? "no pair" : "no pair differs");
  const detail::Ranks ranks = detail::ranked(sizes);
  const double n = double(differences.size()), total = n * (n + 1) / 2;
  TestResult r;
  for (std::size_t k = 0; k < differences.size(); ++k) r.statistic += differences[k] > 0 ? ranks.of[k] : 0;
  if (differences.size() <= max_exact) {
    r.p = ranks.ties == 0 ? detail::two_sided(detail::signed_rank_ways(differences.size()), r.statistic)
                          : detail::two_sided_sum(ranks.of, {}, r.statistic);
    r.note = ranks.ties == 0 ? "exact" : "exact, given the ties";
  } else {
    const double sigma = std::sqrt(n * (n + 1) * (2 * n + 1) / 24 - ranks.ties / 48), off = r.statistic - total / 2;
    r.p = detail::normal_p((off - sign(off) * 0.5) / sigma);
    r.note = ranks.ties > 0 ? "normal, for differences are tied" : "normal";
  }
  if (equal > 0)
    r.note += "; " + std::to_string(equal) + (equal == 1 ? " pair is" : " pairs are") + " equal and do not count";
  r.effect = Estimate{(2 * r.statistic - total) / total, {}};
  return r;
}

TestResult kruskal_wallis(const std::vector<std::vector<double>>& groups, double confidence_ratio) {
  if (groups.size() < 2) return untested("fewer than two groups");
  if (std::any_of(groups.begin(), groups.end(), [](const auto& g) { return g.empty(); }))
    return untested("a group has no value");
  const Pooled all = pooled(groups);
  if (nothing_differs(all)) return untested("all values are equal");
  const double n = all.count, degrees = double(groups.size()) - 1;
  double h = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) h += all.sums[g] * all.sums[g] / double(groups[g].size());
  h = (12 / (n * (n + 1)) * h - 3 * (n + 1)) / (1 - all.ranks.ties / (n * n * n - n));
  TestResult r;
  r.statistic = h;
  r.degrees = degrees;
  r.p = detail::chi_squared_above(h, degrees);
  const Interval lambda = detail::noncentral_chi_squared_interval(h, degrees, confidence_ratio);
  r.effect = Estimate{h / (n - 1), Interval{lambda.low / (n - 1), std::min(1.0, lambda.high / (n - 1))}};
  return r;
}

std::vector<DunnPair> dunn(const std::vector<std::vector<double>>& groups) {
  const Pooled all = pooled(groups);
  if (nothing_differs(all)) return {};
  const double n = all.count, spread = n * (n + 1) / 12 - all.ranks.ties / (12 * (n - 1));
  std::vector<DunnPair> pairs;
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (std::size_t b = a + 1; b < groups.size(); ++b) {
      if (groups[a].empty() || groups[b].empty()) continue;
      const double na = double(groups[a].size()), nb = double(groups[b].size());
      const double z = (all.sums[b] / nb - all.sums[a] / na) / std::sqrt(spread * (1 / na + 1 / nb));
      pairs.push_back({a, b, z, detail::normal_p(z)});
    }
  return pairs;
}

}  // namespace trephine::study
