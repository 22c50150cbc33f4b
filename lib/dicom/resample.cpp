// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/resample.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace trephine::dicom {
namespace {

/// Nearer to a sample than this share of a step is the sample.
constexpr double on_sample = 1e-4;

struct Line {
  int base = 0;  ///< source index of a target index t: t + base + fraction
  double fraction = 0;
  Weights weight{};
  bool copy = false;
};

Line line_of(double shift) {
  Line l;
  l.base = static_cast<int>(std::floor(-shift));
  l.fraction = -shift - l.base;
  if (l.fraction > 1 - on_sample) {
    ++l.base;
    l.fraction = 0;
  }
  l.copy = l.fraction < on_sample;
  l.weight = cubic_weights(l.fraction);
  return l;
}

/// The four source indices for target index t; false where the source does not reach.
bool reach(const Line& l, int t, int size, std::array<int, 4>& at) {
  const int i = t + l.base;
  if (i < 0 || i >= size || (!l.copy && i + 1 >= size)) return false;
  for (int k = 0; k < 4; ++k) at[static_cast<std::size_t>(k)] = std::clamp(i + k - 1, 0, size - 1);
  return true;
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
  const std::array<float, 4> wd{float(down.weight[0]), float(down.weight[1]), float(down.weight[2]),
                                float(down.weight[3])};
  const std::array<float, 4> wa{float(across.weight[0]), float(across.weight[1]), float(across.weight[2]),
                                float(across.weight[3])};
  for (int t = 0; t < target_rows; ++t) {
    float* target = out.data() + std::size_t(t) * std::size_t(target_columns);
    std::array<int, 4> at{};
    if (!reach(down, t, rows, at)) {
      std::fill(target, target + target_columns, air);
      continue;
    }
    std::array<const float*, 4> s{};
    for (std::size_t k = 0; k < 4; ++k) s[k] = slice.data() + std::size_t(at[k]) * std::size_t(columns);
    const float* made = s[1];
    if (!down.copy) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = limited(s[0][i], s[1][i], s[2][i], s[3][i], wd[0], wd[1], wd[2], wd[3]);
      made = row.data();
    }
    for (int i = 0; i < target_columns; ++i) {
      std::array<int, 4> b{};
      if (!reach(across, i, columns, b))
        target[i] = air;
      else
        target[i] = across.copy ? made[b[1]]
                                : limited(made[b[0]], made[b[1]], made[b[2]], made[b[3]], wa[0], wa[1], wa[2], wa[3]);
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
