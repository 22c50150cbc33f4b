// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/along_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace trephine::segmentation {
namespace {

/// A grid between its voxels, at mm from voxel (0, 0, 0) along its axes; clamped at its ends.
class Sampler {
 public:
  explicit Sampler(const Grid<float>& g) : g_(g) {
    for (int a = 0; a < 3; ++a)
      step_[a] = g.size[a] > 1 ? (a == 0 ? 1 : a == 1 ? g.size[0] : std::size_t(g.size[0]) * g.size[1]) : 0;
  }
  float operator()(Vec3 p) const {
    float part[3];
    std::size_t at = 0;
    for (int a = 0; a < 3; ++a) {
      const double x = std::clamp(p[a] / g_.spacing_mm[a], 0.0, g_.size[a] - 1.0);
      const int i = std::min(int(x), std::max(0, g_.size[a] - 2));
      part[a] = float(x - i);
      at += std::size_t(i) * (a == 0 ? 1 : a == 1 ? std::size_t(g_.size[0]) : std::size_t(g_.size[0]) * g_.size[1]);
    }
    const float* v = &g_.voxels[at];
    const auto line = [&](std::size_t o) { return v[o] + part[0] * (v[o + step_[0]] - v[o]); };
    const auto plane = [&](std::size_t o) { return line(o) + part[1] * (line(o + step_[1]) - line(o)); };
    return plane(0) + part[2] * (plane(step_[2]) - plane(0));
  }
  Vec3 gradient(Vec3 p) const {
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      Vec3 d;
      d[a] = 0.5 * g_.spacing_mm[a];
      g[a] = ((*this)(p + d) - (*this)(p - d)) / g_.spacing_mm[a];
    }
    return g;
  }

 private:
  const Grid<float>& g_;
  std::size_t step_[3];
};

struct Spot {
  double x, y, weight;
};

/// A patch's points: the middle and rings around it.
std::vector<Spot> patch(double sigma_mm) {
  std::vector<Spot> spots{{0, 0, 1}};
  constexpr int rings = 3;
  const double width = 2 * sigma_mm / rings;
  for (int r = 1; r <= rings; ++r) {
    const int n = 6 * r;  // each point stands for about the same area
    for (int i = 0; i < n; ++i) {
      const double angle = 6.283185307179586 * (i + 0.5 * (r % 2)) / n;
      spots.push_back({r * width * std::cos(angle), r * width * std::sin(angle),
                       std::exp(-0.5 * r * r * width * width / (sigma_mm * sigma_mm))});
    }
  }
  return spots;
}

}  // namespace

Grid<float> averaged_along(const Grid<float>& hu, const Grid<float>& distance, double reach_mm, double sigma_mm,
                           const Progress& progress) {
  constexpr double off_level_mm = 0.25, least_cosine = 0.6, least_slope = 0.3;
  const std::vector<Spot> spots = patch(sigma_mm);
  const Sampler value(hu), level(distance);
  Grid<float> out = hu;
  parallel_for(0, hu.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < hu.size[1]; ++j)
        for (int i = 0; i < hu.size[0]; ++i) {
          const double here = distance.at(i, j, k);
          if (!(std::abs(here) < reach_mm)) continue;
          const Vec3 p{i * hu.spacing_mm.x, j * hu.spacing_mm.y, k * hu.spacing_mm.z};
          const Vec3 slope = level.gradient(p);
          if (norm(slope) < least_slope) continue;
          const Vec3 n = normalized(slope);
          const Vec3 u = normalized(cross(n, std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), w = cross(n, u);
          double sum = 0, weight = 0;
          for (const Spot& s : spots) {
            Vec3 q = p + u * s.x + w * s.y;
            if (s.x != 0 || s.y != 0) {
              bool on_level = false;
              for (int step = 0; step < 2; ++step) {
                const Vec3 g = level.gradient(q);
                const double gg = dot(g, g);
                if (gg < least_slope * least_slope || dot(g, n) < least_cosine * std::sqrt(gg)) break;
                q -= g * ((level(q) - here) / gg);
                on_level = std::abs(level(q) - here) < off_level_mm;
                if (on_level) break;
              }
              if (!on_level) continue;
            }
            sum += s.weight * value(q);
            weight += s.weight;
          }
          out.at(i, j, k) = float(sum / weight);
        }
  });
  return out;
}

}  // namespace trephine::segmentation
