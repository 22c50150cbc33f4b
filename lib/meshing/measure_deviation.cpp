// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/measure_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "meshing/triangle_tree.h"

namespace trephine {
namespace {

constexpr std::int64_t grain = 2048;

struct Samples {
  std::vector<std::vector<std::pair<float, float>>> pieces;  ///< distance and weight, per piece of the loop
  std::vector<std::vector<std::uint32_t>> beyond;
  explicit Samples(std::size_t count) : pieces((count + grain - 1) / grain), beyond(pieces.size()) {}
};

double mean_edge_mm(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) sum += norm(mesh.points_mm[t[c]] - mesh.points_mm[t[(c + 1) % 3]]);
  return sum / (3.0 * mesh.triangles.size());
}

void add_to(DeviationSample& result, Samples& samples) {
  std::vector<std::pair<float, float>> all;
  for (auto& p : samples.pieces) {
    all.insert(all.end(), p.begin(), p.end());
    p = {};
  }
  double weight = 0, squares = 0;
  for (const auto& s : all) {
    weight += s.second;
    squares += double(s.second) * s.first * s.first;
    result.max_mm = std::max(result.max_mm, double(s.first));
  }
  result.rms_mm = std::max(result.rms_mm, std::sqrt(squares / weight));
  std::sort(all.begin(), all.end());
  double below = 0;
  for (const auto& s : all) {
    below += s.second;
    if (below < 0.99 * weight) continue;
    result.p99_mm = std::max(result.p99_mm, double(s.first));
    break;
  }
  for (const auto& b : samples.beyond) result.beyond.insert(result.beyond.end(), b.begin(), b.end());
}

/// Every point of the input, and the middle of every triangle, to the result.
Samples forward(const TriMesh& input, const TriMesh& result, const TriangleTree& tree, double limit_mm,
                const CarriedPoints* carried, const std::vector<std::uint32_t>& triangle_of, const Progress& progress) {
  std::vector<std::uint32_t> result_of;  // carrier's triangle -> the result's
  if (carried) {
    result_of.assign(input.triangles.size(), CollapseMesh::none);
    for (std::uint32_t t = 0; t < triangle_of.size(); ++t) result_of[triangle_of[t]] = t;
  }
  const double infinity = std::numeric_limits<double>::infinity();
  const double limit2 = limit_mm > 0 ? limit_mm * limit_mm : infinity;
  const auto to_triangle = [&](Vec3 p, std::uint32_t t) {
    const auto& v = result.triangles[t];
    const Vec3 d = p - closest_on_triangle(p, result.points_mm[v[0]], result.points_mm[v[1]], result.points_mm[v[2]]);
    return dot(d, d);
  };
  Samples samples(input.triangles.size());
  std::vector<char> first_use(3 * input.triangles.size(), 0);
  {
    std::vector<char> seen(input.points_mm.size(), 0);
    for (std::size_t t = 0; t < input.triangles.size(); ++t)
      for (int c = 0; c < 3; ++c) {
        first_use[3 * t + c] = !seen[input.triangles[t][c]];
        seen[input.triangles[t][c]] = 1;
      }
  }
  parallel_for(0, static_cast<std::int64_t>(input.triangles.size()), grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    auto& out = samples.pieces[from / grain];
    const auto search = [&](Vec3 p, double bound2) {
      std::uint32_t at = 0;
      const double d2 = tree.squared_distance(p, bound2, &at);
      if (d2 > limit2) samples.beyond[from / grain].push_back(at);
      return d2;
    };
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = input.triangles[t];
      const Vec3 middle = (input.points_mm[v[0]] + input.points_mm[v[1]] + input.points_mm[v[2]]) / 3;
      double middle2 = infinity;
      for (int c = 0; c < 3; ++c) {
        double d2 = carried ? carried->squared_distance(v[c]) : infinity;
        if (carried) middle2 = std::min(middle2, to_triangle(middle, result_of[carried->carrier(v[c])]));
        if (!first_use[3 * t + c]) continue;
        if (d2 > limit2 || !carried) d2 = search(input.points_mm[v[c]], infinity);
        out.emplace_back(static_cast<float>(std::sqrt(d2)), 1.0f);
      }
      if (middle2 > limit2 || !carried) middle2 = search(middle, infinity);
      out.emplace_back(static_cast<float>(std::sqrt(middle2)), 1.0f);
    }
  });
  return samples;
}

/// A raster over every triangle of the result, to the input.
Samples backward(const TriMesh& input, const TriMesh& result, double limit_mm, const Progress& progress) {
  const TriangleTree tree(input);
  const double spacing = mean_edge_mm(input);
  const double limit2 = limit_mm > 0 ? limit_mm * limit_mm : std::numeric_limits<double>::infinity();
  Samples samples(result.triangles.size());
  parallel_for(0, static_cast<std::int64_t>(result.triangles.size()), grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = result.triangles[t];
      const Vec3 a = result.points_mm[v[0]], b = result.points_mm[v[1]], c = result.points_mm[v[2]];
      const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
      const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, 256.0));
      const double area = norm(cross(b - a, c - a)) / 2;
      const auto weight = static_cast<float>(area / ((n + 1) * (n + 2) / 2));
      bool over = false;
      Vec3 before;
      double distance = std::numeric_limits<double>::infinity();
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n - i; ++j) {
          const Vec3 p = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n);
          // The distance cannot have grown by more than the way from the last sample.
          const double bound = (distance + norm(p - before)) * (1 + 1e-9) + 1e-12 * longest;
          const double d2 = tree.squared_distance(p, bound * bound);
          distance = std::sqrt(d2);
          before = p;
          over |= d2 > limit2;
          samples.pieces[from / grain].emplace_back(static_cast<float>(distance), weight);
        }
      if (over) samples.beyond[from / grain].push_back(static_cast<std::uint32_t>(t));
    }
  });
  return samples;
}

}  // namespace

DeviationSample measure_deviation(const TriMesh& input, const TriMesh& result, double limit_mm,
                                  const CarriedPoints* carried, const std::vector<std::uint32_t>& triangle_of,
                                  const Progress& progress) {
  DeviationSample sample;
  {
    const TriangleTree tree(result);
    Samples s = forward(input, result, tree, limit_mm, carried, triangle_of, progress);
    add_to(sample, s);
  }
  progress.report(0.5);
  Samples s = backward(input, result, limit_mm, progress);
  add_to(sample, s);
  std::sort(sample.beyond.begin(), sample.beyond.end());
  sample.beyond.erase(std::unique(sample.beyond.begin(), sample.beyond.end()), sample.beyond.end());
  progress.report(1);
  return sample;
}

}  // namespace trephine
