// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/inside_query.h"

#include <algorithm>
#include <cmath>

namespace trephine::surface {
namespace {

// On which side of the edge from a to b, seen from above, the point lies; the same for both triangles of the edge. A
// point on the line, or on a corner, counts as one that lies a little to the right and much less upwards of it, for all
// edges alike.
bool left_of(const std::vector<Vec3>& p, std::uint32_t a, std::uint32_t b, double x, double y) {
  const bool turned = a > b;
  const Vec3 &u = p[turned ? b : a], &v = p[turned ? a : b];
  double side = (v.x - u.x) * (y - u.y) - (v.y - u.y) * (x - u.x);
  if (side == 0) side = v.y != u.y ? u.y - v.y : v.x - u.x;
  return (side > 0) != turned;
}

}  // namespace

InsideQuery::InsideQuery(const TriMesh& mesh) : bounds_(bounds_of(mesh)) {
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) points_.push_back(mesh.world_mm(n));
  triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
  const Vec3 side = bounds_.max_mm - bounds_.min_mm;
  cell_mm_ =
      std::max(1e-6, std::sqrt(std::max(1e-12, side.x * side.y) / double(std::max<std::size_t>(1, triangles_.size()))));
  across_ = int(side.x / cell_mm_) + 1;
  along_ = int(side.y / cell_mm_) + 1;
  const auto each_cell = [&](const std::array<std::uint32_t, 3>& t, const auto& visit) {
    Vec3 low = points_[t[0]], high = low;
    for (const std::uint32_t c : t)
      for (int a = 0; a < 2; ++a) {
        low[a] = std::min(low[a], points_[c][a]);
        high[a] = std::max(high[a], points_[c][a]);
      }
    const std::size_t from = cell_of(low.x, low.y), to = cell_of(high.x, high.y), row = std::size_t(across_);
    for (std::size_t j = from / row; j <= to / row; ++j)
      for (std::size_t i = from % row; i <= to % row; ++i) visit(j * row + i);
  };
  first_.assign(std::size_t(across_) * std::size_t(along_) + 1, 0);
  for (const auto& t : triangles_) each_cell(t, [&](std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  listed_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t n = 0; n < triangles_.size(); ++n)
    each_cell(triangles_[n], [&](std::size_t cell) { listed_[next[cell]++] = n; });
}

std::size_t InsideQuery::cell_of(double x, double y) const {
  const auto at = [&](double v, double low, int count) {
    return std::size_t(std::clamp(int((v - low) / cell_mm_), 0, count - 1));
  };
  return at(y, bounds_.min_mm.y, along_) * std::size_t(across_) + at(x, bounds_.min_mm.x, across_);
}

bool InsideQuery::inside(Vec3 p) const {
  for (int a = 0; a < 3; ++a)
    if (p[a] < bounds_.min_mm[a] || p[a] > bounds_.max_mm[a]) return false;
  bool in = false;
  const std::size_t cell = cell_of(p.x, p.y);
  for (std::uint32_t n = first_[cell]; n < first_[cell + 1]; ++n) {
    const auto& t = triangles_[listed_[n]];
    const bool side = left_of(points_, t[0], t[1], p.x, p.y);
    if (left_of(points_, t[1], t[2], p.x, p.y) != side || left_of(points_, t[2], t[0], p.x, p.y) != side) continue;
    const Vec3 a = points_[t[0]], normal = cross(points_[t[1]] - a, points_[t[2]] - a);
    if (normal.z == 0) continue;  // seen from its edge: its neighbours are crossed
    const double z = a.z - (normal.x * (p.x - a.x) + normal.y * (p.y - a.y)) / normal.z;
    in = in != (z > p.z);
  }
  return in;
}

}  // namespace trephine::surface
