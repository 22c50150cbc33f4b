// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/ray_column.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"

namespace trephine::surface::detail {
namespace {

constexpr std::uint32_t unset = 0xffffffff;
constexpr int cells_a_side = 24;

struct Hit {
  double at;
  bool enters;
};

/// On which side of the edge from the lower to the higher index the ray passes, turned for who runs it backwards. A ray
/// through an edge or a point counts as moved aside by an infinitesimal step, more in u than in v.
bool left_of_edge(const std::vector<Vec3>& points, std::uint32_t from, std::uint32_t to, double u, double v) {
  const Vec3& a = points[std::min(from, to)];
  const Vec3& b = points[std::max(from, to)];
  const double s = (b.x - a.x) * (v - a.y) - (b.y - a.y) * (u - a.x);
  const bool left = s > 0 || (s == 0 && (b.y < a.y || (b.y == a.y && b.x > a.x)));
  return left == (from < to);
}

/// Height of the triangle's plane at (u, v), within the triangle's own heights.
double height_at(Vec3 a, Vec3 b, Vec3 c, double u, double v) {
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const double low = std::min({a.z, b.z, c.z}), high = std::max({a.z, b.z, c.z});
  if (area == 0) return 0.5 * (low + high);
  const double wb = ((u - a.x) * (c.y - a.y) - (v - a.y) * (c.x - a.x)) / area;
  const double wc = ((b.x - a.x) * (v - a.y) - (b.y - a.y) * (u - a.x)) / area;
  return std::clamp(a.z + wb * (b.z - a.z) + wc * (c.z - a.z), low, high);
}

}  // namespace

RayColumn::RayColumn(const TriMesh& mesh, Vec3 at_mm, Vec3 axis, double radius_mm)
    : radius_mm_(radius_mm), cells_(cells_a_side * cells_a_side) {
  const Vec3 seed = std::fabs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  across_ = normalized(seed - axis * dot(seed, axis));
  upwards_ = cross(axis, across_);
  const Vec3 shift = mesh.origin_mm - at_mm;
  const auto local = [&](std::uint32_t i) {
    const Vec3 d = mesh.points_mm[i] + shift;
    return Vec3{dot(d, across_), dot(d, upwards_), dot(d, axis)};
  };
  std::vector<std::uint32_t> number(mesh.points_mm.size(), unset);
  std::vector<Vec3> flat(mesh.points_mm.size());
  for (std::uint32_t i = 0; i < flat.size(); ++i) flat[i] = local(i);
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = flat[t[0]], &b = flat[t[1]], &c = flat[t[2]];
    if (std::min({a.x, b.x, c.x}) > radius_mm || std::max({a.x, b.x, c.x}) < -radius_mm ||
        std::min({a.y, b.y, c.y}) > radius_mm || std::max({a.y, b.y, c.y}) < -radius_mm)
      continue;
    std::array<std::uint32_t, 3> kept;
    for (int k = 0; k < 3; ++k) {
      auto& n = number[t[k]];
      if (n == unset) {
        n = static_cast<std::uint32_t>(points_.size());
        points_.push_back(flat[t[k]]);
      }
      kept[k] = n;
    }
    const int u0 = cell(std::min({a.x, b.x, c.x})), u1 = cell(std::max({a.x, b.x, c.x}));
    const int v0 = cell(std::min({a.y, b.y, c.y})), v1 = cell(std::max({a.y, b.y, c.y}));
    for (int j = v0; j <= v1; ++j)
      for (int i = u0; i <= u1; ++i)
        cells_[j * cells_a_side + i].push_back(static_cast<std::uint32_t>(triangles_.size()));
    triangles_.push_back(kept);
  }
}

int RayColumn::cell(double x) const {
  const double share = std::clamp((x / radius_mm_ + 1) / 2, 0.0, 1.0);
  return std::min(cells_a_side - 1, static_cast<int>(share * cells_a_side));
}

std::vector<Span> RayColumn::spans(double u, double v, double merge_mm) const {
  std::vector<Hit> hits;
  for (const std::uint32_t number : cells_[cell(v) * cells_a_side + cell(u)]) {
    const auto& t = triangles_[number];
    const bool side = left_of_edge(points_, t[0], t[1], u, v);
    if (left_of_edge(points_, t[1], t[2], u, v) != side || left_of_edge(points_, t[2], t[0], u, v) != side) continue;
    // A triangle that is counter-clockwise about the axis faces along it, so the ray leaves the solid there.
    hits.push_back({height_at(points_[t[0]], points_[t[1]], points_[t[2]], u, v), !side});
  }
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return a.at < b.at || (a.at == b.at && a.enters && !b.enters); });
  std::vector<Span> spans;
  int depth = 0;
  for (const Hit& hit : hits) {
    if (hit.enters) {
      if (depth++ > 0) continue;
      if (!spans.empty() && hit.at - spans.back().leave <= merge_mm) continue;
      spans.push_back({hit.at, hit.at});
    } else if (depth > 0 && --depth == 0) {
      spans.back().leave = hit.at;
    }
  }
  return spans;
}

std::vector<std::array<double, 2>> disc_samples(int inside, int on_rim) {
  const double golden = pi * (3 - std::sqrt(5.0));
  std::vector<std::array<double, 2>> samples;
  for (int i = 0; i < inside; ++i) {
    const double r = std::sqrt((i + 0.5) / inside), angle = golden * i;
    samples.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  for (int i = 0; i < on_rim; ++i) {
    const double angle = 2 * pi * i / on_rim;
    samples.push_back({std::cos(angle), std::sin(angle)});
  }
  return samples;
}

}  // namespace trephine::surface::detail
