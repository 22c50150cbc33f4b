// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace trephine::picture {
namespace {

constexpr std::array<Rgb, 9> palette = {{{0.90, 0.62, 0.00},    // orange
                                         {0.84, 0.37, 0.00},    // vermilion
                                         {0.20, 0.45, 1.00},    // blue
                                         {0.80, 0.47, 0.65},    // reddish purple
                                         {0.34, 0.71, 0.91},    // sky blue
                                         {0.00, 0.62, 0.45},    // bluish green
                                         {0.94, 0.89, 0.26},    // yellow
                                         {1.00, 1.00, 1.00},    // white
                                         {0.50, 0.10, 0.80}}};  // violet

// Tissue colours are pale: only their hue counts, and for grey that there is none.
Rgb hue_of(Rgb c) {
  const auto [low, high] = std::minmax_element(c.begin(), c.end());
  const double from = *low, range = *high - *low;
  if (range < 0.1) return {1, 1, 1};
  for (double& v : c) v = (v - from) / range;
  return c;
}

double distance(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

}  // namespace

std::vector<Rgb> line_colours(const std::vector<Rgb>& surfaces) {
  std::vector<Rgb> out;
  std::array<bool, palette.size()> taken{};
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    if (n % palette.size() == 0) taken.fill(false);
    const Rgb wanted = hue_of(surfaces[n]);
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < palette.size(); ++p) {
      const double d = distance(wanted, hue_of(palette[p])) + 0.1 * distance(surfaces[n], palette[p]);
      if (!taken[p] && d < least) least = d, best = p;
    }
    taken[best] = true;
    out.push_back(palette[best]);
  }
  return out;
}

}  // namespace trephine::picture
