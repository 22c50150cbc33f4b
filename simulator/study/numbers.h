// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trephine::study {

/// The numbers of an evaluation [Rizzi, chapter 8]. Distributions are Boost.Math's; tests/data/study holds what R 4.2.2
/// gives for the same samples. All values must be finite. What cannot be tested says why, and is no error.

struct Interval {
  double low = 0, high = 0;
};
struct Estimate {
  double value = 0;
  std::optional<Interval> interval;  ///< none: the method gives none
};

/// Quartiles by linear interpolation (type 7 of Hyndman and Fan, R's default). sd and interval need two values.
struct Summary {
  std::size_t count = 0;
  double mean = 0, least = 0, lower_quartile = 0, median = 0, upper_quartile = 0, most = 0;
  std::optional<double> sd;
  std::optional<Interval> mean_interval;  ///< by Student's t
};
Summary summarised(std::vector<double> values, double confidence_ratio);

struct TestResult {
  std::string why_not;  ///< "fewer than two pairs"; empty: it was tested
  std::string note;     ///< "exact", "2 pairs are equal and do not count"
  double statistic = 0, p = 1;
  std::optional<double> degrees;       ///< of freedom
  std::optional<Estimate> difference;  ///< of means, second less first
  std::optional<Estimate> effect;      ///< positive where the second is larger
  bool tested() const { return why_not.empty(); }
};
inline TestResult untested(const char* why) {
  TestResult r;
  r.why_not = why;
  return r;
}

/// Student's t of the differences second - first. Effect: Cohen's d of the differences (mean / sd), its interval by the
/// noncentral t distribution.
TestResult paired_t(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio);
/// Student's t of one sample against zero; difference: its mean.
TestResult one_sample_t(const std::vector<double>& values, double confidence_ratio);
/// Welch's t. Effect: Cohen's d by the pooled standard deviation, its interval by the noncentral t distribution with
/// n1 + n2 - 2 degrees of freedom.
TestResult welch_t(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio);
/// Statistic: U, the count of pairs in which the second is larger (ties half). Exact below 50 values in each, given
/// the ties, else by the normal distribution with correction for ties and continuity. Effect: Cliff's delta with his
/// asymmetric interval [Cliff1993].
TestResult mann_whitney(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio);
/// Statistic: V, the sum of ranks of the positive differences second - first. Pairs without a difference do not count,
/// which the note says. Exact below 50 pairs, given the ties. Effect: the matched-pairs rank-biserial
/// correlation.
TestResult signed_rank(const std::vector<double>& first, const std::vector<double>& second);
/// Statistic: H, corrected for ties. Effect: epsilon squared, H / (n - 1), its interval by the noncentral chi-squared
/// distribution, which H follows near the null hypothesis alone.
TestResult kruskal_wallis(const std::vector<std::vector<double>>& groups, double confidence_ratio);

enum class Correction { holm, bonferroni, none };
/// In the order in which they came.
std::vector<double> corrected(const std::vector<double>& p, Correction correction);

/// Dunn's test of two of the groups by the ranks of all [Dunn1964].
struct DunnPair {
  std::size_t first = 0, second = 0;
  double z = 0, p = 1;  ///< z is positive where the second ranks higher; p two-sided, not corrected
};
/// Of all pairs; none where all values are equal.
std::vector<DunnPair> dunn(const std::vector<std::vector<double>>& groups);

/// Wilson's interval of a share.
Interval share_interval(std::size_t some, std::size_t all, double confidence_ratio);
/// Fisher's exact test of two shares, two-sided: the tables that are at most as likely.
double fisher_p(std::size_t some_first, std::size_t all_first, std::size_t some_second, std::size_t all_second);

/// McNemar's exact test of paired shares, two-sided, by those who changed alone: the binomial distribution of one half.
double mcnemar_p(std::size_t gained, std::size_t lost);

/// The slope of y over x by least squares; nothing where all x are equal.
std::optional<double> slope_of(const std::vector<std::pair<double, double>>& points);

/// Where two normal densities of unequal means cross between the means: the pass mark of two contrasting groups.
/// Nothing where a deviation is zero or the means are equal, or where they do not cross there.
std::optional<double> crossing(double mean_1, double sd_1, double mean_2, double sd_2);
/// The share of a normal distribution below the value.
double normal_share_below(double value, double mean, double sd);

}  // namespace trephine::study
