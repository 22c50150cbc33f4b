// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace trephine::study::detail {

/// Ranks from 1, ties at their mean, and the sum of t^3 - t over groups of t ties.
struct Ranks {
  std::vector<double> of;
  double ties = 0;
};
Ranks ranked(const std::vector<double>& values);

/// In how many ways `first` of first + second ranks give a Mann-Whitney statistic of 0, 1, ... (exact in double below
/// 50 each to a rounding).
std::vector<double> mann_whitney_ways(std::size_t first, std::size_t second);
/// In how many ways the ranks 1 to n, each with a sign, give a sum of the positive ones of 0, 1, ...
std::vector<double> signed_rank_ways(std::size_t n);
/// Twice the smaller tail of a statistic whose distribution is symmetric, by the counts of ways.
double two_sided(const std::vector<double>& ways, double statistic);
/// The same of the sum of some of these ranks, ties at their mean: of any `chosen` of them, or of any number. Given the
/// ties it is exact [Lehmann1975].
double two_sided_sum(const std::vector<double>& ranks, std::optional<std::size_t> chosen, double sum);

}  // namespace trephine::study::detail
