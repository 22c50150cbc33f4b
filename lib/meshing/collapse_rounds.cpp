// SPDX-License-Identifier: GPL-3.0-or-later
// The order of the collapses.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "base/rank.h"
#include "meshing/edge_collapse.h"
#include "surface/bounds.h"

namespace trephine::meshing {
namespace {

/// A round works off at most this share of the edges, times the share of the triangles that is to go. Where the limit
/// is less than the input's mean side, the order matters more, and smaller rounds give fewer triangles; where there is
/// no limit, nothing but the order keeps thin walls apart.
constexpr double round_share = 0.6, careful_round_share = 1.0 / 3;
/// Points are carried from the moment when this many times the target of triangles is left.
constexpr double carry_from = 2.5;
/// The rounds end at this many times the target where there is a limit (each attempt takes long there), or at this
/// count.
constexpr double rounds_to = 1.1, limited_rounds_to = 1.03;
constexpr std::size_t rounds_to_count = 20000;
/// A round that takes less than this share of the triangles is the last one. The second share holds as long as there is
/// a limit but no points are carried yet.
constexpr double min_progress = 0.03, min_uncarried_progress = 0.1;
/// How many points a cell holds: enough for most of them to lie away from its walls. And how many cells there may be
/// along an axis.
constexpr double points_per_cell = 1500;
constexpr int max_cells = 64;
/// One point in so many is looked at to find the cost at which a round ends.
constexpr std::uint32_t sampling = 32;

constexpr float infinite_cost = std::numeric_limits<float>::infinity();

}  // namespace

/// The points that a cell's thread may collapse: those whose neighbours lie in the cell as well.
struct EdgeCollapse::Cells {
  std::vector<std::uint32_t> points;  ///< cell by cell, ascending within
  std::vector<std::uint32_t> begin;   ///< of each, and the end of the last
};

/// The cost that about this share of the edges lies below.
float EdgeCollapse::cost_below(double share) const {
  const std::size_t count = mesh_.points() / sampling + 1;
  std::vector<std::vector<float>> found((count + 1023) / 1024);
  parallel_for(0, static_cast<std::int64_t>(count), 1024, [&](std::int64_t from, std::int64_t to) {
    for (auto n = static_cast<std::size_t>(from); n < static_cast<std::size_t>(to); ++n) {
      // The sample is spread over the residues, so that a regular numbering of the points does not distort it.
      const std::size_t u = n * sampling + (n * 7) % sampling;
      if (u >= mesh_.points() || !mesh_.live_point(static_cast<std::uint32_t>(u))) continue;
      mesh_.for_each_leaving(static_cast<std::uint32_t>(u), [&](std::uint32_t e) {
        const std::uint32_t h = std::min(e, mesh_.twin(e));
        if (rejected_[h / 3] >> h % 3 & 1) return;
        Candidate c{costs_[h], h, 0};
        const bool known = c.cost >= 0 && !((flags_[u] | flags_[mesh_.to(e)]) & locked);
        if (known || candidate(h, c)) found[from / 1024].push_back(c.cost);
      });
    }
  });
  std::vector<float> costs;
  for (const auto& f : found) costs.insert(costs.end(), f.begin(), f.end());
  if (costs.empty()) return infinite_cost;
  return value_at_rank(costs, static_cast<std::size_t>(share * static_cast<double>(costs.size() - 1)));
}

EdgeCollapse::Cells EdgeCollapse::cut(std::size_t round) {
  live_points_.erase(std::remove_if(live_points_.begin(), live_points_.end(),
                                    [this](std::uint32_t v) { return !mesh_.live_point(v); }),
                     live_points_.end());
  const auto count = static_cast<std::int64_t>(live_points_.size());
  surface::Bounds box;
  for (const std::uint32_t v : live_points_) surface::include(box, mesh_.point_mm(v));
  const Vec3 low = box.min_mm, high = box.max_mm;
  const double per_point = 2 * area_ / static_cast<double>(mesh_.live_triangles());
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  const double side = std::max(std::sqrt(points_per_cell * per_point), extent / (max_cells - 1));
  std::array<int, 3> cells{};
  Vec3 shift;
  for (int a = 0; a < 3; ++a) {
    cells[a] = static_cast<int>((high[a] - low[a]) / side) + 2;
    shift[a] = std::fmod(0.5 * double(round) + 0.25 * double(round / 2) + 0.3 * a, 1.0);
  }
  std::vector<std::uint32_t> cell(mesh_.points(), CollapseMesh::none);
  parallel_for(0, count, 16384, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      const std::uint32_t v = live_points_[static_cast<std::size_t>(n)];
      const Vec3 p = (mesh_.point_mm(v) - low) / side + shift;
      cell[v] = static_cast<std::uint32_t>((int(p.z) * cells[1] + int(p.y)) * cells[0] + int(p.x));
    }
  });
  parallel_for(0, count, 16384, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      const std::uint32_t v = live_points_[static_cast<std::size_t>(n)];
      flags_[v] &= ~core;
      bool inner = true;
      mesh_.for_each_leaving(v, [&](std::uint32_t e) { inner &= cell[mesh_.to(e)] == cell[v]; });
      if (inner) flags_[v] |= core;
    }
  });
  Cells c;
  c.begin.assign(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2] + 1, 0);
  for (const std::uint32_t v : live_points_)
    if (flags_[v] & core) ++c.begin[cell[v] + 1];
  for (std::size_t n = 1; n < c.begin.size(); ++n) c.begin[n] += c.begin[n - 1];
  c.points.resize(c.begin.back());
  std::vector<std::uint32_t> at(c.begin.begin(), c.begin.end() - 1);
  for (const std::uint32_t v : live_points_)
    if (flags_[v] & core) c.points[at[cell[v]]++] = v;
  // Only the cells that hold something.
  c.begin.erase(std::unique(c.begin.begin(), c.begin.end()), c.begin.end());
  return c;
}

/// Adds the edges among these points.
void EdgeCollapse::gather(const std::uint32_t* from, const std::uint32_t* to, float cost_limit,
                          std::vector<Candidate>& edges) {
  for (; from != to; ++from) {
    const std::uint32_t u = *from;
    mesh_.for_each_leaving(u, [&](std::uint32_t e) {
      const std::uint32_t v = mesh_.to(e), h = std::min(e, mesh_.twin(e));
      if (u > v || !(flags_[v] & core) || (rejected_[h / 3] >> h % 3 & 1)) return;
      Candidate c;
      if (bounded_candidate(h, c) && c.cost <= cost_limit) edges.push_back(c);
    });
  }
}

/// Keeps the cost that was computed last. A quadric only grows, so this is a lower bound of the cost now.
bool EdgeCollapse::bounded_candidate(std::uint32_t half_edge, Candidate& c) {
  const float known = costs_[half_edge];
  if (std::isnan(known)) {
    if (!candidate(half_edge, c)) return false;
    costs_[half_edge] = c.cost;
    return true;
  }
  const std::uint32_t u = mesh_.from(half_edge), v = mesh_.to(half_edge);
  c = {std::abs(known), half_edge, versions_[u] + versions_[v] - std::signbit(known)};
  return !((flags_[u] | flags_[v]) & locked);
}

/// Collapses at most `count` edges, the cheapest first, including edges that arise on the way. An edge whose points
/// have changed keeps its place by its old cost, and its cost is computed again when its turn comes.
void EdgeCollapse::work_off(std::size_t count, float cost_limit, Worker& w, const std::function<void()>& tick) {
  const auto push = [&](const Candidate& c) {
    if (!(c.cost <= cost_limit)) return;
    w.heap.push_back(c);
    std::push_heap(w.heap.begin(), w.heap.end(), Later());
  };
  const auto next = [&w] {
    if (w.heap.empty() || (!w.sorted.empty() && Later()(w.heap.front(), w.sorted.back()))) {
      const Candidate c = w.sorted.back();
      w.sorted.pop_back();
      return c;
    }
    std::pop_heap(w.heap.begin(), w.heap.end(), Later());
    const Candidate c = w.heap.back();
    w.heap.pop_back();
    return c;
  };
  for (std::size_t steps = 0, done = 0; done < count && !(w.heap.empty() && w.sorted.empty()); ++steps) {
    if (steps % 4096 == 0) tick();
    Candidate c = next();
    const std::uint32_t h = c.half_edge;
    if (!mesh_.live_triangle(h / 3) || h > mesh_.twin(h) || (rejected_[h / 3] >> h % 3 & 1)) continue;
    const std::uint32_t u = mesh_.from(h);
    if (versions_[u] + versions_[mesh_.to(h)] != c.version) {
      if (!std::signbit(costs_[h]) || !candidate(h, c)) continue;  // it was looked at since
      costs_[h] = c.cost;
      push(c);
      continue;
    }
    const std::uint32_t g = mesh_.twin(h);
    const auto known = [this](std::uint32_t e) { return costs_[std::min(e, mesh_.twin(e))]; };
    // Two sides become one. The cost of either is a lower bound of the new cost.
    const std::array<float, 4> sides{known(CollapseMesh::next(h)), known(CollapseMesh::previous(h)),
                                     known(CollapseMesh::next(g)), known(CollapseMesh::previous(g))};
    const Outcome outcome = attempt(h, w);
    w.limited |= outcome == Outcome::limit;
    if (outcome != Outcome::done) {
      rejected_[h / 3] |= static_cast<char>(1 << h % 3);
      continue;
    }
    ++done;
    const auto larger = [](float a, float b) {
      return std::isnan(a) || std::isnan(b) ? a + b : -std::max(std::abs(a), std::abs(b));
    };
    const std::uint32_t first = mesh_.twin(CollapseMesh::previous(h)), second = mesh_.twin(CollapseMesh::previous(g));
    costs_[std::min(first, mesh_.twin(first))] = larger(sides[0], sides[1]);
    costs_[std::min(second, mesh_.twin(second))] = larger(sides[2], sides[3]);
    // An edge that was rejected before may be collapsed now.
    mesh_.for_each_leaving(u, [&](std::uint32_t e) {
      const std::uint32_t k = std::min(e, mesh_.twin(e));
      costs_[k] = -std::abs(costs_[k]);
      const bool anew = (rejected_[k / 3] >> k % 3 & 1) || e == first || e == second || std::isnan(costs_[k]);
      Candidate more;
      if (anew && (flags_[mesh_.to(e)] & core) && bounded_candidate(k, more)) push(more);
    });
    mesh_.for_each_leaving(u, [&](std::uint32_t e) { rejected_[e / 3] = 0; });
  }
}

void EdgeCollapse::rounds(std::size_t target, std::size_t floor, bool& limited, const Progress& progress) {
  live_points_.resize(mesh_.points());
  std::iota(live_points_.begin(), live_points_.end(), 0u);
  const std::size_t start = mesh_.live_triangles();
  const bool wide = limit2_ < infinite_cost && limit2_ >= side_ * side_;
  const double share = wide ? round_share : careful_round_share;
  for (;;) {
    const std::size_t live = mesh_.live_triangles();
    progress.report(double(start - live) / double(std::max<std::size_t>(1, start - std::min(start, target))));
    if (live <= std::max(floor, rounds_to_count)) return;
    const double excess = double(live - target) / double(live);
    const float cost_limit = cost_below(share * excess);
    const Cells cells = cut(round_++);
    const std::size_t count = cells.begin.size() - 1;
    std::vector<Worker> workers(count);
    for (std::size_t n = 0; n < count; ++n) workers[n].log = mesh_.open_log(cells.begin[n + 1] - cells.begin[n]);
    parallel_for(0, static_cast<std::int64_t>(count), 1, [&](std::int64_t from, std::int64_t to) {
      progress.check();
      for (std::int64_t n = from; n < to; ++n) {
        Worker w;
        std::swap(w.log, workers[n].log);
        gather(cells.points.data() + cells.begin[n], cells.points.data() + cells.begin[n + 1], cost_limit, w.sorted);
        std::sort(w.sorted.begin(), w.sorted.end(), Later());
        // Each cell has its share, so that all cells together cannot go below the target.
        const std::size_t most = (live - target) / 2 * (cells.begin[n + 1] - cells.begin[n]) / cells.points.size();
        work_off(most, cost_limit, w, [] {});
        w.log.records.shrink_to_fit();
        w.log.journal.shrink_to_fit();
        workers[n].log = std::move(w.log);
        workers[n].limited = w.limited;
      }
    });
    for (Worker& w : workers) {
      mesh_.keep(std::move(w.log));
      limited |= w.limited;
    }
    const double least = limit2_ < infinite_cost && !carried_.carries() ? min_uncarried_progress : min_progress;
    if (double(live - mesh_.live_triangles()) < least * double(live)) return;
  }
}

void EdgeCollapse::finish(std::size_t target, bool& limited, const Progress& progress) {
  const std::size_t live = mesh_.live_triangles();
  if (live <= target) return;
  std::vector<std::uint32_t> points;
  for (std::uint32_t v = 0; v < mesh_.points(); ++v) {
    if (!mesh_.live_point(v)) continue;
    points.push_back(v);
    flags_[v] |= core;
  }
  Worker w;
  w.log = mesh_.open_log(points.size());
  constexpr std::int64_t piece = 2048;
  const auto count = static_cast<std::int64_t>(points.size());
  std::vector<std::vector<Candidate>> edges((count + piece - 1) / piece);
  parallel_for(0, count, piece, [&](std::int64_t from, std::int64_t to) {
    gather(points.data() + from, points.data() + to, infinite_cost, edges[from / piece]);
  });
  // Only a few of these edges will be collapsed.
  for (const auto& e : edges) w.heap.insert(w.heap.end(), e.begin(), e.end());
  std::make_heap(w.heap.begin(), w.heap.end(), Later());
  const auto gone = [&] { return double(2 * w.log.records.size()) / double(live - target); };
  work_off((live - target + 1) / 2, infinite_cost, w, [&] { progress.report(gone()); });
  limited |= w.limited;
  mesh_.keep(std::move(w.log));
}

void EdgeCollapse::take_up() {
  parallel_do({[&] { carried_.take_up(mesh_); }, [&] { input_.emplace(plain_input_); }});
}

bool EdgeCollapse::run(std::size_t target, const Progress& progress) {
  bool limited = false;
  const bool bounded = limit2_ < std::numeric_limits<double>::infinity();
  const auto floor_of = [&](double times) { return static_cast<std::size_t>(times * double(target)); };
  if (!carried_.carries()) {
    rounds(target, floor_of(bounded ? carry_from : rounds_to), limited, progress.part(0, 0.5));
    if (bounded) {
      limited = false;
      std::fill(rejected_.begin(), rejected_.end(), 0);
      take_up();
      undo_beyond();
      rounds(target, floor_of(limited_rounds_to), limited, progress.part(0.5, 0.9));
    }
  } else if (bounded && mesh_.live_triangles() > floor_of(limited_rounds_to)) {  // some were undone
    rounds(target, floor_of(limited_rounds_to), limited, progress.part(0, 0.9));
  }
  finish(target, limited, progress.part(0.9, 1));
  if (!carried_.carries()) take_up();
  progress.report(1);
  return limited;
}

}  // namespace trephine::meshing
