// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "study/numbers.h"

namespace trephine::study::detail {

/// What Boost.Math computes; no other header of it is seen elsewhere.
double student_p(double t, double degrees);  ///< two-sided
double student_quantile(double share, double degrees);
double normal_quantile(double share);
double normal_below(double z);
double normal_p(double z);  ///< two-sided
double chi_squared_above(double value, double degrees);
/// By the inversion of the noncentral distribution: the noncentralities under which the statistic lies at either end of
/// the confidence.
Interval noncentral_t_interval(double t, double degrees, double confidence_ratio);
Interval noncentral_chi_squared_interval(double value, double degrees, double confidence_ratio);
/// Of `all` throws of a coin, the share of those that show it at most so often.
double binomial_half_below(std::size_t most, std::size_t all);
double hypergeometric_share(unsigned drawn_marked, unsigned marked, unsigned drawn, unsigned all);

}  // namespace trephine::study::detail
