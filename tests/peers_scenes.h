// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the tests of algorithms share.
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "peers/contact_algorithm.h"
#include "peers/experiment.h"
#include "surface/trimesh.h"

namespace trephine::peers {

inline haptics::HapticInput at(Vec3 p) {
  haptics::HapticInput in;
  in.tip_mm = p;
  in.dt_s = in.period_s = tick_s;
  return in;
}

// Moves the device in even steps and makes a picture for each tick, so that what pictures miss is not in the way.
inline const haptics::HapticState& go(ContactAlgorithm& a, Vec3 from, Vec3 to, int ticks = 200) {
  const haptics::HapticState* state = nullptr;
  for (int n = 0; n <= ticks; ++n) {
    const Vec3 p = from + (to - from) * (double(n) / ticks);
    a.client(p);
    state = &a.update(at(p));
  }
  return *state;
}

// A surface z(x, y) over 40 x 40 mm in squares of `step` mm, open below: only its front is met.
inline surface::TriMesh landscape(const std::function<double(double, double)>& z, double step = 1, Vec3 origin = {}) {
  const int n = int(std::lround(40 / step));
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) points.push_back({i * step - 20, j * step - 20, z(i * step - 20, j * step - 20)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto p = [&](int di, int dj) { return std::uint32_t((j + dj) * (n + 1) + i + di); };
      triangles.push_back({p(0, 0), p(1, 0), p(1, 1)});
      triangles.push_back({p(0, 0), p(1, 1), p(0, 1)});
    }
  surface::TriMesh m;
  m.origin_mm = origin;
  m.points_mm = std::move(points);
  m.triangles = std::move(triangles);
  return m;
}

inline double flat(double, double) { return 0; }

inline PeerParams one_newton_a_mm() {
  PeerParams p;
  p.spring_n_per_mm = 1;
  p.god_object_lift_mm = 1e-6;  // its own falls are tested apart
  return p;
}

}  // namespace trephine::peers
