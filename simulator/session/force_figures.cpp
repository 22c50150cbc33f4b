// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/force_figures.h"

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace trephine::session {

using haptics::ServoFrame;

namespace {

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

ForceWindow force_window(const std::vector<ServoFrame>& frames, double settle_s) {
  std::size_t first = 0;
  while (first < frames.size() && frames[first].touched == 0) ++first;
  while (first < frames.size() && settle_s > 0) settle_s -= frames[first++].dt_s;
  return {first, frames.size()};
}

ForceFigures force_figures(const std::vector<ServoFrame>& frames, const ForceWindow& window) {
  ForceFigures f;
  if (window.begin >= window.end || window.end > frames.size()) return f;
  const std::size_t first = window.begin, last = window.end - 1;
  std::vector<double> size, slope;
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
  for (std::size_t n = 1; n + 1 < size.size(); ++n)
    slope.push_back((size[n + 1] - size[n - 1]) / (2 * frames[first + n].dt_s));
  if (slope.empty()) return f;
  double mean = 0, square = 0;
  for (const double s : slope) mean += s / double(slope.size());
  for (const double s : slope) square += (s - mean) * (s - mean) / double(slope.size());
  f.sigma_n_per_s = std::sqrt(square);
  const auto out =
      std::count_if(slope.begin(), slope.end(), [&](double s) { return std::abs(s - mean) > 10 * f.sigma_n_per_s; });
  f.anomaly_ratio = double(out) / double(slope.size());
  return f;
}

}  // namespace trephine::session
