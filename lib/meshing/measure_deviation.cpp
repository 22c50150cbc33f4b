// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/measure_deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/parallel.h"
#include "meshing/marked_cells.h"

namespace trephine::meshing {
namespace {

constexpr std::int64_t grain = 2048;
/// Share of the limit from which distances are exact.
constexpr double exact_share = 0.85;
/// Triangles of the input that are passed over together.
constexpr std::int64_t block = 32;
constexpr double infinity = std::numeric_limits<double>::infinity();

double mean_edge_of(const surface::TriMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) sum += norm(mesh.points_mm[t[c]] - mesh.points_mm[t[(c + 1) % 3]]);
  return sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

double squared_to(const surface::TriMesh& mesh, std::uint32_t triangle, Vec3 p) {
  const auto& v = mesh.triangles[triangle];
  const Vec3 d = p - surface::closest_on_triangle(p, mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]]);
  return dot(d, d);
}

/// Weighted statistics of distances; the percentile comes from a histogram.
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

DeviationMeter::DeviationMeter(const NearInput& input, double limit_mm, double bound_mm)
    : near_(input),
      input_(input.mesh()),
      limit2_(limit_mm > 0 ? limit_mm * limit_mm : infinity),
      bound_(bound_mm * (1 - 1e-6)),  // for rounding: carried distances are floats
      edge_(mean_edge_of(input_)),
      spacing_(limit_mm > 0 ? std::clamp(1.5 * limit_mm, edge_ / 4, edge_) : 2 * edge_),
      raster_beyond2_(limit_mm > 0 ? 36 * limit2_ : infinity),
      exact_beyond2_(limit_mm > 0 ? exact_share * exact_share * limit2_ : edge_ * edge_ / 16),
      raster_of_(input_.triangles.size(), CollapseMesh::none) {}

/// The distance of a place, searched from a nearby point. Where that does not suffice and there is no search tree, it
/// is an upper bound, and `lacks_tree` is set.
void DeviationMeter::look(NearbyPlace& place, bool& lacks_tree) const {
  double d2 = near_.squared_bound(place.at, place.near, exact_beyond2_ / 36, &place.triangle);
  if (d2 > exact_beyond2_ && !tree_) lacks_tree = true;
  if (d2 > exact_beyond2_ && tree_) {
    std::uint32_t at = CollapseMesh::none;
    d2 = tree_->squared_distance(place.at, d2, &at);
    if (at != CollapseMesh::none) {
      place.triangle = at;
      place.near = input_.triangles[at][0];
    }
  }
  place.distance = std::sqrt(d2);
}

/// Searches from the nearest of the points at hand. Returns false and measures nothing where the search tree is needed.
bool DeviationMeter::from_triangle(Raster& raster, Room& room) const {
  room.places.clear();
  for (const std::uint32_t p : room.points) room.places.add(input_.points_mm[p]);
  const Vec3 a = raster.corners[0], ab = raster.corners[1] - a, ac = raster.corners[2] - a;
  const double longest = std::max({norm(ab), norm(ac), norm(ac - ab)});
  const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing_), 1.0, 256.0));
  const bool limited = limit2_ < infinity;
  raster.beyond = false;
  raster.distances.clear();
  raster.distances.reserve(static_cast<std::size_t>(n + 1) * (n + 2) / 2);
  room.samples.clear();
  room.lacks_tree = false;
  // Without a limit a side's points belong to the one of its two triangles that runs along it from its lower end.
  const auto runs_up = [](Vec3 p, Vec3 q) { return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z); };
  const auto& c = raster.corners;
  const bool own[3] = {runs_up(c[0], c[1]), runs_up(c[1], c[2]), runs_up(c[2], c[0])};
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n - i; ++j) {
      const int sides = (i == 0) + (j == 0) + (i + j == n);
      if (!limited && sides == 1 && !own[j == 0 ? 0 : i == 0 ? 2 : 1]) continue;
      NearbyPlace s;
      s.at = a + ab * (double(i) / n) + ac * (double(j) / n);
      bool certainly = false;
      s.near = room.points[room.places.nearest(s.at, 0, certainly)];
      look(s, room.lacks_tree);
      if (room.lacks_tree) return raster.distances.clear(), false;
      raster.beyond |= s.distance * s.distance > limit2_;
      raster.distances.push_back(static_cast<float>(s.distance));
      if (limited) room.samples.push_back(s);
    }
  raster.proven = !limited || raster.beyond || cells_proven(room.samples, n, room);
  if (room.lacks_tree) raster.distances.clear();
  return !room.lacks_tree;
}

/// Whether every cell of a raster with n steps along each side is proven to lie within the bound.
bool DeviationMeter::cells_proven(const std::vector<NearbyPlace>& samples, int n, Room& room) const {
  const auto check = [&](const NearbyPlace& a, const NearbyPlace& b, const NearbyPlace& c) {
    return proven_within(
        {a, b, c}, bound_, input_, [&](NearbyPlace& p) { look(p, room.lacks_tree); }, room.stack);
  };
  for (int i = 0; i < n; ++i) {
    const NearbyPlace* row = samples.data() + i * (n + 1) - i * (i - 1) / 2;
    const NearbyPlace* next = row + n - i + 1;
    for (int j = 0; j < n - i; ++j)
      if (!check(row[j], next[j], row[j + 1]) || (j + 1 < n - i && !check(next[j], next[j + 1], row[j + 1])))
        return false;
  }
  return true;
}

/// A proof holds as long as no part of the mesh that lay within the bound has been removed.
void DeviationMeter::input_unproven(const surface::TriMesh& plain, const surface::TriangleTree& tree,
                                    const std::vector<std::uint32_t>& plain_of, const CarriedPoints& carried,
                                    std::vector<std::uint32_t>& beyond, const Progress& progress) {
  const auto triangles = static_cast<std::int64_t>(input_.triangles.size());
  std::vector<std::vector<std::uint32_t>> found((triangles + grain - 1) / grain);
  const auto search = [&](NearbyPlace& p) {
    p.distance = std::sqrt(tree.squared_distance(p.at, p.distance * p.distance, &p.triangle));
  };
  if (block_boxes_.empty()) {
    block_boxes_.resize((triangles + block - 1) / block);
    parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {  // whole blocks
      for (std::int64_t t = from; t < to; ++t)
        for (const std::uint32_t v : input_.triangles[t]) block_boxes_[t / block].add(input_.points_mm[v]);
    });
  }
  MarkedCells stale(input_, std::max(2 * bound_, 2 * edge_));
  for (const auto& t : gone_) stale.mark(t, bound_);
  gone_.clear();
  input_proven_.resize(input_.triangles.size(), 0);
  const auto block_proven = [&](std::int64_t t, const MarkedCells& cells) {
    const auto begin = input_proven_.begin() + t, end = begin + std::min(block, triangles - t);
    if (std::find(begin, end, 0) != end) return false;
    const surface::FloatBox& b = block_boxes_[t / block];
    const Vec3 low{b.min[0], b.min[1], b.min[2]}, high{b.max[0], b.max[1], b.max[2]};
    return !cells.any({low, high, low});
  };
  parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    std::vector<std::array<NearbyPlace, 3>> stack;
    for (std::int64_t t = from; t < to; ++t) {
      if (t % block == 0 && block_proven(t, stale)) {
        t += block - 1;
        continue;
      }
      const auto& v = input_.triangles[t];
      const std::array<Vec3, 3> place{input_.points_mm[v[0]], input_.points_mm[v[1]], input_.points_mm[v[2]]};
      if (input_proven_[t] && !stale.any(place)) continue;
      input_proven_[t] = 1;
      const std::uint32_t carrier[3] = {carried.carrier(v[0]), carried.carrier(v[1]), carried.carrier(v[2])};
      const float farthest2 =
          std::max({carried.squared_distance(v[0]), carried.squared_distance(v[1]), carried.squared_distance(v[2])});
      // The distance to one triangle is convex.
      if (farthest2 <= limit2_ && carrier[0] == carrier[1] && carrier[1] == carrier[2]) continue;
      std::array<NearbyPlace, 3> corner;
      for (int c = 0; c < 3; ++c) {
        corner[c].at = place[c];
        corner[c].distance = std::sqrt(carried.squared_distance(v[c]));
        corner[c].triangle = plain_of[carrier[c]];
        if (corner[c].distance > bound_) search(corner[c]);  // undoing let another triangle come nearer
      }
      if (proven_within(corner, bound_, plain, search, stack)) continue;
      input_proven_[t] = 0;
      found[from / grain].insert(found[from / grain].end(), carrier, carrier + 3);
    }
  });
  for (const auto& f : found) beyond.insert(beyond.end(), f.begin(), f.end());
}

void DeviationMeter::from_input(const surface::TriMesh& plain, const surface::TriangleTree& tree,
                                const std::vector<std::uint32_t>& plain_of, const CarriedPoints& carried,
                                std::vector<std::uint32_t>& beyond, const Progress& progress) {
  const auto triangles = static_cast<std::int64_t>(input_.triangles.size());
  std::vector<std::vector<std::uint32_t>> found((triangles + grain - 1) / grain);
  const bool first = forward_.empty();
  input_beyond_.resize(input_.triangles.size(), 0);
  // Between points that two triangles carry, a third triangle can be the nearest. What lies farther than all points is
  // looked up in the tree.
  double exact_beyond2 = 0;
  for (std::uint32_t p = 0; p < input_.points_mm.size() && exact_beyond2 < exact_beyond2_; ++p)
    exact_beyond2 = std::max<double>(exact_beyond2, carried.squared_distance(p));
  exact_beyond2 = std::min(exact_beyond2, exact_beyond2_);
  forward_.resize(found.size());
  const auto changed = [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = input_.triangles[t];
      if (input_beyond_[t] || carried.moved(v[0]) || carried.moved(v[1]) || carried.moved(v[2])) return true;
    }
    return false;
  };
  // The distance to one triangle is a convex function: between points of one carrier it is at most their mean.
  // A triangle samples its middle, the middles of the sides that it runs upwards, and the points that it is the first
  // to use; again only where what carries its points changed.
  parallel_for(0, triangles, grain, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    if (!first && !changed(from, to)) return;
    auto& distances = forward_[from / grain];
    std::size_t slot = 0;
    for (std::int64_t t = from; t < to; ++t) {
      const auto& v = input_.triangles[t];
      // A sample that was beyond the bound is measured again, because undoing may have brought a triangle near that
      // carries none of its points.
      const bool measure =
          first || input_beyond_[t] || carried.moved(v[0]) || carried.moved(v[1]) || carried.moved(v[2]);
      input_beyond_[t] = 0;
      Vec3 p[3];
      std::uint32_t carrier[3];
      double d[3];
      for (int c = 0; c < 3; ++c) {
        carrier[c] = carried.carrier(v[c]);
        if (!measure) continue;
        p[c] = input_.points_mm[v[c]];
        d[c] = std::sqrt(carried.squared_distance(v[c]));
      }
      const auto add = [&](Vec3 place, double bound) {
        if (bound * bound > exact_beyond2) bound = std::sqrt(tree.squared_distance(place, bound * bound));
        if (first) distances.push_back(0);
        distances[slot] = static_cast<float>(bound);
      };
      const auto next = [&] {
        if (double(distances[slot]) * distances[slot] > limit2_) {
          input_beyond_[t] = 1;
          found[from / grain].insert(found[from / grain].end(), carrier, carrier + 3);
        }
        ++slot;
      };
      const auto between = [&](Vec3 place, int a, int b, double bound = infinity) {
        if (bound * bound <= exact_beyond2 / 16) return bound;
        if (carrier[a] == carrier[b]) return std::sqrt(squared_to(plain, plain_of[carrier[a]], place));
        return std::sqrt(
            std::min(squared_to(plain, plain_of[carrier[a]], place), squared_to(plain, plain_of[carrier[b]], place)));
      };
      for (int c = 0; c < 3; ++c) {
        if (near_.incidence().triangle[near_.incidence().begin[v[c]]] == t) {
          if (measure) add(p[c], d[c]);
          next();
        }
        const int e = (c + 1) % 3;
        if (v[c] < v[e]) {
          const Vec3 middle = (p[c] + p[e]) / 2;
          if (measure) add(middle, between(middle, c, e, carrier[c] == carrier[e] ? (d[c] + d[e]) / 2 : infinity));
          next();
        }
      }
      if (measure) {
        const Vec3 middle = (p[0] + p[1] + p[2]) / 3;
        if (carrier[0] == carrier[1] && carrier[1] == carrier[2])
          add(middle, between(middle, 0, 1, (d[0] + d[1] + d[2]) / 3));
        else
          add(middle, std::min(between(middle, 0, 1), between(middle, 1, 2)));
      }
      next();
      // A triangle that is large compared with the bound gets a raster of samples, too.
      const Vec3 o = input_.points_mm[v[0]], ab = input_.points_mm[v[1]] - o, ac = input_.points_mm[v[2]] - o;
      const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(ac - ab, ac - ab)});
      if (longest <= raster_beyond2_) continue;
      const int n = static_cast<int>(std::min(std::ceil(2 * std::sqrt(longest / raster_beyond2_)), 16.0));
      for (int i = 0; i < n; ++i)
        for (int j = i == 0 ? 1 : 0; j < n - i; ++j) {
          const Vec3 place = o + ab * (double(i) / n) + ac * (double(j) / n);
          if (measure) add(place, std::min(between(place, 0, 1), between(place, 1, 2)));
          next();
        }
    }
  });
  for (const auto& f : found) beyond.insert(beyond.end(), f.begin(), f.end());
}

std::vector<std::uint32_t> DeviationMeter::measure(const surface::TriMesh& plain,
                                                   const std::vector<std::uint32_t>& triangle_of,
                                                   CarriedPoints& carried, const Progress& progress) {
  std::vector<std::uint32_t> beyond;
  const surface::TriangleTree tree(plain);
  std::vector<std::uint32_t> plain_of(input_.triangles.size());
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t) plain_of[triangle_of[t]] = t;
  from_input(plain, tree, plain_of, carried, beyond, progress);
  carried.forget_moves();
  progress.report(0.3);

  std::vector<std::uint32_t> to_do;  // triangles of `plain` that are new or changed
  std::vector<char> was_live(rasters_.size(), 0);
  for (const std::uint32_t r : live_) was_live[r] = 1;
  live_.clear();
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t) {
    std::uint32_t& raster = raster_of_[triangle_of[t]];
    if (raster == CollapseMesh::none) {
      raster = static_cast<std::uint32_t>(rasters_.size());
      rasters_.emplace_back();
    }
    const auto& v = plain.triangles[t];
    const std::array<Vec3, 3> corners{plain.points_mm[v[0]], plain.points_mm[v[1]], plain.points_mm[v[2]]};
    const bool known = raster < was_live.size() && was_live[raster];
    if (rasters_[raster].distances.empty() || rasters_[raster].corners != corners) {
      if (known) gone_.push_back(rasters_[raster].corners);
      rasters_[raster].corners = corners;
      to_do.push_back(t);
    }
    live_.push_back(raster);
    if (known) was_live[raster] = 0;
  }
  for (std::size_t r = 0; r < was_live.size(); ++r)
    if (was_live[r]) gone_.push_back(rasters_[r].corners);
  std::vector<char> lacks_tree(to_do.size(), 1);
  for (bool again = true; again;) {
    parallel_for(0, static_cast<std::int64_t>(to_do.size()), 256, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      Room room;
      for (std::int64_t n = from; n < to; ++n) {
        if (!lacks_tree[n]) continue;
        // Near it lie the points that it carries, and those of the input's triangle with the same number.
        const std::uint32_t t = triangle_of[to_do[n]];
        room.points.assign(input_.triangles[t].begin(), input_.triangles[t].end());
        for (std::uint32_t p = carried.first_of(t); p != CollapseMesh::none; p = carried.next_of(p))
          room.points.push_back(p);
        lacks_tree[n] = !from_triangle(rasters_[live_[to_do[n]]], room);
      }
    });
    again = !tree_ && std::find(lacks_tree.begin(), lacks_tree.end(), 1) != lacks_tree.end();
    if (again) tree_.emplace(input_);
  }
  for (std::uint32_t t = 0; t < triangle_of.size(); ++t)
    if (rasters_[live_[t]].beyond) beyond.push_back(triangle_of[t]);
  if (beyond.empty() && limit2_ < infinity) {
    for (std::uint32_t t = 0; t < triangle_of.size(); ++t)
      if (!rasters_[live_[t]].proven) beyond.push_back(triangle_of[t]);
    input_unproven(plain, tree, plain_of, carried, beyond, progress);
  }
  std::sort(beyond.begin(), beyond.end());
  beyond.erase(std::unique(beyond.begin(), beyond.end()), beyond.end());
  progress.report(1);
  return beyond;
}

DeviationFigures DeviationMeter::figures() const {
  DeviationFigures f;
  for (const auto& distances : forward_)
    for (const float d : distances) f.max_mm = std::max(f.max_mm, double(d));
  for (const std::uint32_t r : live_)
    for (const float d : rasters_[r].distances) f.max_mm = std::max(f.max_mm, double(d));
  Gathering forward(f.max_mm), backward(f.max_mm);
  parallel_do({[&] {
                 for (const auto& distances : forward_)
                   for (const float d : distances) forward.add(d, 1);
               },
               [&] {
                 for (const std::uint32_t r : live_) {
                   const auto& c = rasters_[r].corners;
                   const double area = norm(cross(c[1] - c[0], c[2] - c[0])) / 2;
                   for (const float d : rasters_[r].distances)
                     backward.add(d, area / static_cast<double>(rasters_[r].distances.size()));
                 }
               }});
  forward.into(f);
  backward.into(f);
  return f;
}

}  // namespace trephine::meshing
