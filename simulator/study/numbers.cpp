// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/numbers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "study/distributions.h"

namespace trephine::study {
namespace {

// Two passes, so that values that differ little beside their size lose no digits.
double mean_of(const std::vector<double>& v) {
  const double near = std::accumulate(v.begin(), v.end(), 0.0) / double(v.size());
  double off = 0;
  for (const double x : v) off += x - near;
  return near + off / double(v.size());
}
// Of a sample: by n - 1.
double variance_of(const std::vector<double>& v) {
  const double mean = mean_of(v);
  double sum = 0;
  for (const double x : v) sum += (x - mean) * (x - mean);
  return sum / double(v.size() - 1);
}
bool all_equal(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [&](double x) { return x == v.front(); });
}
double quantile_of(const std::vector<double>& sorted, double share) {
  const double at = share * double(sorted.size() - 1);
  const std::size_t low = std::size_t(at), high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - double(low)) * (sorted[high] - sorted[low]);
}
Interval around(double middle, double half) { return {middle - half, middle + half}; }

}  // namespace

Summary summarised(std::vector<double> values, double confidence_ratio) {
  Summary s;
  s.count = values.size();
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  s.mean = mean_of(values);
  s.least = values.front();
  s.most = values.back();
  s.lower_quartile = quantile_of(values, 0.25);
  s.median = quantile_of(values, 0.5);
  s.upper_quartile = quantile_of(values, 0.75);
  if (values.size() < 2) return s;
  s.sd = std::sqrt(variance_of(values));
  const double n = double(values.size());
  s.mean_interval = around(s.mean, detail::student_quantile(0.5 + confidence_ratio / 2, n - 1) * *s.sd / std::sqrt(n));
  return s;
}

TestResult one_sample_t(const std::vector<double>& values, double confidence_ratio) {
  if (values.size() < 2) return untested("fewer than two values");
  if (all_equal(values)) return untested("all values are equal, so nothing is known of their spread");
  const double n = double(values.size()), mean = mean_of(values), error = std::sqrt(variance_of(values) / n);
  TestResult r;
  r.statistic = mean / error;
  r.degrees = n - 1;
  r.p = detail::student_p(r.statistic, n - 1);
  r.difference = Estimate{mean, around(mean, detail::student_quantile(0.5 + confidence_ratio / 2, n - 1) * error)};
  const Interval t = detail::noncentral_t_interval(r.statistic, n - 1, confidence_ratio);
  r.effect = Estimate{r.statistic / std::sqrt(n), Interval{t.low / std::sqrt(n), t.high / std::sqrt(n)}};
  return r;
}

TestResult paired_t(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio) {
  std::vector<double> differences(first.size());
  for (std::size_t n = 0; n < first.size(); ++n) differences[n] = second[n] - first[n];
  if (differences.size() < 2) return untested("fewer than two pairs");
  if (all_equal(differences)) return untested("all differences are equal, so nothing is known of their spread");
  return one_sample_t(differences, confidence_ratio);
}

TestResult welch_t(const std::vector<double>& first, const std::vector<double>& second, double confidence_ratio) {
  if (first.size() < 2 || second.size() < 2) return untested("fewer than two values on a side");
  const double n1 = double(first.size()), n2 = double(second.size());
  const double v1 = variance_of(first), v2 = variance_of(second), e1 = v1 / n1, e2 = v2 / n2;
  if (all_equal(first) && all_equal(second)) return untested("all values of both sides are equal to each other");
  const double difference = mean_of(second) - mean_of(first), error = std::sqrt(e1 + e2);
  TestResult r;
  r.statistic = difference / error;
  r.degrees = (e1 + e2) * (e1 + e2) / (e1 * e1 / (n1 - 1) + e2 * e2 / (n2 - 1));
  r.p = detail::student_p(r.statistic, *r.degrees);
  r.difference = Estimate{difference,
                          around(difference, detail::student_quantile(0.5 + confidence_ratio / 2, *r.degrees) * error)};
  const double pooled = std::sqrt(((n1 - 1) * v1 + (n2 - 1) * v2) / (n1 + n2 - 2)), d = difference / pooled;
  const double root = std::sqrt(n1 * n2 / (n1 + n2));
  const Interval t = detail::noncentral_t_interval(d * root, n1 + n2 - 2, confidence_ratio);
  r.effect = Estimate{d, Interval{t.low / root, t.high / root}};
  return r;
}

std::vector<double> corrected(const std::vector<double>& p, Correction correction) {
  std::vector<double> out = p;
  const double count = double(p.size());
  if (correction == Correction::bonferroni)
    for (double& x : out) x = std::min(1.0, x * count);
  if (correction == Correction::holm) {
    std::vector<std::size_t> order(p.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
    double least = 0;
    for (std::size_t n = 0; n < order.size(); ++n) {
      least = std::max(least, std::min(1.0, (count - double(n)) * p[order[n]]));
      out[order[n]] = least;
    }
  }
  return out;
}

Interval share_interval(std::size_t some, std::size_t all, double confidence_ratio) {
  if (all == 0) return {0, 1};
  const double n = double(all), share = double(some) / n, z = detail::normal_quantile(0.5 + confidence_ratio / 2);
  const double middle = (share + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

double fisher_p(std::size_t some_first, std::size_t all_first, std::size_t some_second, std::size_t all_second) {
  const unsigned some = unsigned(some_first + some_second), all = unsigned(all_first + all_second),
                 drawn = unsigned(all_first);
  const unsigned least = drawn + some > all ? drawn + some - all : 0, most = std::min(drawn, some);
  const double here = detail::hypergeometric_share(unsigned(some_first), some, drawn, all);
  double p = 0;
  for (unsigned k = least; k <= most; ++k)
    // Tables that are as likely but for a rounding count.
    if (const double share = detail::hypergeometric_share(k, some, drawn, all); share <= here * (1 + 1e-7)) p += share;
  return std::min(1.0, p);
}

double mcnemar_p(std::size_t gained, std::size_t lost) {
  return std::min(1.0, 2 * detail::binomial_half_below(std::min(gained, lost), gained + lost));
}

std::optional<double> slope_of(const std::vector<std::pair<double, double>>& points) {
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (const auto& [x, y] : points) mx += x / double(points.size()), my += y / double(points.size());
  for (const auto& [x, y] : points) xx += (x - mx) * (x - mx), xy += (x - mx) * (y - my);
  if (xx <= 0) return std::nullopt;
  return xy / xx;
}

std::optional<double> crossing(double mean_1, double sd_1, double mean_2, double sd_2) {
  if (sd_1 <= 0 || sd_2 <= 0 || mean_1 == mean_2) return std::nullopt;
  // log densities are equal: a x^2 + b x + c = 0.
  const double w1 = 1 / (sd_1 * sd_1), w2 = 1 / (sd_2 * sd_2);
  const double a = (w1 - w2) / 2, b = mean_2 * w2 - mean_1 * w1,
               c = (mean_1 * mean_1 * w1 - mean_2 * mean_2 * w2) / 2 + std::log(sd_1 / sd_2);
  const double low = std::min(mean_1, mean_2), high = std::max(mean_1, mean_2);
  if (std::abs(a) < 1e-12 * (w1 + w2)) return -c / b;
  const double root = b * b - 4 * a * c;
  if (root < 0) return std::nullopt;
  // Without a difference of two numbers that are nearly equal.
  const double q = -(b + std::copysign(std::sqrt(root), b)) / 2;
  for (const double x : {q / a, c / q})
    if (x > low && x < high) return x;
  return std::nullopt;
}

double normal_share_below(double value, double mean, double sd) { return detail::normal_below((value - mean) / sd); }

}  // namespace trephine::study
