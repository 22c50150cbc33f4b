// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/resample.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace trephine::dicom {
namespace {

/// A place that is nearer to a sample than this share of a step gets the sample's own value.
constexpr double on_sample = 1e-4;

/// Taps of an interpolation between equidistant samples; `before` of them lie before the place. There are eight because
/// four would blur edges at half a step: four leave 0.88 of the amplitude at half of the highest frequency, eight leave
/// 0.98. With four, the skull of a tilted scan was a seventh less accurate than that of an upright one.
constexpr int taps = 8, before = taps / 2 - 1;

struct Line {
  int base = 0;  ///< source index of a target index t: t + base + fraction
  std::array<float, taps> weight{};
  bool copy = false;
};

/// Lagrange's polynomial through the samples around the place. It is exact up to the seventh degree, and at a sample it
/// gives that sample.
Line line_of(double shift) {
  Line l;
  l.base = static_cast<int>(std::floor(-shift));
  double fraction = -shift - l.base;
  if (fraction > 1 - on_sample) {
    ++l.base;
    fraction = 0;
  }
  l.copy = fraction < on_sample;
  for (int k = 0; k < taps; ++k) {
    double w = 1;
    for (int m = 0; m < taps; ++m)
      if (m != k) w *= (fraction + before - m) / (k - m);
    l.weight[static_cast<std::size_t>(k)] = static_cast<float>(w);
  }
  return l;
}

/// The source indices for target index t; false where the source does not reach.
bool reach(const Line& l, int t, int size, std::array<int, taps>& at) {
  const int i = t + l.base;
  if (i < 0 || i >= size || (!l.copy && i + 1 >= size)) return false;
  for (int k = 0; k < taps; ++k) at[static_cast<std::size_t>(k)] = std::clamp(i + k - before, 0, size - 1);
  return true;
}

/// The weighted sum, clamped to the range of the middle four samples, so that it does not overshoot the values next to
/// the place.
template <class At>
inline float limited_sum(const std::array<float, taps>& w, At&& at) {
  float sum = 0;
  for (int k = 0; k < taps; ++k) sum += w[static_cast<std::size_t>(k)] * at(k);
  const float low = std::min(std::min(at(before - 1), at(before)), std::min(at(before + 1), at(before + 2)));
  const float high = std::max(std::max(at(before - 1), at(before)), std::max(at(before + 1), at(before + 2)));
  return std::min(high, std::max(low, sum));
}

inline float limited(float a, float b, float c, float d, float w0, float w1, float w2, float w3) {
  const float low = std::min(std::min(a, b), std::min(c, d)), high = std::max(std::max(a, b), std::max(c, d));
  return std::min(high, std::max(low, w0 * a + w1 * b + w2 * c + w3 * d));
}

}  // namespace

Weights cubic_weights(double t) { return cubic_weights({-1, 0, 1, 2}, t); }

Weights cubic_weights(const std::array<double, 4>& x, double at) {
  const double h = x[2] - x[1], t = (at - x[1]) / h, before = x[1] - x[0], after = x[3] - x[2];
  const double t2 = t * t, t3 = t2 * t;
  const double value0 = 2 * t3 - 3 * t2 + 1, value1 = 3 * t2 - 2 * t3;
  const double slope0 = h * (t3 - 2 * t2 + t), slope1 = h * (t3 - t2);
  Weights w{0, value0, value1, 0};
  // The parabola's slope at x[1] through the three samples around it; at an end that of the chord.
  if (before > 0) {
    const double a = h / (before * (before + h)), c = before / (h * (before + h));
    w[0] -= slope0 * a;
    w[1] += slope0 * (a - c);
    w[2] += slope0 * c;
  } else {
    w[1] -= slope0 / h;
    w[2] += slope0 / h;
  }
  if (after > 0) {
    const double a = after / (h * (h + after)), c = h / (after * (h + after));
    w[1] -= slope1 * a;
    w[2] += slope1 * (a - c);
    w[3] += slope1 * c;
  } else {
    w[1] -= slope1 / h;
    w[2] += slope1 / h;
  }
  return w;
}

Taps taps_of(const StackGeometry& g, int target_slice) {
  const double z = g.target_mm(target_slice);
  const auto& x = g.along_mm;
  const int n = static_cast<int>(x.size());
  const auto at = [&](int i) { return x[static_cast<std::size_t>(i)]; };
  int k = static_cast<int>(std::upper_bound(x.begin(), x.end(), z) - x.begin()) - 1;
  k = std::clamp(k, 0, n - 2);
  Taps taps;
  for (const int i : {k, k + 1})
    if (std::abs(z - at(i)) <= uniform_tolerance_mm) {
      taps.exact = true;
      taps.level = {i, i, i, i};
      taps.weight = {0, 1, 0, 0};
      return taps;
    }
  taps.level = {std::max(0, k - 1), k, k + 1, std::min(n - 1, k + 2)};
  taps.weight =
      cubic_weights({at(taps.level[0]), at(k), at(k + 1), at(taps.level[3])}, std::clamp(z, at(k), at(k + 1)));
  return taps;
}

void shift_slice(const std::vector<float>& slice, int columns, int rows, const std::array<double, 2>& shift,
                 int target_columns, int target_rows, float air, std::vector<float>& out) {
  const Line across = line_of(shift[0]), down = line_of(shift[1]);
  out.resize(std::size_t(target_columns) * std::size_t(target_rows));
  std::vector<float> row(static_cast<std::size_t>(columns));
  for (int t = 0; t < target_rows; ++t) {
    float* target = out.data() + std::size_t(t) * std::size_t(target_columns);
    std::array<int, taps> at{};
    if (!reach(down, t, rows, at)) {
      std::fill(target, target + target_columns, air);
      continue;
    }
    std::array<const float*, taps> s{};
    for (std::size_t k = 0; k < taps; ++k) s[k] = slice.data() + std::size_t(at[k]) * std::size_t(columns);
    const float* made = s[before];
    if (!down.copy) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = limited_sum(down.weight, [&](int k) { return s[static_cast<std::size_t>(k)][i]; });
      made = row.data();
    }
    for (int i = 0; i < target_columns; ++i) {
      std::array<int, taps> b{};
      if (!reach(across, i, columns, b))
        target[i] = air;
      else
        target[i] = across.copy
                        ? made[b[before]]
                        : limited_sum(across.weight, [&](int k) { return made[b[static_cast<std::size_t>(k)]]; });
    }
  }
}

template <class T>
void blend(const Taps& taps, const std::array<const float*, 4>& slices, std::size_t count, T* out) {
  const auto sample = [](float v) {
    if constexpr (std::is_integral_v<T>)
      return static_cast<T>(std::floor(v + 0.5f));
    else
      return v;
  };
  if (taps.exact) {
    for (std::size_t i = 0; i < count; ++i) out[i] = sample(slices[1][i]);
    return;
  }
  const float w0 = float(taps.weight[0]), w1 = float(taps.weight[1]), w2 = float(taps.weight[2]),
              w3 = float(taps.weight[3]);
  const float *a = slices[0], *b = slices[1], *c = slices[2], *d = slices[3];
  for (std::size_t i = 0; i < count; ++i) out[i] = sample(limited(a[i], b[i], c[i], d[i], w0, w1, w2, w3));
}

template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, std::int16_t*);
template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, float*);

}  // namespace trephine::dicom
