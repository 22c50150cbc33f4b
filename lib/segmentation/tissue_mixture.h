// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

namespace trephine::segmentation {

/// Counts of values in bins of one width.
struct Histogram {
  double first = 0;  ///< centre of the first bin
  double width = 1;
  std::vector<std::uint64_t> counts;
};

struct TissueClass {
  double mean = 0, sigma = 0, weight = 0;  ///< weights sum to 1
};

struct TissueMixture {
  std::vector<TissueClass> classes;  ///< darkest first
  int iterations = 0;
  /// The probability that a value belongs to the classes first to last (from 0). Values beyond the outermost means
  /// count as these means, so that no wide class claims the far side of a narrow one.
  double share(double value, int first, int last) const;
};

/// Fits a mixture of Gaussians to the histogram by expectation maximization [Dempster1977]. It starts with the best cut
/// of the values into intervals (k-means in one dimension, from quantiles), so that the same counts always give the
/// same classes. Sigmas are at least half a bin. Throws Error 80 where there are fewer than twice as many filled bins
/// as classes: a constant image has no classes.
TissueMixture fit_mixture(const Histogram& histogram, int classes_count);

}  // namespace trephine::segmentation
