// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/live_edit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "json/declared_json.h"

namespace trephine::desk {
namespace {

constexpr int max_steps = 2000;
constexpr int most = 32767;        ///< of a drawn sample
constexpr double rim_voxels = 12;  ///< beyond its ball, within which an edit smooths and looks

grid::Box box_about(const grid::Lattice& lattice, const segmentation::EditReach& reach) {
  const Vec3 at = lattice.to_index(reach.centre_mm);
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    const double mean = std::cbrt(lattice.voxel_volume_mm3());
    const double wide = (reach.radius_mm + rim_voxels * mean) / lattice.spacing_mm[a],
                 size = lattice.size[std::size_t(a)];
    box.begin[std::size_t(a)] = int(std::clamp(std::floor(at[a] - wide), 0.0, size));
    box.end[std::size_t(a)] = int(std::clamp(std::ceil(at[a] + wide) + 1, 0.0, size));
  }
  return box;
}

template <class F>
void for_box(const grid::Box& box, F&& f) {
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) f(i, j, k);
}

std::int16_t& at_place(DrawnField& field, int i, int j, int k) {
  return field.samples.at(i - field.place.begin[0], j - field.place.begin[1], k - field.place.begin[2]);
}

/// The field over a place that holds `near` too; what is new is outside.
DrawnField spread(const DrawnField& field, const grid::Box& near, const grid::Lattice& lattice) {
  DrawnField out;
  out.place = field.place;
  for (std::size_t a = 0; a < 3; ++a) {
    out.place.begin[a] = std::min(out.place.begin[a], near.begin[a]);
    out.place.end[a] = std::max(out.place.end[a], near.end[a]);
  }
  out.samples = grid::Grid<std::int16_t>(grid::cropped(lattice, out.place), std::int16_t(-most));
  for (int k = 0; k < field.samples.size[2]; ++k)
    for (int j = 0; j < field.samples.size[1]; ++j)
      std::copy_n(&field.samples.voxels[field.samples.index(0, j, k)], field.samples.size[0],
                  &at_place(out, field.place.begin[0], field.place.begin[1] + j, field.place.begin[2] + k));
  return out;
}

grid::Field field_of(DrawnField& drawn, const grid::Box& near, const grid::Lattice& lattice) {
  grid::Field out(grid::cropped(lattice, near));
  std::size_t n = 0;
  for_box(near, [&](int i, int j, int k) { out.voxels[n++] = at_place(drawn, i, j, k); });
  return out;
}

}  // namespace

void LiveEdit::show(const std::string& token, DrawnField drawn) {
  auto shown = std::make_shared<const DrawnField>(std::move(drawn));
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  token_ = token;
  shown_ = std::move(shown);
}

LiveEdit::Now LiveEdit::snake(const std::string& token, const OpenCase& one, const segmentation::SnakeEdit& edit,
                              int steps) {
  if (steps < 0 || steps > max_steps) throw Error(ExitCode::usage, "", "steps", "must be 0 to 2000");
  const Progress progress({}, &cancel_requested());
  const std::lock_guard<std::mutex> lock(work_mutex_);
  segmentation::SnakeEdit of = edit;
  of.steps_count = 0;
  const std::string text = json::declared_json(parameters_of<segmentation::SnakeEdit>(), &of);
  const std::shared_ptr<const grid::HuVolume> scan = one.scan();
  if (!snake_ || text != snake_of_ || scan != scan_ || snake_->steps() > steps) {
    snake_.reset();
    snake_.emplace(*scan, edit, progress);
    snake_of_ = text;
    scan_ = scan;
  }
  try {
    while (snake_->steps() < steps) snake_->advance(progress);
  } catch (...) {
    snake_.reset();  // it stands between two steps
    throw;
  }
  show(token, drawn_field(snake_->surface(), grid::lattice_of(*scan)));
  return {snake_->steps(), snake_->change_mm(), snake_->volume_ml()};
}

Outcome<std::monostate, segmentation::EditsResult> LiveEdit::preview(const std::string& token, const OpenCase& one,
                                                                     const std::string& anatomy,
                                                                     const segmentation::EditList& edit) {
  const Progress progress({}, &cancel_requested());
  const std::shared_ptr<const DrawnField> drawn = one.field(anatomy);
  if (!drawn) throw Error(ExitCode::no_input, "", "anatomy", "the case has no such field");
  const std::shared_ptr<const grid::HuVolume> scan = one.scan();
  const grid::Lattice& lattice = grid::lattice_of(*scan);
  const grid::Box near = box_about(lattice, segmentation::reach_of(edit.edits.at(0).first, edit.edits.at(0).second));
  if (near.empty()) throw Error(ExitCode::usage, "", "edit", "lies beyond the scan");
  const std::lock_guard<std::mutex> lock(work_mutex_);
  DrawnField out = spread(*drawn, near, lattice);
  auto made = segmentation::apply_edits(field_of(out, near, lattice), *scan, edit, {}, progress);
  const grid::Field part = grid::fit(made.value, grid::cropped(lattice, near), -float(most));
  for_box(near, [&](int i, int j, int k) {
    const float v = part.at(i - near.begin[0], j - near.begin[1], k - near.begin[2]);
    const auto n = static_cast<std::int16_t>(std::lround(std::clamp(v, -float(most), float(most))));
    at_place(out, i, j, k) = n != 0 ? n : v > 0 ? 1 : -1;
  });
  show(token, std::move(out));
  return {{}, made.result, std::move(made.warnings)};
}

std::shared_ptr<const DrawnField> LiveEdit::field(const std::string& token) const {
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  return token == token_ ? shown_ : nullptr;
}

void LiveEdit::forget() {
  {
    const std::lock_guard<std::mutex> lock(work_mutex_);
    snake_.reset();
    scan_.reset();
  }
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  shown_.reset();
}

}  // namespace trephine::desk
