// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/tissue_mixture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"

namespace trephine::segmentation {
namespace {

double log_density(const TissueClass& c, double x) {
  const double z = (x - c.mean) / c.sigma;
  return std::log(c.weight) - std::log(c.sigma) - 0.5 * z * z;
}

/// Each class's probability of x; no overflow however far x lies.
void posterior(const std::vector<TissueClass>& classes, double x, std::vector<double>& p) {
  double most = -1e300, sum = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) most = std::max(most, p[c] = log_density(classes[c], x));
  for (double& v : p) sum += v = std::exp(v - most);
  for (double& v : p) v /= sum;
}

/// Means, sigmas and weights of the values nearest to each centre, until the centres stay.
std::vector<TissueClass> cut(const Histogram& h, int k, double min_sigma) {
  double total = 0;
  for (const auto n : h.counts) total += double(n);
  std::vector<TissueClass> classes(k);
  double seen = 0;
  int next = 0;
  for (std::size_t b = 0; b < h.counts.size(); ++b) {
    seen += double(h.counts[b]);
    while (next < k && seen >= total * (next + 0.5) / k) classes[next++].mean = h.first + double(b) * h.width;
  }
  // Equal quantiles would stay one class for ever.
  for (int c = 1; c < k; ++c) classes[c].mean = std::max(classes[c].mean, classes[c - 1].mean + h.width);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> n(k), sum(k), squares(k);
    for (std::size_t b = 0; b < h.counts.size(); ++b) {
      if (h.counts[b] == 0) continue;
      const double x = h.first + double(b) * h.width, m = double(h.counts[b]);
      int best = 0;
      for (int c = 1; c < k; ++c)
        if (std::abs(x - classes[c].mean) < std::abs(x - classes[best].mean)) best = c;
      n[best] += m;
      sum[best] += m * x;
      squares[best] += m * x * x;
    }
    bool moved = false;
    for (int c = 0; c < k; ++c) {
      const double mean = n[c] > 0 ? sum[c] / n[c] : classes[c].mean;
      moved = moved || mean != classes[c].mean;
      const double variance = n[c] > 0 ? squares[c] / n[c] - mean * mean : 0;
      classes[c] = {mean, std::max(min_sigma, std::sqrt(std::max(0.0, variance))), std::max(n[c] / total, 1e-9)};
    }
    if (!moved) break;
  }
  return classes;
}

}  // namespace

double TissueMixture::share(double value, int first, int last) const {
  std::vector<double> p(classes.size());
  posterior(classes, std::clamp(value, classes.front().mean, classes.back().mean), p);
  double sum = 0;
  for (int c = first; c <= last; ++c) sum += p[std::size_t(c)];
  return sum;
}

TissueMixture fit_mixture(const Histogram& h, int classes_count) {
  const auto filled = std::count_if(h.counts.begin(), h.counts.end(), [](std::uint64_t n) { return n > 0; });
  if (filled < 2 * classes_count)
    throw refusal("classes_count",
                  fmt::format("{} classes from {} different values, must be at least twice as many: the image is "
                              "(nearly) constant there",
                              classes_count, filled),
                  {"ask for fewer in `classes_count`, or widen `roi_min_mm` and `roi_max_mm`"});
  const double min_sigma = 0.5 * h.width;
  double total = 0;
  for (const auto n : h.counts) total += double(n);
  TissueMixture m;
  m.classes = cut(h, classes_count, min_sigma);
  const std::size_t k = m.classes.size();
  std::vector<double> p(k);
  for (m.iterations = 0; m.iterations < 500; ++m.iterations) {
    std::vector<double> n(k), sum(k), squares(k);
    for (std::size_t b = 0; b < h.counts.size(); ++b) {
      if (h.counts[b] == 0) continue;
      const double x = h.first + double(b) * h.width;
      posterior(m.classes, x, p);
      for (std::size_t c = 0; c < k; ++c) {
        const double w = p[c] * double(h.counts[b]);
        n[c] += w;
        sum[c] += w * x;
        squares[c] += w * (x - m.classes[c].mean) * (x - m.classes[c].mean);
      }
    }
    double change = 0;
    for (std::size_t c = 0; c < k; ++c) {
      if (!(n[c] > 1e-9 * total)) continue;  // an empty class stays where it is
      TissueClass& t = m.classes[c];
      const double mean = sum[c] / n[c], shift = mean - t.mean;
      const double sigma = std::max(min_sigma, std::sqrt(std::max(0.0, squares[c] / n[c] - shift * shift)));
      change = std::max({change, std::abs(shift), std::abs(sigma - t.sigma)});
      t = {mean, sigma, n[c] / total};
    }
    if (change < 1e-3 * h.width) break;
  }
  std::stable_sort(m.classes.begin(), m.classes.end(),
                   [](const TissueClass& a, const TissueClass& b) { return a.mean < b.mean; });
  return m;
}

}  // namespace trephine::segmentation
