// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage shows of a case where pictures take too long.
#include <fmt/format.h>

#include <limits>
#include <utility>

#include "render/memory.h"
#include "render/stage.h"

namespace trephine::render {
namespace {

constexpr std::size_t slice_bytes = 1 << 20;  // that are uploaded between two pictures

}  // namespace

void Stage::set_quality(const scene::ViewParams& params, double scale, const Coarseness& coarse, double cast_ms) {
  const bool other = coarse.within_mm != coarse_.within_mm;
  coarse_ = coarse;
  cast_ms_ = cast_ms;
  scale_ = scale;
  samples_ = samples_of(params);
  renderer_->set_quality(quality_of(params));
  if (other) begin_coarse();
}

// Surfaces that are coarse everywhere are put back first, for only then it is known how much memory there is beside
// them.
void Stage::begin_coarse() {
  worker_.cancel();
  uploading_ = false;
  given_.assign(scene_.surfaces.size(), nullptr);
  put_back();
  if (!(coarse_.within_mm > 0)) {
    for (std::size_t n = 0; n < scene_.surfaces.size(); ++n) renderer_->set_coarse(int(n), std::nullopt);
    return;
  }
  std::vector<CoarseAsk> asks;  // the outermost surfaces come first: they are seen
  for (std::size_t n = 0; n < scene_.surfaces.size(); ++n) {
    const scene::SceneSurface& s = scene_.surfaces[n];
    given_[n] = renderer_->parts(int(n));
    asks.push_back(
        {int(n), shown_mm_[n] > 0 ? nullptr : given_[n], !s.live && coarse_.within_mm > shown_mm_[n] ? &s : nullptr});
  }
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
  if (budget_bytes_ > 0) {
    const std::size_t used =
        renderer_->scene_bytes() - renderer_->coarse_bytes() + room_for_picture(samples_of(params_));
    max_bytes = budget_bytes_ > used ? budget_bytes_ - used : 0;
  }
  worker_.begin(coarse_.within_mm, max_bytes, std::move(asks));
}

// Surfaces that are coarse everywhere because pictures took too long: as the memory lets them be.
void Stage::put_back() {
  for (std::size_t n = 0; n < shown_mm_.size(); ++n) {
    if (shown_mm_[n] == needed_mm_[n]) continue;
    shown_mm_[n] = needed_mm_[n];
    renderer_->set_surface(int(n), needed_[n]);
  }
}

void Stage::follow_coarse() {
  // A live surface that was made anew has no coarser triangles any more.
  if (coarse_.within_mm > 0)
    for (std::size_t n = 0; n < given_.size(); ++n)
      if (scene_.surfaces[n].live && renderer_->parts(int(n)) != given_[n]) {
        begin_coarse();
        break;
      }
  while (std::optional<CoarseMade> made = worker_.take()) show_coarse(std::move(*made));
  if (uploading_) uploading_ = renderer_->upload_coarse(slice_bytes);
}

void Stage::wait_for_coarse() {
  while (coarse_comes()) {
    worker_.wait();
    follow_coarse();
  }
}

// Where the memory does not hold coarser triangles beside the whole ones, they are drawn in their place.
void Stage::show_coarse(CoarseMade made) {
  const std::size_t n = std::size_t(made.surface);
  const std::string& name = scene_.surfaces[n].name;
  const auto tell = [&](const texts::Note& note) {
    if (told_coarse_.count(name) && told_coarse_.at(name) == note) return;
    told_coarse_.insert_or_assign(name, note);
    notes_.push_back(note);
  };
  if (made.instead) {
    shown_mm_[n] = coarse_.within_mm;
    renderer_->set_surface(made.surface, std::move(made.instead));
    tell({texts::NoteId::coarse, made.facts.values(name)});
    return;
  }
  if (made.beside) {
    uploading_ = true;
    std::vector<std::string> values = made.facts.values(name);
    values.insert(values.begin(), fmt::format("{:.0f}", coarse_.fine_mm));
    tell({texts::NoteId::coarse_beyond, values});
  }
  const bool fits_beside = fits(renderer_->scene_bytes() + room_for_picture(samples_of(params_)) + made.facts.bytes);
  renderer_->set_coarse(made.surface, std::move(made.beside), fits_beside);
}

}  // namespace trephine::render
