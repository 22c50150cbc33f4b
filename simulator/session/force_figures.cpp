// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/force_figures.h"

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace trephine::session {

using haptics::ServoFrame;

namespace {

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

// The derivative of the force's size by central differences, for all frames of the window but its first and last.
struct Slopes {
  std::vector<double> n_per_s;
  double mean = 0, sigma = 0;
  bool is_anomaly(std::size_t n) const { return std::abs(n_per_s[n] - mean) > 10 * sigma; }
};

Slopes slopes_of(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  Slopes out;
  const auto size = [&](std::size_t n) { return norm(vec(frames[n].force_n)); };
  for (std::size_t n = window.begin + 1; n + 1 < window.end; ++n)
    out.n_per_s.push_back((size(n + 1) - size(n - 1)) / (2 * frames[n].dt_s));
  double square = 0;
  for (const double s : out.n_per_s) out.mean += s / double(out.n_per_s.size());
  for (const double s : out.n_per_s) square += (s - out.mean) * (s - out.mean) / double(out.n_per_s.size());
  out.sigma = std::sqrt(square);
  return out;
}

bool is_empty(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  return window.begin >= window.end || window.end > frames.size();
}

}  // namespace

std::vector<std::size_t> force_anomalies(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  std::vector<std::size_t> places;
  if (is_empty(frames, window)) return places;
  const Slopes slopes = slopes_of(frames, window);
  for (std::size_t n = 0; n < slopes.n_per_s.size(); ++n)
    if (slopes.is_anomaly(n)) places.push_back(window.begin + 1 + n);
  return places;
}

ForceWindow force_window(const std::vector<ServoFrame>& frames, double settle_s) {
  std::size_t first = 0;
  while (first < frames.size() && frames[first].touched == 0) ++first;
  while (first < frames.size() && settle_s > 0) settle_s -= frames[first++].dt_s;
  return {first, frames.size()};
}

ForceFigures force_figures(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  ForceFigures f;
  if (is_empty(frames, window)) return f;
  const std::size_t first = window.begin, last = window.end - 1;
  std::vector<double> size;
  double lag = 0;
  for (std::size_t n = first; n <= last; ++n) {
    const ServoFrame& a = frames[n];
    const Vec3 force = vec(a.force_n);
    size.push_back(norm(force));
    f.zero_force_ratio += force == Vec3{};
    f.mean_force_n += size.back();
    f.most_force_n = std::max(f.most_force_n, size.back());
    if (n > first) f.max_step_n = std::max(f.max_step_n, norm(force - vec(frames[n - 1].force_n)));
    if (a.touched == 0) continue;
    ++f.touching;
    const Vec3 behind = vec(a.proxy_mm) - vec(a.tip_mm), normal = vec(a.normal);
    const double along = norm(behind - normal * dot(normal, behind));
    lag += along;
    f.max_lag_mm = std::max(f.max_lag_mm, along);
  }
  f.frames = size.size();
  f.zero_force_ratio /= double(f.frames);
  f.mean_force_n /= double(f.frames);
  f.mean_lag_mm = f.touching > 0 ? lag / double(f.touching) : 0;
  const Slopes slopes = slopes_of(frames, window);
  if (slopes.n_per_s.empty()) return f;
  f.sigma_n_per_s = slopes.sigma;
  f.anomaly_ratio = double(force_anomalies(frames, window).size()) / double(slopes.n_per_s.size());
  return f;
}

}  // namespace trephine::session
