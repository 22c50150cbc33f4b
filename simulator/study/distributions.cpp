// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/distributions.h"

#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/hypergeometric.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>

namespace trephine::study::detail {
namespace {

namespace bm = boost::math;

// Overflow gives infinity as in R, not an exception; the rest never happens with finite input.
using Policy = bm::policies::policy<bm::policies::overflow_error<bm::policies::ignore_error>,
                                    bm::policies::evaluation_error<bm::policies::ignore_error>>;

// The argument between low and high at which a descending function is `wanted`.
template <class F>
double root_of(const F& f, double wanted, double low, double high) {
  const auto off = [&](double x) { return f(x) - wanted; };
  for (int n = 0; n < 60 && off(low) < 0; ++n) low -= (high - low);
  for (int n = 0; n < 60 && off(high) > 0; ++n) high += (high - low);
  std::uintmax_t steps = 300;
  const auto [a, b] = bm::tools::toms748_solve(off, low, high, bm::tools::eps_tolerance<double>(50), steps);
  return (a + b) / 2;
}

}  // namespace

double student_p(double t, double degrees) {
  return 2 * bm::cdf(bm::complement(bm::students_t_distribution<double, Policy>(degrees), std::abs(t)));
}
double student_quantile(double share, double degrees) {
  return bm::quantile(bm::students_t_distribution<double, Policy>(degrees), share);
}
double normal_quantile(double share) { return bm::quantile(bm::normal_distribution<double, Policy>(), share); }
double normal_below(double z) { return bm::cdf(bm::normal_distribution<double, Policy>(), z); }
double normal_p(double z) { return std::min(1.0, 2 * normal_below(-std::abs(z))); }
double chi_squared_above(double value, double degrees) {
  return bm::cdf(bm::complement(bm::chi_squared_distribution<double, Policy>(degrees), std::max(0.0, value)));
}

Interval noncentral_t_interval(double t, double degrees, double confidence_ratio) {
  const double rest = (1 - confidence_ratio) / 2;
  const auto below = [&](double delta) {
    return bm::cdf(bm::non_central_t_distribution<double, Policy>(degrees, delta), t);
  };
  return {root_of(below, 1 - rest, t - 5, t + 1), root_of(below, rest, t - 1, t + 5)};
}

Interval noncentral_chi_squared_interval(double value, double degrees, double confidence_ratio) {
  const double rest = (1 - confidence_ratio) / 2;
  const auto below = [&](double lambda) {
    if (lambda <= 0) return bm::cdf(bm::chi_squared_distribution<double, Policy>(degrees), value);
    return bm::cdf(bm::non_central_chi_squared_distribution<double, Policy>(degrees, lambda), value);
  };
  const auto of = [&](double share) {
    return below(0) <= share ? 0 : root_of(below, share, 0, std::max(4.0, 2 * value));
  };
  return {of(1 - rest), of(rest)};
}

double binomial_half_below(std::size_t most, std::size_t all) {
  return bm::cdf(bm::binomial_distribution<double, Policy>(double(all), 0.5), double(most));
}
double hypergeometric_share(unsigned drawn_marked, unsigned marked, unsigned drawn, unsigned all) {
  return bm::pdf(bm::hypergeometric_distribution<double, Policy>(marked, drawn, all), drawn_marked);
}

}  // namespace trephine::study::detail
