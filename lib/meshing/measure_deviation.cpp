// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/measure_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace trephine {
namespace {

constexpr std::int64_t grain = 2048;
constexpr double infinity = std::numeric_limits<double>::infinity();

double mean_edge_of(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) sum += norm(mesh.points_mm[t[c]] - mesh.points_mm[t[(c + 1) % 3]]);
  return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

double squared_to(const TriMesh& mesh, std::uint32_t triangle, Vec3 p) {
  const auto& v = mesh.triangles[triangle];
  const Vec3 d = p - closest_on_triangle(p, mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]]);
  return dot(d, d);
}

/// Weighted figures of distances; the percentile by a histogram.
class Gathering {
 public:
  explicit Gathering(double max_mm) : max_mm_(max_mm), bins_(65537, 0.0) {}
  void add(float distance, double weight) {
    weight_ += weight;
    squares_ += weight * distance * distance;
    bins_[static_cast<std::size_t>(max_mm_ > 0 ? distance / max_mm_ * 65536 : 0)] += weight;
  }
  void into(DeviationFigures& f) const {
    if (!(weight_ > 0)) return;
    f.rms_mm = std::max(f.rms_mm, std::sqrt(squares_ / weight_));
    double below = 0;
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      below += bins_[b];
      if (below < 0.99 * weight_) continue;
      f.p99_mm = std::max(f.p99_mm, std::min(max_mm_, (static_cast<double>(b) + 1) / 65536 * max_mm_));
      return;
    }
  }

 private:
  double max_mm_, weight_ = 0, squares_ = 0;
  std::vector<double> bins_;
};

}  // namespace

DeviationMeter::DeviationMeter(const TriMesh& input, double limit_mm)
    : input_(input),
      limit2_(limit_mm > 0 ? limit_mm * limit_mm : infinity),
      edge_(mean_edge_of(input)),
      spacing_(limit_mm > 0 ? std::clamp(1.5 * limit_mm, edge_ / 4, edge_) : edge_),
      exact_beyond2_(limit_mm > 0 ? limit2_ / 4 : edge_ * edge_ / 1024),
      tree_(input),
      incidence_(input),
      raster_of_(input.triangles.size(), CollapseMesh::none) {}

/// Going from a point to its neighbours as long as that leads nearer: an upper bound of the squared distance.
double DeviationMeter::downhill(Vec3 place, std::uint32_t& near) const {
  const auto squared = [&](std::uint32_t v) {
    const Vec3 d = place - input_.points_mm[v];
    return dot(d, d);
  };
  double best = squared(near);
  for (std::uint32_t centre = CollapseMesh::none; centre != near;) {
    centre = near;
    for (std::uint32_t n = incidence_.begin[centre]; n < incidence_.begin[centre + 1]; ++n) {
      const auto& t = input_.triangles[incidence_.triangle[n]];
      const std::uint32_t v = t[0] == centre ? t[1] : t[1] == centre ? t[2] : t[0];
      const double d2 = squared(v);
      if (d2 >= best) continue;
      best = d2;
      near = v;
    }
  }
  for (std::uint32_t n = incidence_.begin[near]; n < incidence_.begin[near + 1]; ++n)
    best = std::min(best, squared_to(input_, incidence_.triangle[n], place));
  return best;
}

double DeviationMeter::squared_distance(Vec3 place, std::uint32_t& near) const {
  const double bound = downhill(place, near);
  if (bound <= exact_beyond2_) return bound;
  std::uint32_t at = CollapseMesh::none;
  const double d2 = tree_.squared_distance(place, bound, &at);
  if (at != CollapseMesh::none) near = input_.triangles[at][0];
  return d2;
}

/// Calls visit(place) over the raster, back and forth, so that each lies beside the last, until it returns false.
template <class Visit>
void DeviationMeter::for_each_sample(const std::array<Vec3, 3>& corners, Visit&& visit) const {
  const Vec3 a = corners[0], ab = corners[1] - a, ac = corners[2] - a;
  const double longest = std::max({norm(ab), norm(ac), norm(ac - ab)});
  const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing_), 1.0, 256.0));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n - i; ++j) {
      const int k = i % 2 == 0 ? j : n - i - j;
      if (!visit(a + ab * (double(i) / n) + ac * (double(k) / n))) return;
    }
}

bool DeviationMeter::within(const std::array<Vec3, 3>& corners, std::uint32_t& near) const {
  bool good = true;
  for_each_sample(corners, [&](Vec3 p) { return good = squared_distance(p, near) <= limit2_; });
  return good;
}

void DeviationMeter::from_triangle(std::uint32_t raster, const std::array<Vec3, 3>& corners, std::uint32_t near) {
  Raster& r = rasters_[raster];
  r.area = norm(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
  r.beyond = false;
  r.distances.clear();
  for_each_sample(corners, [&](Vec3 p) {
    const double d2 = squared_distance(p, near);
    r.beyond |= d2 > limit2_;
    r.distances.push_back(static_cast<float>(std::sqrt(d2)));
    return true;
  });
}

void DeviationMeter::from_input(const TriMesh& plain, const std::vector<std::uint32_t>& triangle_of,
                                const CarriedPoints& carried, std::vector<std::uint32_t>& beyond,
                                const Progress& progress) {
  const TriangleTree tree(plain);
  std::vector<std::uint32_t> plain_of(input_.triangles.size());
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t) plain_of[triangle_of[t]] = t;
  const auto triangles = static_cast<std::int64_t>(input_.triangles.size());
  std::vector<std::vector<std::uint32_t>> found((triangles + grain - 1) / grain);
  std::vector<std::vector<float>> distances(found.size());
  // A triangle samples its middle, the middles of the sides that it runs upwards, and the points that it is the first
  // to use.
  parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    const auto add = [&](Vec3 p, double bound, const std::uint32_t(&carrier)[3]) {
      if (bound * bound > exact_beyond2_) {
        bound = std::sqrt(tree.squared_distance(p, bound * bound));
        if (bound * bound > limit2_) found[from / grain].insert(found[from / grain].end(), carrier, carrier + 3);
      }
      distances[from / grain].push_back(static_cast<float>(bound));
    };
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = input_.triangles[t];
      Vec3 p[3];
      std::uint32_t carrier[3];
      double d[3];
      for (int c = 0; c < 3; ++c) {
        p[c] = input_.points_mm[v[c]];
        carrier[c] = carried.carrier(v[c]);
        d[c] = std::sqrt(carried.squared_distance(v[c]));
      }
      // The distance to one triangle is a convex function: between points of one carrier it is at most their mean.
      const auto between = [&](Vec3 place, int a, int b) {
        if (carrier[a] == carrier[b]) return (d[a] + d[b]) / 2;
        return std::sqrt(
            std::min(squared_to(plain, plain_of[carrier[a]], place), squared_to(plain, plain_of[carrier[b]], place)));
      };
      for (int c = 0; c < 3; ++c) {
        if (incidence_.triangle[incidence_.begin[v[c]]] == t) add(p[c], d[c], carrier);
        const int e = (c + 1) % 3;
        if (v[c] < v[e]) add((p[c] + p[e]) / 2, between((p[c] + p[e]) / 2, c, e), carrier);
      }
      const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
      if (carrier[0] == carrier[1] && carrier[1] == carrier[2])
        add(middle, (d[0] + d[1] + d[2]) / 3, carrier);
      else
        add(middle, std::min(between(middle, 0, 1), between(middle, 1, 2)), carrier);
    }
  });
  forward_.clear();
  for (const auto& d : distances) forward_.insert(forward_.end(), d.begin(), d.end());
  for (const auto& f : found) beyond.insert(beyond.end(), f.begin(), f.end());
}

std::vector<std::uint32_t> DeviationMeter::measure(const CollapseMesh& mesh, const TriMesh& plain,
                                                   const std::vector<std::uint32_t>& triangle_of,
                                                   const CarriedPoints& carried, const Progress& progress) {
  std::vector<std::uint32_t> beyond;
  from_input(plain, triangle_of, carried, beyond, progress);
  progress.report(0.3);

  std::vector<std::uint32_t> to_do;  // triangles of `plain` that are new or changed
  live_.clear();
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t) {
    std::uint32_t& raster = raster_of_[triangle_of[t]];
    const std::uint32_t change = mesh.last_change(triangle_of[t]);
    if (raster == CollapseMesh::none || rasters_[raster].measured_change != change) {
      if (raster == CollapseMesh::none) {
        raster = static_cast<std::uint32_t>(rasters_.size());
        rasters_.emplace_back();
      }
      rasters_[raster].measured_change = change;
      to_do.push_back(t);
    }
    live_.push_back(raster);
  }
  // Searches start at a point that the triangle carries, or where the triangle of the same number lay in the input.
  std::vector<std::uint32_t> start(input_.triangles.size());
  for (std::uint32_t t = 0; t < start.size(); ++t) start[t] = input_.triangles[t][0];
  for (std::uint32_t p = 0; p < input_.points_mm.size(); ++p) start[carried.carrier(p)] = p;
  parallel_for(0, static_cast<std::int64_t>(to_do.size()), 256, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t n = from; n < to; ++n) {
      const auto& v = plain.triangles[to_do[n]];
      const std::array<Vec3, 3> corners{plain.points_mm[v[0]], plain.points_mm[v[1]], plain.points_mm[v[2]]};
      from_triangle(live_[to_do[n]], corners, start[triangle_of[to_do[n]]]);
    }
  });
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t)
    if (rasters_[live_[t]].beyond) beyond.push_back(triangle_of[t]);
  std::sort(beyond.begin(), beyond.end());
  beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
  progress.report(1);
  return beyond;
}

DeviationFigures DeviationMeter::figures() const {
  DeviationFigures f;
  for (const float d : forward_) f.max_mm = std::max(f.max_mm, double(d));
  for (const std::uint32_t r : live_)
    for (const float d : rasters_[r].distances) f.max_mm = std::max(f.max_mm, double(d));
  Gathering forward(f.max_mm), backward(f.max_mm);
  for (const float d : forward_) forward.add(d, 1);
  for (const std::uint32_t r : live_)
    for (const float d : rasters_[r].distances)
      backward.add(d, rasters_[r].area / static_cast<double>(rasters_[r].distances.size()));
  forward.into(f);
  backward.into(f);
  return f;
}

}  // namespace trephine
