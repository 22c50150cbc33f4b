// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/hand_edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/box_about.h"
#include "mask/filters.h"
#include "segmentation/bubbles.h"
#include "segmentation/correct.h"
#include "segmentation/speed_image.h"

namespace trephine::segmentation {
namespace {

constexpr int iterations_a_step = 2;  // at most about a voxel
constexpr std::size_t max_voxels = 40'000'000;
const Remedy elsewhere{"begin elsewhere, or with another range of HU (`lower_hu`, `upper_hu`)"};

Vec3 vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The box of the lattice's voxels within so many mm of a place; may be empty.
grid::Box box_about(const grid::Lattice& lattice, Vec3 centre, double radius_mm) {
  const Vec3 at = lattice.to_index(centre);
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    const double reach = radius_mm / lattice.spacing_mm[a];
    box.begin[a] = int(std::clamp(std::ceil(at[a] - reach), 0.0, double(lattice.size[a])));
    box.end[a] = int(std::clamp(std::floor(at[a] + reach) + 1, 0.0, double(lattice.size[a])));
  }
  return box;
}

/// f(i, j, k) for the voxels of the lattice whose centre lies in the ball.
template <class F>
void for_ball(const grid::Lattice& lattice, Vec3 centre, double radius_mm, F&& f) {
  mask::for_box_about(lattice, centre, radius_mm, [&](int i, int j, int k, double distance_mm) {
    if (distance_mm <= radius_mm) f(i, j, k);
    return false;
  });
}

/// Applies what changes as a painted correction is applied. `changes` holds 1 where voxels are added, 2 where removed.
Outcome<grid::Field, EditedResult> applied(const grid::Field& field, const grid::HuVolume& volume, grid::Mask changes,
                                           const Progress& progress) {
  bool any = false;
  for (const std::uint8_t v : changes.voxels) any = any || v;
  Outcome<grid::Field, EditedResult> out;
  if (any) {
    auto made = corrected(field, grid::lattice_of(volume), correction_of(std::move(changes)), progress);
    out.value = std::move(made.value);
    out.result = {made.result.changed.added_ml, made.result.changed.removed_ml};
  } else {
    out.value = field;
  }
  if (!(out.result.added_ml + out.result.removed_ml > 0))
    out.warnings.push_back({"changes_nothing", "changes nothing: the shape is already so there", {}});
  return out;
}

void require_field(const grid::Field& field, const grid::HuVolume& volume) {
  with_field("field", [&] { grid::place_in(field, grid::lattice_of(volume)); });
}

}  // namespace

EditSnake::EditSnake(const grid::HuVolume& volume, const SnakeEdit& edit, const Progress& progress)
    : centre_(vec(edit.seed_mm)), within_mm_(edit.within_mm) {
  const grid::Lattice& lattice = grid::lattice_of(volume);
  // Four voxels more hold the surface; the Gaussian sees what lies beyond.
  const double most_mm = std::max({lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z});
  const grid::Box near = box_about(lattice, centre_, within_mm_ + 4 * most_mm),
                  seen = box_about(lattice, centre_, within_mm_ + 8 * most_mm + 4 * edit.smoothing_sigma_mm);
  if (near.empty()) throw refusal("snake", "its first ball lies beyond the scan", elsewhere);
  if (grid::cropped(lattice, seen).count() > max_voxels)
    throw Error(ExitCode::usage, "", "within_mm", "is too large for voxels as small as the scan's");
  PresegmentParams how;
  how.lower_hu = edit.lower_hu;
  how.upper_hu = edit.upper_hu;
  how.smoothing_sigma_mm = edit.smoothing_sigma_mm;
  const grid::HuVolume part = std::visit([&](const auto& v) -> grid::HuVolume { return grid::crop(v, seen); }, volume);
  grid::Field ball(grid::cropped(lattice, near), -1.f);
  mask::for_box_about(ball, centre_, 2 * within_mm_, [&](int i, int j, int k, double distance_mm) {
    ball.at(i, j, k) = float(within_mm_ - distance_mm);
    return false;
  });
  PresegmentMasks masks;
  masks.within = &ball;
  speed_ = grid::fit(presegment(part, masks, how, progress).value, static_cast<const grid::Lattice&>(ball), -1.f);
  const std::vector<Bubble> seed = {{centre_, edit.seed_radius_mm}};
  surface_ = bubble_field(seed, speed_);
  require_start(volume, edit);
  band_.curvature = edit.curvature;
  band_.max_iterations_count = iterations_a_step;
}

void EditSnake::require_start(const grid::HuVolume& volume, const SnakeEdit& edit) const {
  bool positive = false;
  double low = 1e9, high = -1e9;
  for_ball(speed_, centre_, edit.seed_radius_mm, [&](int i, int j, int k) {
    positive = positive || speed_.at(i, j, k) > 0;
    const Vec3 at = grid::lattice_of(volume).to_index(speed_.to_world_mm({double(i), double(j), double(k)}));
    const double hu = std::visit(
        [&](const auto& v) {
          return double(v.at(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z))));
        },
        volume);
    low = std::min(low, hu);
    high = std::max(high, hu);
  });
  if (!positive)
    throw refusal(
        "snake", fmt::format("its first ball lies where the scan has {:.0f} to {:.0f} HU, beside its range", low, high),
        elsewhere);
}

void EditSnake::advance(const Progress& progress) {
  const BandRun run = evolve_band(speed_, surface_, band_, progress);
  if (run.end == BandEnd::vanished || run.end == BandEnd::filled)
    throw refusal("snake", run.end == BandEnd::filled ? "it fills all that it may" : "its surface vanishes", elsewhere);
  ++steps_;
  change_mm_ = run.change_mm;
}

grid::Mask EditSnake::mask() const {
  grid::Mask out(surface_);
  for_ball(surface_, centre_, within_mm_, [&](int i, int j, int k) { out.at(i, j, k) = surface_.at(i, j, k) > 0; });
  return out;
}

double EditSnake::volume_ml() const {
  std::size_t n = 0;
  for (const float v : surface_.voxels) n += v > 0;
  return double(n) * surface_.voxel_volume_mm3() / 1000;
}

Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume, const SnakeEdit& edit,
                                          const Progress& progress) {
  require_field(field, volume);
  EditSnake snake(volume, edit, progress.part(0, 0.2));
  for (int step = 0; step < edit.steps_count; ++step)
    snake.advance(progress.part(0.2 + 0.6 * step / edit.steps_count, 0.2 + 0.6 * (step + 1) / edit.steps_count));
  grid::Mask covered = snake.mask();
  if (edit.removes)
    for (std::uint8_t& v : covered.voxels) v = v ? 2 : 0;
  return applied(field, volume, std::move(covered), progress.part(0.8, 1));
}

Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume, const CutEdit& edit,
                                          const Progress& progress) {
  require_field(field, volume);
  const Vec3 point = vec(edit.point_mm), normal = vec(edit.normal);
  grid::Mask taken(field);
  for_ball(field, point, edit.within_mm, [&](int i, int j, int k) {
    const Vec3 to = field.to_world_mm({double(i), double(j), double(k)}) - point;
    if (field.at(i, j, k) > 0 && dot(to, normal) > 0) taken.at(i, j, k) = 2;
  });
  return applied(field, volume, std::move(taken), progress);
}

Outcome<grid::Field, EditedResult> edited(const grid::Field& field, const grid::HuVolume& volume,
                                          const SmoothEdit& edit, const Progress& progress) {
  require_field(field, volume);
  const Vec3 point = vec(edit.point_mm);
  // On the volume's voxels, for the shape may grow a little beyond its own; the Gaussian sees what lies beyond the
  // ball.
  const grid::Lattice& lattice = grid::lattice_of(volume);
  const grid::Box box = box_about(lattice, point, edit.within_mm + 4 * edit.sigma_mm);
  if (box.empty()) return applied(field, volume, grid::Mask(field), progress);
  const grid::Field shape = grid::fit(field, grid::cropped(lattice, box), -1.f);
  grid::Grid<float> smooth(shape);
  for (std::size_t v = 0; v < smooth.voxels.size(); ++v) smooth.voxels[v] = shape.voxels[v] > 0 ? 1.f : 0.f;
  mask::gaussian(smooth, edit.sigma_mm, progress.part(0, 0.5));
  grid::Mask changes(shape);
  for_ball(shape, point, edit.within_mm, [&](int i, int j, int k) {
    const bool was = shape.at(i, j, k) > 0, is = smooth.at(i, j, k) > 0.5f;
    if (was != is) changes.at(i, j, k) = is ? 1 : 2;
  });
  return applied(field, volume, std::move(changes), progress.part(0.5, 1));
}

}  // namespace trephine::segmentation
