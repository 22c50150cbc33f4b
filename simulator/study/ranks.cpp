// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/ranks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trephine::study::detail {

Ranks ranked(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  Ranks ranks;
  ranks.of.resize(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    for (end = begin; end < order.size() && values[order[end]] == values[order[begin]];) ++end;
    const double t = double(end - begin), rank = (double(begin) + 1 + double(end)) / 2;
    for (std::size_t n = begin; n < end; ++n) ranks.of[order[n]] = rank;
    ranks.ties += t * t * t - t;
  }
  return ranks;
}

std::vector<double> mann_whitney_ways(std::size_t first, std::size_t second) {
  // ways[i][u]: of i values of the first among the values of the second so far.
  std::vector<std::vector<double>> ways(first + 1, std::vector<double>(first * second + 1));
  ways[0][0] = 1;
  // A Gaussian binomial coefficient: each value of the first lies above 0 to `second` of the others, and they ascend.
  for (std::size_t above = 0; above <= second; ++above)
    for (std::size_t i = 1; i <= first; ++i)
      for (std::size_t u = above; u <= first * second; ++u) ways[i][u] += ways[i - 1][u - above];
  return ways[first];
}

std::vector<double> signed_rank_ways(std::size_t n) {
  std::vector<double> ways(n * (n + 1) / 2 + 1);
  ways[0] = 1;
  for (std::size_t rank = 1; rank <= n; ++rank)
    for (std::size_t v = ways.size(); v-- > rank;) ways[v] += ways[v - rank];
  return ways;
}

double two_sided(const std::vector<double>& ways, double statistic) {
  const double most = double(ways.size() - 1), tail = std::min(statistic, most - statistic);
  double some = 0, all = 0;
  for (std::size_t n = 0; n < ways.size(); ++n) {
    all += ways[n];
    if (double(n) <= tail) some += ways[n];
  }
  return std::min(1.0, 2 * some / all);
}

double two_sided_sum(const std::vector<double>& ranks, std::optional<std::size_t> chosen, double sum) {
  // Twice a rank is a whole number. ways[i][s]: in how many ways i of the ranks so far give the sum s.
  std::size_t most = 0;
  for (const double rank : ranks) most += std::size_t(std::lround(2 * rank));
  const std::size_t levels = chosen ? *chosen : 0;
  std::vector<std::vector<double>> ways(levels + 1, std::vector<double>(most + 1));
  ways[0][0] = 1;
  std::size_t reached = 0;
  for (const double rank : ranks) {
    const auto twice = std::size_t(std::lround(2 * rank));
    reached += twice;
    for (std::size_t i = levels + 1; i-- > 0;)
      for (std::size_t s = reached + 1; s-- > twice;) {
        if (!chosen) ways[0][s] += ways[0][s - twice];
        if (chosen && i > 0) ways[i][s] += ways[i - 1][s - twice];
      }
  }
  double below = 0, above = 0, all = 0;
  for (std::size_t s = 0; s <= most; ++s) {
    all += ways[levels][s];
    if (double(s) <= 2 * sum) below += ways[levels][s];
    if (double(s) >= 2 * sum) above += ways[levels][s];
  }
  return std::min(1.0, 2 * std::min(below, above) / all);
}

}  // namespace trephine::study::detail
