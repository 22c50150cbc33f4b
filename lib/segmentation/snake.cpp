// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "segmentation/bubbles.h"
#include "segmentation/snake_band.h"

namespace trephine::segmentation {
namespace {

constexpr float largest_speed = 1.0001f;  // allows for rounding in other programs
constexpr double max_held_back = 0.05;    // a shape in noise has about 0.01

/// Throws Error 65 at the first voxel (in memory's order) for which bad() holds.
template <class Bad>
void check_voxels(const grid::Field& field, const char* name, Bad&& bad, const char* must) {
  std::vector<std::int64_t> first(std::size_t(field.size[2]), -1);
  const std::int64_t slice = std::int64_t(field.size[0]) * field.size[1];
  parallel_for(0, field.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t k = from; k < to; ++k)
      for (std::int64_t v = k * slice; v < (k + 1) * slice && first[k] < 0; ++v)
        if (bad(field.voxels[v])) first[k] = v;
  });
  for (const std::int64_t v : first)
    if (v >= 0)
      throw Error(ExitCode::bad_input, "", name,
                  fmt::format("voxel ({}, {}, {}) is {}, {}", v % field.size[0], v / field.size[0] % field.size[1],
                              v / slice, field.voxels[v], must));
}

void check_finite(const grid::Field& field, const char* name) {
  check_voxels(
      field, name, [](float f) { return !std::isfinite(f); }, "must be finite");
}

void check_speed(const grid::Field& speed) {
  check_voxels(
      speed, "speed", [](float f) { return !(std::abs(f) <= largest_speed); },
      "must be within -1 and 1: a speed image, as presegment makes it");
}

struct Inside {
  grid::Box box;  ///< of the voxels above 0
  std::size_t voxels = 0, edge = 0;
  std::size_t held_back = 0;  ///< voxels at which the speed is negative
  double mean_speed = 0;
};

/// The voxels of `field` above 0; with their mean speed where one is given.
Inside inside_of(const grid::Field& field, const grid::Field* speed) {
  struct Slice {
    int low[2] = {1 << 30, 1 << 30}, high[2] = {-1, -1};
    std::size_t voxels = 0, edge = 0, held_back = 0;
    double speed = 0;
  };
  const auto& n = field.size;
  std::vector<Slice> slices(n[2]);
  parallel_for(0, n[2], 2, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k) {
      Slice& s = slices[k];
      for (int j = 0; j < n[1]; ++j) {
        const std::size_t row = field.index(0, j, k);
        for (int i = 0; i < n[0]; ++i) {
          if (!(field.voxels[row + i] > 0)) continue;
          s.low[0] = std::min(s.low[0], i);
          s.high[0] = std::max(s.high[0], i);
          s.low[1] = std::min(s.low[1], j);
          s.high[1] = std::max(s.high[1], j);
          ++s.voxels;
          s.edge += i == 0 || j == 0 || k == 0 || i == n[0] - 1 || j == n[1] - 1 || k == n[2] - 1;
          if (!speed) continue;
          s.speed += speed->voxels[row + i];
          s.held_back += speed->voxels[row + i] < 0;
        }
      }
    }
  });
  Inside all;
  double sum = 0;
  for (int k = 0; k < n[2]; ++k) {
    const Slice& s = slices[k];
    if (s.voxels == 0) continue;
    if (all.voxels == 0) all.box = {{s.low[0], s.low[1], k}, {0, 0, 0}};
    for (int a = 0; a < 2; ++a) {
      all.box.begin[a] = std::min(all.box.begin[a], s.low[a]);
      all.box.end[a] = std::max(all.box.end[a], s.high[a] + 1);
    }
    all.box.end[2] = k + 1;
    all.voxels += s.voxels;
    all.edge += s.edge;
    all.held_back += s.held_back;
    sum += s.speed;
  }
  if (all.voxels > 0) all.mean_speed = sum / double(all.voxels);
  return all;
}

grid::Box joined(const grid::Box& a, const grid::Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  grid::Box c = a;
  for (int i = 0; i < 3; ++i) {
    c.begin[i] = std::min(a.begin[i], b.begin[i]);
    c.end[i] = std::max(a.end[i], b.end[i]);
  }
  return c;
}

/// The lattice of half as many voxels along the axes that are not much coarser than the finest.
grid::Lattice halved(const grid::Lattice& l) {
  grid::Lattice c = l;
  const double finest = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  Vec3 shift;
  for (int a = 0; a < 3; ++a) {
    if (l.spacing_mm[a] > 1.5 * finest || l.size[a] < 8) continue;
    c.size[a] = (l.size[a] + 1) / 2;
    c.spacing_mm[a] = 2 * l.spacing_mm[a];
    shift[a] = 0.5;
  }
  c.origin_mm = l.to_world_mm(shift);
  return c;
}

/// The mean of the fine voxels of each coarse one.
grid::Grid<float> pooled(const grid::Grid<float>& fine, const grid::Lattice& coarse) {
  grid::Grid<float> out(coarse);
  int factor[3];
  for (int a = 0; a < 3; ++a) factor[a] = coarse.size[a] == fine.size[a] ? 1 : 2;
  parallel_for(0, coarse.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < coarse.size[1]; ++j)
        for (int i = 0; i < coarse.size[0]; ++i) {
          float sum = 0;
          int n = 0;
          for (int c = k * factor[2]; c < std::min((k + 1) * factor[2], fine.size[2]); ++c)
            for (int b = j * factor[1]; b < std::min((j + 1) * factor[1], fine.size[1]); ++b)
              for (int a = i * factor[0]; a < std::min((i + 1) * factor[0], fine.size[0]); ++a, ++n)
                sum += fine.at(a, b, c);
          out.at(i, j, k) = sum / float(n);
        }
  });
  return out;
}

/// Trilinear; outside, the values of the edge continue.
grid::Grid<float> refined(const grid::Grid<float>& coarse, const grid::Lattice& fine) {
  grid::Grid<float> out(fine);
  struct Tap {
    int low, high;
    float t;
  };
  std::vector<Tap> taps[3];
  for (int a = 0; a < 3; ++a)
    for (int i = 0; i < fine.size[a]; ++i) {
      const bool same = coarse.size[a] == fine.size[a];
      const double x = std::clamp(same ? double(i) : (i - 0.5) / 2, 0.0, double(coarse.size[a] - 1));
      const int low = std::min(int(x), coarse.size[a] - 1);
      taps[a].push_back({low, std::min(low + 1, coarse.size[a] - 1), float(x - low)});
    }
  parallel_for(0, fine.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    std::vector<float> row(std::size_t(coarse.size[0]));
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < fine.size[1]; ++j) {
        const Tap y = taps[1][j], z = taps[2][k];
        const float *a = &coarse.at(0, y.low, z.low), *b = &coarse.at(0, y.high, z.low),
                    *c = &coarse.at(0, y.low, z.high), *d = &coarse.at(0, y.high, z.high);
        for (int i = 0; i < coarse.size[0]; ++i) {
          const float near = a[i] + y.t * (b[i] - a[i]), far = c[i] + y.t * (d[i] - c[i]);
          row[i] = near + z.t * (far - near);
        }
        float* o = &out.at(0, j, k);
        for (int i = 0; i < fine.size[0]; ++i) {
          const Tap x = taps[0][i];
          o[i] = row[x.low] + x.t * (row[x.high] - row[x.low]);
        }
      }
  });
  return out;
}

BandParams band_params(const SnakeParams& p, int max_iterations, const grid::Lattice& lattice) {
  BandParams b;
  b.propagation = p.propagation;
  b.curvature = p.curvature;
  b.advection = p.method == SnakeMethod::geodesic ? p.advection : 0;
  b.max_iterations_count = max_iterations;
  b.min_change_mm = p.min_change_mm;
  if (p.max_volume_ml < 100000) b.max_voxels = std::size_t(p.max_volume_ml * 1000 / lattice.voxel_volume_mm3());
  return b;
}

[[noreturn]] void refuse_end(const BandRun& run, const SnakeParams& p) {
  const std::string after = fmt::format("after {} iterations", run.iterations);
  if (run.end == BandEnd::vanished)
    throw refusal(
        "start", "the surface vanished " + after + ", must begin where the speed is positive and outlast the curvature",
        {"begin larger or elsewhere with `start` or `bubbles`, or lower `curvature`"});
  if (run.end == BandEnd::filled)
    throw refusal("speed", "the surface filled the whole speed image " + after + ", the speed holds it nowhere",
                  {"narrow what `presegment` finds, or give `within`"});
  throw refusal("max_volume_ml",
                fmt::format("the surface leaked: more than {} ml {}", trephine::to_text(p.max_volume_ml), after),
                {"narrow what `presegment` finds, give `within`, or raise `max_volume_ml`"});
}

bool ended_well(BandEnd end) { return end == BandEnd::converged || end == BandEnd::iterations; }

/// A geodesic surface begins outside of the walls, also of thin ones: within them nothing in the image would move it
/// out.
void leave_walls(const grid::Grid<float>& speed, grid::Grid<float>& phi, const SnakeParams& p) {
  if (p.method != SnakeMethod::geodesic) return;
  const float outside = -0.5f * float(std::min({phi.spacing_mm.x, phi.spacing_mm.y, phi.spacing_mm.z}));
  for (std::size_t v = 0; v < phi.count(); ++v)
    if (speed.voxels[v] <= -1) phi.voxels[v] = std::min(phi.voxels[v], outside);
}

/// Runs the finest level, after `levels` coarser ones, which take at most half of `max_iterations`. `phi` is the start
/// and then the result; `iterations` counts all levels.
BandRun evolve_levels(const grid::Grid<float>& speed, grid::Grid<float>& phi, const SnakeParams& p, int levels,
                      int max_iterations, int& iterations, const Progress& progress) {
  const grid::Lattice coarse = halved(phi);
  const int before = iterations;
  if (levels > 0 && coarse.size != phi.size && max_iterations > 1) {
    // In mm about the surface, so that the mean of voxels is one's own.
    BandParams none;
    none.max_iterations_count = 0;
    evolve_band(speed, phi, none, progress.part(0, 0));
    grid::Grid<float> rough = pooled(phi, coarse);
    if (inside_of(rough, nullptr).voxels > 0) {
      const BandRun run = evolve_levels(pooled(speed, coarse), rough, p, levels - 1, max_iterations / 2, iterations,
                                        progress.part(0, 0.3));
      if (run.end == BandEnd::too_large) refuse_end(run, p);
      if (ended_well(run.end)) phi = refined(rough, phi);
      leave_walls(speed, phi, p);
    }
  }
  const BandRun run = evolve_band(speed, phi, band_params(p, max_iterations - (iterations - before), phi),
                                  progress.part(levels > 0 ? 0.3 : 0, 1));
  iterations += run.iterations;
  return run;
}

}  // namespace

Outcome<grid::Field, EvolvedResult> evolve_snake(const grid::Field& speed, const grid::Field& start,
                                                 const SnakeParams& params, const Progress& progress) {
  const bool geodesic = params.method == SnakeMethod::geodesic;
  if (params.propagation == 0 && params.curvature == 0 && (!geodesic || params.advection == 0))
    throw Error(ExitCode::usage, "", "propagation, curvature, advection", "all 0, nothing would move the surface");
  check_speed(speed);
  check_finite(start, "start");
  grid::Grid<float> phi =
      with_field("start", [&] { return grid::fit(start, static_cast<const grid::Lattice&>(speed), -1.f); });
  leave_walls(speed, phi, params);
  const Inside begun = inside_of(phi, nullptr);
  if (begun.voxels == 0)
    throw refusal("start", "0 voxels of the speed image lie inside, nothing to begin with",
                  {"begin elsewhere with `start` or `bubbles`"});

  // The surface does not leave the start but where the speed lets it.
  const grid::Box box = grid::grown(
      params.propagation < 0 ? grid::whole_box(speed) : joined(begun.box, inside_of(speed, nullptr).box), 4, speed);
  const bool part = grid::cropped(speed, box) != static_cast<const grid::Lattice&>(speed);
  grid::Grid<float> part_speed;
  if (part) {
    part_speed = grid::crop(speed, box);
    phi = grid::crop(phi, box);
  }
  const grid::Grid<float>& g = part ? part_speed : speed;
  int iterations = 0;
  const BandRun run =
      evolve_levels(g, phi, params, params.coarse_levels_count, params.max_iterations_count, iterations, progress);
  if (!ended_well(run.end)) refuse_end(run, params);

  const Inside done = inside_of(phi, &g);
  const double held_back = double(done.held_back) / double(std::max<std::size_t>(done.voxels, 1));
  EvolvedResult result;
  result.iterations_count = iterations;
  result.stopped_by = run.end == BandEnd::converged ? "converged" : "iterations";
  result.change_mm = run.change_mm;
  result.time_step = run.time_step;
  result.mean_speed = done.mean_speed;
  result.negative_speed_ratio = held_back;
  result.volume_ml = double(done.voxels) * speed.voxel_volume_mm3() / 1000;
  if (!(done.mean_speed >= params.min_mean_speed))
    throw refusal("min_mean_speed",
                  fmt::format("the mean speed inside is {:.3f}, must be at least {}: it lost its structure",
                              done.mean_speed, trephine::to_text(params.min_mean_speed)),
                  {"begin inside the structure with `bubbles`, narrow what `presegment` finds, or lower "
                   "`min_mean_speed`"});
  Warnings warnings;
  if (params.max_iterations_count == 0)
    warnings.push_back(
        {"snake_does_nothing", "snake: max_iterations_count is 0: what comes out is what it begins with", {}});
  else if (run.end == BandEnd::iterations && params.min_change_mm > 0)
    warnings.push_back({"snake_still_moves",
                        "snake: still moves by {change_mm:.3g} mm an iteration after {iterations_count} of them",
                        {{"change_mm", run.change_mm}, {"iterations_count", std::int64_t{iterations}}}});
  // A geodesic surface is drawn beyond the place where a speed of both signs ends.
  if (!geodesic && params.propagation > 0 && held_back > max_held_back)
    warnings.push_back({"snake_leaked",
                        "snake: at {negative_percent:.0f} % of what it holds the speed is negative: it leaked through "
                        "noise, or began elsewhere; smooth the presegmentation (smoothing_sigma_mm) or narrow it, give "
                        "within or max_volume_ml",
                        {{"negative_percent", 100 * held_back}}});
  if (begun.edge == 0 && done.edge > 0)
    warnings.push_back({"snake_at_edge",
                        "snake: {edge_voxels_count} voxels at the edge of the speed image, it may have leaked",
                        {{"edge_voxels_count", static_cast<std::int64_t>(done.edge)}}});
  return {grid::crop(phi, grid::grown(done.box, 2, phi)), std::move(result), std::move(warnings)};
}

}  // namespace trephine::segmentation
