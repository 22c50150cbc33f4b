// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/horns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <queue>

#include "base/pi.h"
#include "head/soft_tissue.h"
#include "mask/coarse.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double raster_mm = 1.2;      ///< paths are searched on voxels merged up to this
constexpr double fine_sigma_mm = 1.5;  ///< sigma of the mean that a path follows
constexpr double wide_sigma_mm = 2.5;  ///< sigma of the mean by which its radius is measured
constexpr double beside_sigma_mm = 6;  ///< sigma of the mean of the tissue around it
constexpr double min_contrast_hu = 8;
constexpr double depth_mm = 10;  ///< least depth under the brain's surface
constexpr double clear_mm = 3;   ///< least distance to other CSF
constexpr double start_mm = 2;   ///< this near to the ventricles everything is dark by blur

// The evidence for a horn: the share of CSF in the fine mean above the least share, summed along the path, in mm.
constexpr double min_share = 0.2;
constexpr double min_share_sigma = 2.2;  ///< and this many standard deviations of its noise
constexpr double drop_mm = 1.5;          ///< a path ends where its sum has fallen by this
constexpr double min_score_mm = 2;
constexpr double min_reach_mm = 7;  ///< both from the ventricles and along the path
constexpr double max_path_mm = 52;
constexpr double cost_rate = 4;  ///< a mm of path costs exp(-rate share)
constexpr double apart_mm = 4;   ///< between two paths
constexpr int max_paths = 8;

// The same with the wide mean, by which the path was not chosen.
constexpr double wide_least = 0.1;  ///< a tube of 1.25 mm radius
constexpr double wide_least_sigma = 2;
constexpr double wide_drop_mm = 0.4, wide_score_mm = 0.5;
constexpr double share_along_mm = 3, place_along_mm = 2;  ///< sigma of the means along a path
constexpr double min_radius_mm = 1, max_radius_mm = 4;
constexpr double far_mm = 4;
constexpr double min_spreads = 3;  ///< a horn is darker than this many standard deviations of lines beside it

constexpr double horn_reach_mm = 9;  ///< a head's horns lie this near to the template's

/// Where the horns of an adult lie relative to the brain's centre, LPS (x on either side); heads are tilted by at most
/// about 15 degrees.
struct Place {
  Vec3 from, to;
  bool holds(Vec3 p) const {
    const double x = std::abs(p.x);
    return x >= from.x && p.y >= from.y && p.z >= from.z && x <= to.x && p.y <= to.y && p.z <= to.z;
  }
};
constexpr Place temporal{{18, -25, -36}, {45, 35, 5}}, occipital{{10, 15, -18}, {40, 70, 15}};

/// The cells of the voxels of one lattice on which paths are searched. Voxels that fill no cell are left out.
struct Cells {
  grid::Box whole;
  mask::CoarseRaster raster;
  explicit Cells(const grid::Lattice& l) {
    std::array<int, 3> factor;
    for (int a = 0; a < 3; ++a) {
      factor[a] = std::max(1, std::min(l.size[a], int(raster_mm / l.spacing_mm[a])));
      whole.end[a] = l.size[a] - l.size[a] % factor[a];
    }
    raster = mask::coarse_raster(grid::cropped(l, whole), factor);
  }
  /// Set where at least half of the voxels are set.
  mask::BitMask of(const mask::BitMask& m) const { return mask::coarse_mask(mask::crop(m, whole), raster, 0.5); }
  grid::Grid<float> of(const grid::Grid<float>& hu, const mask::BitMask& known) const {
    return mask::coarse_mean(mask::HuView(hu), mask::crop(known, whole), raster, 0);
  }
};

/// The tree of cheapest paths from the ventricles.
struct Tree {
  std::vector<std::int32_t> order,
      parent;               ///< voxels, nearest first; the voxel from which each was reached, -1 at the root
  std::vector<float> step;  ///< mm from the parent
};

Tree grow_tree(const grid::Grid<float>& share, const mask::BitMask& allowed, const mask::BitMask& start, double least,
               const Progress& progress) {
  const grid::Lattice& l = share;
  Tree t;
  t.parent.assign(l.count(), -1);
  t.step.assign(l.count(), 0.f);
  std::vector<float> cost(l.count(), 1e30f), score(l.count(), 0.f), best(l.count(), 0.f), length(l.count(), 0.f);
  std::vector<char> done(l.count(), 0);
  using Entry = std::pair<float, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (start.get(i, j, k)) {
          cost[l.index(i, j, k)] = 0;
          queue.push({0.f, std::int32_t(l.index(i, j, k))});
        }
  while (!queue.empty()) {
    const std::int32_t v = queue.top().second;
    queue.pop();
    if (done[std::size_t(v)]) continue;
    done[std::size_t(v)] = 1;
    t.order.push_back(v);
    if (t.order.size() % 65536 == 0) progress.check();
    if (best[std::size_t(v)] - score[std::size_t(v)] > drop_mm || length[std::size_t(v)] > max_path_mm) continue;
    const int i = v % l.size[0], j = v / l.size[0] % l.size[1], k = v / l.size[0] / l.size[1];
    for (int c = -1; c <= 1; ++c)
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) {
          if (!l.contains(i + a, j + b, k + c) || !allowed.get(i + a, j + b, k + c)) continue;
          const std::size_t w = l.index(i + a, j + b, k + c);
          if (done[w]) continue;
          const float mm = float(norm(Vec3{a * l.spacing_mm.x, b * l.spacing_mm.y, c * l.spacing_mm.z}));
          const float next = cost[std::size_t(v)] + mm * std::exp(-float(cost_rate) * share.voxels[w]);
          if (next >= cost[w]) continue;
          cost[w] = next;
          t.parent[w] = v;
          t.step[w] = mm;
          length[w] = length[std::size_t(v)] + mm;
          score[w] = score[std::size_t(v)] + mm * (std::min(share.voxels[w], 1.f) - float(least));
          best[w] = std::max(best[std::size_t(v)], score[w]);
          queue.push({next, std::int32_t(w)});
        }
  }
  return t;
}

/// The radius of a tube for which the two means differ by this share.
double radius_of(double share) {
  double from = 0, to = max_radius_mm;
  for (int n = 0; n < 30; ++n) {
    const double r = 0.5 * (from + to);
    const double s = std::exp(-r * r / (2 * beside_sigma_mm * beside_sigma_mm)) -
                     std::exp(-r * r / (2 * wide_sigma_mm * wide_sigma_mm));
    (s < share ? from : to) = r;
  }
  return 0.5 * (from + to);
}

struct Node {
  Vec3 at;
  double along_mm, wide_share, radius_mm;
};
using Path = std::vector<Node>;  ///< from its tip to its root

/// The best paths in the tree, the best first; none lies beside another or in `taken`.
std::vector<Path> best_paths(const Tree& tree, const grid::Grid<float>& share, const grid::Grid<float>& wide_share,
                             mask::BitMask taken, const grid::Grid<float>& off, double least,
                             const Progress& progress) {
  const grid::Lattice& l = share;
  const auto index_of = [&](std::int32_t v) {
    return std::array<int, 3>{v % l.size[0], v / l.size[0] % l.size[1], v / l.size[0] / l.size[1]};
  };
  std::vector<float> score(l.count(), 0.f);
  std::vector<Path> paths;
  while (int(paths.size()) < max_paths) {
    std::int32_t tip = -1;
    float most = float(min_score_mm);
    for (const std::int32_t v : tree.order) {
      const std::size_t u = std::size_t(v);
      const auto [i, j, k] = index_of(v);
      if (tree.parent[u] < 0 || taken.get(i, j, k)) {
        score[u] = 0;
        continue;
      }
      score[u] = score[std::size_t(tree.parent[u])] + tree.step[u] * (share.voxels[u] - float(least));
      if (score[u] > most && off.voxels[u] >= min_reach_mm) {
        most = score[u];
        tip = v;
      }
    }
    if (tip < 0) break;
    Path path;
    mask::BitMask trace(l);
    for (std::int32_t v = tip; v >= 0; v = tree.parent[std::size_t(v)]) {
      const auto [i, j, k] = index_of(v);
      const Vec3 at = l.to_world_mm({double(i), double(j), double(k)});
      const double along = path.empty() ? 0 : path.back().along_mm + norm(at - path.back().at);
      path.push_back({at, along, wide_share.voxels[std::size_t(v)], 0});
      trace.set(i, j, k);
      if (taken.get(i, j, k)) break;
    }
    taken |= mask::dilated(trace, apart_mm, progress);
    paths.push_back(std::move(path));
  }
  return paths;
}

/// The tube along the path, from its root as far as the wide mean confirms it; empty where it does not. Positions and
/// shares become means along the path.
Path tube_along(const Path& path, double wide_floor) {
  Path tube = path;
  for (Node& n : tube) {
    Vec3 at;
    double share = 0, share_weights = 0, at_weights = 0;
    for (const Node& m : path) {
      const double d = m.along_mm - n.along_mm;
      const double w = std::exp(-d * d / (2 * share_along_mm * share_along_mm)),
                   u = std::exp(-d * d / (2 * place_along_mm * place_along_mm));
      share += w * m.wide_share;
      share_weights += w;
      at += u * m.at;
      at_weights += u;
    }
    n.at = at / at_weights;
    n.wide_share = share / share_weights;
    n.radius_mm = std::clamp(radius_of(n.wide_share), min_radius_mm, max_radius_mm);
  }
  std::size_t end = tube.size() - 1;
  double sum = 0, most = 0;
  for (std::size_t n = tube.size() - 1; n-- > 0;) {
    sum += (tube[n + 1].along_mm - tube[n].along_mm) * (tube[n].wide_share - wide_floor);
    if (sum > most) {
      most = sum;
      end = n;
    }
    if (sum < most - wide_drop_mm) break;
  }
  if (most < wide_score_mm || tube.back().along_mm - tube[end].along_mm < min_reach_mm) return {};
  tube.erase(tube.begin(), tube.begin() + std::ptrdiff_t(end));
  return tube;
}

/// Whether the tube is darker than what lies beside it is uneven: streaks are dark and bright lines side by side, of
/// which any one looks like a horn. `share` is the share of CSF at each voxel, `tissue` where it means something.
bool stands_out(const Path& tube, const grid::Grid<float>& share, const mask::BitMask& tissue) {
  constexpr int ways = 8;
  constexpr double beside_mm[] = {6, 8.5}, min_seen = 0.5;
  const Vec3 along = normalized(tube.back().at - tube.front().at);
  const Vec3 aside = normalized(cross(along, std::abs(along.z) < 0.8 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
  const Vec3 other = cross(along, aside);
  const auto mean_at = [&](Vec3 off, bool anywhere) -> std::optional<double> {
    double sum = 0;
    std::size_t seen = 0;
    for (const Node& n : tube) {
      const Vec3 i = share.to_index(n.at + off);
      const int a = int(std::lround(i.x)), b = int(std::lround(i.y)), c = int(std::lround(i.z));
      if (!share.contains(a, b, c) || !(anywhere || tissue.get(a, b, c))) continue;
      sum += share.at(a, b, c);
      ++seen;
    }
    if (double(seen) < min_seen * double(tube.size())) return {};
    return sum / double(seen);
  };
  std::vector<float> beside;
  for (const double mm : beside_mm)
    for (int w = 0; w < ways; ++w) {
      const double turn = 2 * pi * w / ways;
      if (const auto m = mean_at(aside * (mm * std::cos(turn)) + other * (mm * std::sin(turn)), false))
        beside.push_back(float(*m));
    }
  if (beside.size() < ways) return true;
  const float middle = mask::median(beside, 0.f);
  for (float& m : beside) m = std::abs(m - middle);
  const double spread = 1.4826 * mask::median(beside, 0.f), mine = *mean_at({}, true) - middle;
  return mine >= min_spreads * spread;
}

/// The union with the signed distance to the tube.
void draw(const Path& tube, grid::Grid<float>& out) {
  const Vec3 s = out.spacing_mm;
  const double reach = max_radius_mm + far_mm;
  for (std::size_t n = 0; n + 1 < tube.size(); ++n) {
    const Node &a = tube[n], &b = tube[n + 1];
    const Vec3 p = out.to_index(a.at), ab = b.at - a.at;
    const auto from = [&](double at, double spacing) { return std::max(0, int(at - reach / spacing)); };
    const auto to = [&](double at, double spacing, int size) { return std::min(size, int(at + reach / spacing) + 2); };
    for (int k = from(p.z, s.z); k < to(p.z, s.z, out.size[2]); ++k)
      for (int j = from(p.y, s.y); j < to(p.y, s.y, out.size[1]); ++j)
        for (int i = from(p.x, s.x); i < to(p.x, s.x, out.size[0]); ++i) {
          const Vec3 x = out.to_world_mm({double(i), double(j), double(k)});
          const double t = std::clamp(dot(x - a.at, ab) / std::max(dot(ab, ab), 1e-9), 0.0, 1.0);
          const double d = a.radius_mm + t * (b.radius_mm - a.radius_mm) - norm(x - (a.at + t * ab));
          float& f = out.at(i, j, k);
          f = std::max(f, float(d));
        }
  }
}

}  // namespace

grid::Grid<float> find_horns(const grid::Grid<float>& hu, const mask::BitMask& known, const mask::BitMask& envelope,
                             const mask::BitMask& others, const mask::BitMask& shape, Vec3 centre_mm,
                             const place::HeadPlace& place, double noise, int& count, const Progress& progress) {
  grid::Grid<float> out(hu, float(-far_mm));
  count = 0;
  const Cells cells(hu);
  const grid::Lattice& l = cells.raster.cells;
  const mask::BitMask core = cells.of(shape), sound = cells.of(known);
  mask::BitMask free = mask::eroded(cells.of(envelope), depth_mm, progress);
  free.remove(mask::dilated(cells.of(others), clear_mm, progress));
  const grid::Grid<float> values = cells.of(hu, known);
  std::vector<float> inside;
  const mask::BitMask inner = mask::eroded(core, 1.0, progress);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (inner.get(i, j, k)) inside.push_back(values.at(i, j, k));
  if (inside.size() < 50) return out;
  const float low = mask::median(inside, 0.f);
  mask::BitMask start = mask::dilated(core, start_mm, progress), tissue = sound;
  tissue &= free;
  tissue.remove(start);
  mask::BitMask way = free;
  way &= mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      const Vec3 at = l.to_world_mm({double(i), double(j), double(k)}), p = at - centre_mm;
      row[i] = free.get(i, j, k) && (place.sure ? place::horns_mm(place.to_template(at)) <= horn_reach_mm
                                                : temporal.holds(p) || occipital.holds(p));
    }
  });
  const grid::Grid<float> fine = mask::masked_gaussian(values, sound, fine_sigma_mm, 1000, 0.02, progress),
                          wide = mask::masked_gaussian(values, tissue, wide_sigma_mm, 1000, 0.02, progress),
                          beside = mask::masked_gaussian(values, tissue, beside_sigma_mm, -1000, 0.02, progress);
  grid::Grid<float> share(l), wide_share(l);
  for (std::size_t v = 0; v < l.count(); ++v) {
    const float contrast = std::max(beside.voxels[v] - low, float(min_contrast_hu));
    share.voxels[v] = std::clamp((beside.voxels[v] - fine.voxels[v]) / contrast, -0.5f, 1.f);
    wide_share.voxels[v] = std::clamp((beside.voxels[v] - wide.voxels[v]) / contrast, -0.5f, 1.f);
  }
  // The noise of a Gaussian mean, as a share.
  const auto noise_of = [&](double sigma_mm) {
    return noise * std::pow(4 * pi * sigma_mm * sigma_mm, -0.75) / std::max(tissue_level_hu - low, min_contrast_hu);
  };
  const double least = std::max(min_share, min_share_sigma * noise_of(fine_sigma_mm));
  const double wide_floor = std::max(wide_least, wide_least_sigma * noise_of(wide_sigma_mm));
  start &= free;
  start |= core;
  const Tree tree = grow_tree(share, way, start, least, progress);
  for (const Path& path :
       best_paths(tree, share, wide_share, start, mask::distance_mm(core, progress), least, progress)) {
    const Path tube = tube_along(path, wide_floor);
    if (tube.empty() || !stands_out(tube, share, tissue)) continue;
    draw(tube, out);
    ++count;
  }
  return out;
}

}  // namespace trephine::head
