// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/bits.h"
#include "mask/inside_box.h"
#include "segmentation/bubbles.h"
#include "segmentation/snake.h"
#include "segmentation/snake_band.h"

namespace trephine::segmentation {
namespace {

constexpr double max_held = 0.1;  ///< share of a surface that limits may hold: more may be a leak

/// The mask as a distance in mm near its surface, on the lattice.
grid::Grid<float> near_distance(const grid::Field& mask, const char* name, const grid::Lattice& lattice) {
  for (const float f : mask.voxels)
    if (!std::isfinite(f)) throw Error(ExitCode::bad_input, "", name, "a voxel is not finite");
  grid::Grid<float> d = with_field(name, [&] { return grid::fit(mask, lattice, -1.f); });
  BandParams none;
  none.max_iterations_count = 0;
  evolve_band(d, d, none, {});
  return d;
}

/// Calls f(index into field, distance) for every voxel; positive where the mask allows.
template <class F>
void for_allowed(const grid::Field& field, const SnakeMasks& masks, F&& f) {
  const auto each = [&](const grid::Field* mask, const char* name, float sign) {
    if (!mask) return;
    const grid::Grid<float> d = near_distance(*mask, name, field);
    parallel_for(0, std::int64_t(field.count()), 1 << 16, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t v = from; v < to; ++v) f(std::size_t(v), sign * d.voxels[v]);
    });
  };
  each(masks.within, "within", 1);
  each(masks.without, "without", -1);
}

using Snake = Outcome<grid::Field, SnakeResult>;

/// Measures how much of the surface rests on nothing in the image: where the masks end and the speed would move it
/// further, or, for a geodesic snake, at the wall around a speed image. `forbidden` is on the field's voxels.
void measure_held(const grid::Field& speed, const SnakeMasks& masks, SnakeMethod method, Snake& made) {
  const grid::Field& field = made.value;
  std::vector<char> forbidden(field.count(), 0);
  for_allowed(field, masks, [&](std::size_t v, float depth) {
    if (!(depth > 0)) forbidden[v] = 1;
  });
  const grid::Field g = grid::fit(speed, static_cast<const grid::Lattice&>(field), 0.f);
  const Vec3 h = field.spacing_mm;
  const double face[3] = {h.y * h.z, h.x * h.z, h.x * h.y};
  std::vector<double> all(std::size_t(field.size[2])), held(all.size());
  parallel_for(0, field.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < int(to); ++k)
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i) {
          if (!(field.at(i, j, k) > 0)) continue;
          for (int side = 0; side < 6; ++side) {
            const int a = side / 2;
            int n[3] = {i, j, k};
            n[a] += side % 2 ? 1 : -1;
            if (!field.contains(n[0], n[1], n[2]) || field.at(n[0], n[1], n[2]) > 0) continue;
            const std::size_t v = field.index(n[0], n[1], n[2]);
            all[k] += face[a];
            if ((forbidden[v] && g.voxels[v] > 0) ||
                (method == SnakeMethod::geodesic && g.voxels[v] <= -1 && g.at(i, j, k) >= 0))
              held[k] += face[a];
          }
        }
  });
  double whole = 0, rim = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    whole += all[k];
    rim += held[k];
  }
  const double ratio = whole > 0 ? rim / whole : 0;
  made.result.held_by_limits_ratio = ratio;
  made.result.pieces_count = mask::components(mask::positive(field, field)).list.size();
  if (ratio > max_held)
    made.warnings.push_back({"snake_rests_on_limits",
                             "snake: {held_percent:.0f} % of its surface rest on the limits given and not on the speed "
                             "image: it may have leaked; narrow the presegmentation, or set max_volume_ml",
                             {{"held_percent", 100 * ratio}}});
}

grid::Field begin(const grid::Field& speed, const SnakeMasks& masks, const SnakeParams& p, SnakeResult& result,
                  const Progress& progress) {
  const int ways = int(masks.start != nullptr) + int(!p.bubbles.empty()) + int(p.bubbles_count > 0);
  if (ways != 1)
    throw Error(ExitCode::usage, "", "start, bubbles, bubbles_count",
                fmt::format("{} of them given, must be one: what the surface begins with", ways));
  if (masks.start) return *masks.start;
  const bool given = !p.bubbles.empty();
  const std::vector<Bubble> bubbles =
      given ? parse_bubbles(p.bubbles) : place_bubbles(speed, p.bubbles_count, p.bubble_min_radius_mm, progress);
  grid::Field field = bubble_field(bubbles, speed);
  if (given && p.propagation > 0) check_bubbles(bubbles, speed);
  double most = 0;
  for (const Bubble& b : bubbles) most = std::max(most, b.radius_mm);
  result.bubbles = BubbleFigures{bubbles.size(), to_text(bubbles), most};
  return field;
}

}  // namespace

Outcome<grid::Field, SnakeResult> snake(const grid::Field& speed, const SnakeMasks& masks, const SnakeParams& params,
                                        const Progress& progress) {
  Snake made;
  const auto take = [&](Outcome<grid::Field, EvolvedResult> evolved) {
    made.value = std::move(evolved.value);
    made.result.evolved = std::move(evolved.result);
    made.warnings = std::move(evolved.warnings);
  };
  if (!masks.within && !masks.without) {
    const grid::Field start = begin(speed, masks, params, made.result, progress.part(0, 0.1));
    take(evolve_snake(speed, start, params, progress.part(0.1, 1)));
    measure_held(speed, masks, params.method, made);
    return made;
  }

  // The surface is held back one layer of voxels beyond the masks, so that at the end the masks cut it between voxels.
  const float layer = 1.01f * float(std::max({speed.spacing_mm.x, speed.spacing_mm.y, speed.spacing_mm.z}));
  grid::Field held = speed;
  for_allowed(speed, masks, [&](std::size_t v, float depth) {
    if (!(depth > -layer)) held.voxels[v] = std::min(held.voxels[v], -1.f);
  });
  const grid::Field start = begin(held, masks, params, made.result, progress.part(0, 0.1));
  take(evolve_snake(held, start, params, progress.part(0.1, 0.95)));
  grid::Field& field = made.value;
  for_allowed(field, masks, [&](std::size_t v, float depth) { field.voxels[v] = std::min(field.voxels[v], depth); });

  const mask::InsideBox box = mask::inside_box(field);
  made.result.evolved.volume_ml = double(box.count) * speed.voxel_volume_mm3() / 1000;
  if (box.count == 0)
    throw refusal("within, without", "nothing of the surface lies where they allow",
                  {"give a larger `within` or a smaller `without`, or begin elsewhere with `start` or `bubbles`"});
  field = grid::crop(field, grid::grown(box, 2, field));
  measure_held(speed, masks, params.method, made);
  return made;
}

}  // namespace trephine::segmentation
