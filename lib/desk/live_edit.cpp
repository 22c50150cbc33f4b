// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/live_edit.h"

#include "base/error.h"
#include "base/progress.h"
#include "json/declared_json.h"

namespace trephine::desk {
namespace {

constexpr int max_steps = 2000;

}  // namespace

void LiveEdit::show(const std::string& token, const grid::Field& field, const grid::HuVolume& scan) {
  auto drawn = std::make_shared<const DrawnField>(drawn_field(field, grid::lattice_of(scan)));
  const std::lock_guard<std::mutex> lock(shown_mutex_);
  token_ = token;
  shown_ = std::move(drawn);
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
  show(token, snake_->surface(), *scan);
  return {snake_->steps(), snake_->change_mm(), snake_->volume_ml()};
}

Report LiveEdit::preview(const std::string& token, const OpenCase& one, const std::string& anatomy,
                         const segmentation::EditList& edits) {
  const Progress progress({}, &cancel_requested());
  const std::shared_ptr<const DrawnField> drawn = one.field(anatomy);
  if (!drawn) throw Error(ExitCode::no_input, "", "anatomy", "the case has no such field");
  const std::lock_guard<std::mutex> lock(work_mutex_);
  grid::Field field(static_cast<const grid::Lattice&>(drawn->samples));
  for (std::size_t v = 0; v < field.voxels.size(); ++v) field.voxels[v] = drawn->samples.voxels[v];
  Report report;
  show(token, segmentation::apply_edits(field, *one.scan(), edits, {}, report, progress), *one.scan());
  return report;
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
