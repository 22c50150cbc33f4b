// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/streaks.h"

#include <algorithm>
#include <cmath>

#include "base/degree.h"
#include "base/parallel.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

constexpr double min_rms_hu = 4.5, min_ratio = 3;
constexpr double min_line_mm = 40, line_mm = 2;  ///< lines this long and this wide are compared
constexpr double min_area_mm2 = 2000;
constexpr double around_sigma_mm = 8;
constexpr float max_hu = 40;  ///< calcifications and air count as this much
constexpr int directions = 60, max_passes = 3;
constexpr double cell_mm = 1, half_window_mm = 40, min_window_mm = 20;

/// The tissue of one slice.
struct Slice {
  const grid::Lattice& l;
  std::vector<float> value;  ///< HU less the mean around it
  std::vector<char> known;
  double pixel_mm2, reach_mm;

  Slice(const grid::Grid<float>& hu, const BitMask& mask, int k)
      : l(hu), value(std::size_t(l.size[0]) * l.size[1]), known(value.size()) {
    pixel_mm2 = l.spacing_mm.x * l.spacing_mm.y;
    reach_mm = std::hypot(l.size[0] * l.spacing_mm.x, l.size[1] * l.spacing_mm.y);
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        known[at(i, j)] = mask.get(i, j, k);
        value[at(i, j)] = hu.at(i, j, k);
      }
  }
  std::size_t at(int i, int j) const { return std::size_t(j) * l.size[0] + i; }
  double area_mm2() const { return double(std::count(known.begin(), known.end(), 1)) * pixel_mm2; }
  template <class F>
  void each(F&& f) const {
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (known[at(i, j)]) f(at(i, j), i * l.spacing_mm.x, j * l.spacing_mm.y);
  }

  /// Takes the Gaussian mean of the known values around it off each.
  void flatten() {
    std::vector<double> sum(value.size(), 0), weight(value.size(), 0), sum2(sum), weight2(sum);
    const auto kernel = [](double spacing) {
      std::vector<double> w;
      for (int n = 0; n * spacing <= 2.5 * around_sigma_mm; ++n) {
        const double d = n * spacing / around_sigma_mm;
        w.push_back(std::exp(-0.5 * d * d));
      }
      return w;
    };
    const auto along_x = kernel(l.spacing_mm.x), along_y = kernel(l.spacing_mm.y);
    each([&](std::size_t v, double, double) { sum[v] = value[v], weight[v] = 1; });
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        for (int a = std::max(0, i - int(along_x.size()) + 1); a < std::min(l.size[0], i + int(along_x.size())); ++a) {
          const double w = along_x[std::size_t(std::abs(a - i))];
          sum2[at(i, j)] += w * sum[at(a, j)];
          weight2[at(i, j)] += w * weight[at(a, j)];
        }
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!known[at(i, j)]) continue;
        double s = 0, total = 0;
        for (int b = std::max(0, j - int(along_y.size()) + 1); b < std::min(l.size[1], j + int(along_y.size())); ++b) {
          const double w = along_y[std::size_t(std::abs(b - j))];
          s += w * sum2[at(i, b)];
          total += w * weight2[at(i, b)];
        }
        value[at(i, j)] = std::clamp(value[at(i, j)] - float(s / total), -max_hu, max_hu);
      }
  }

  /// The RMS of the means along the lines of one direction.
  double line_rms(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    std::vector<double> sum(std::size_t(2 * reach_mm / line_mm) + 2, 0), count(sum);
    each([&](std::size_t v, double x, double y) {
      const std::size_t n = std::size_t((y * c - x * s + reach_mm) / line_mm);
      sum[n] += value[v];
      ++count[n];
    });
    double squares = 0;
    int lines = 0;
    for (std::size_t n = 0; n < sum.size(); ++n) {
      if (count[n] * pixel_mm2 / line_mm < min_line_mm) continue;
      squares += (sum[n] / count[n]) * (sum[n] / count[n]);
      ++lines;
    }
    return lines ? std::sqrt(squares / lines) : 0;
  }

  /// The direction of the streaks in this slice; their RMS is 0 where there are none.
  struct Direction {
    double angle = 0, rms_hu = 0;
  };
  Direction streaks() const {
    Direction best;
    std::vector<float> all;
    for (int n = 0; n < directions; ++n) {
      const double angle = n * (180.0 / directions) * degree, rms = line_rms(angle);
      all.push_back(float(rms));
      if (rms > best.rms_hu) best = {angle, rms};
    }
    if (best.rms_hu < min_rms_hu || best.rms_hu < min_ratio * median(all, 0.f)) best.rms_hu = 0;
    return best;
  }

  /// What the streaks of that direction add to each pixel.
  std::vector<float> along(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const int n = int(2 * reach_mm / cell_mm) + 3;
    std::vector<float> sum(std::size_t(n) * n, 0), count(sum), line(sum);
    const auto cell = [&](double x, double y) {
      return std::size_t((y * c - x * s + reach_mm) / cell_mm + 0.5) * n +
             std::size_t((x * c + y * s + reach_mm) / cell_mm + 0.5);
    };
    each([&](std::size_t v, double x, double y) {
      sum[cell(x, y)] += value[v];
      ++count[cell(x, y)];
    });
    const int half = int(half_window_mm / cell_mm);
    std::vector<float> window;
    for (int row = 0; row < n; ++row)
      for (int t = 0; t < n; ++t) {
        const std::size_t first = std::size_t(row) * n;
        if (count[first + t] == 0) continue;
        window.clear();
        for (int u = std::max(0, t - half); u <= std::min(n - 1, t + half); ++u)
          if (count[first + u] > 0) window.push_back(sum[first + u] / count[first + u]);
        if (double(window.size()) * cell_mm >= min_window_mm) line[first + t] = median(window, 0.f);
      }
    std::vector<float> out(value.size(), 0);
    each([&](std::size_t v, double x, double y) { out[v] = line[cell(x, y)]; });
    return out;
  }
};

}  // namespace

std::vector<StreakedSlice> remove_streaks(grid::Grid<float>& hu, const BitMask& known, const Progress& progress) {
  std::vector<double> rms(std::size_t(hu.size[2]), 0);
  parallel_for(0, hu.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k) {
      Slice slice(hu, known, k);
      if (slice.area_mm2() < min_area_mm2) continue;
      slice.flatten();
      for (int pass = 0; pass < max_passes; ++pass) {
        const Slice::Direction streaks = slice.streaks();
        if (streaks.rms_hu == 0) break;
        rms[k] = std::max(rms[k], streaks.rms_hu);
        const std::vector<float> off = slice.along(streaks.angle);
        for (int j = 0; j < hu.size[1]; ++j)
          for (int i = 0; i < hu.size[0]; ++i) {
            hu.at(i, j, k) -= off[slice.at(i, j)];
            slice.value[slice.at(i, j)] -= off[slice.at(i, j)];
          }
      }
    }
  });
  std::vector<StreakedSlice> out;
  for (int k = 0; k < hu.size[2]; ++k)
    if (rms[k] > 0) out.push_back({k, rms[k]});
  return out;
}

}  // namespace trephine::mask
