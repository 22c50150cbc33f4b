// SPDX-License-Identifier: GPL-3.0-or-later
// What a stage shows of a case where the graphics memory does not hold all of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "render/memory.h"
#include "render/stage.h"

namespace trephine::render {
namespace {

constexpr int max_halvings = 2;  // of the CT; after them there is none

std::array<int, 3> halved_size(std::array<int, 3> size, int times) {
  for (; times > 0; --times)
    for (int& n : size) n = (n + 1) / 2;
  return size;
}

std::size_t ct_bytes(const std::array<int, 3>& size) {
  return std::size_t(size[0]) * std::size_t(size[1]) * std::size_t(size[2]) * sizeof(std::int16_t);
}

// What several coarsenings of a surface are, each made once.
class CoarseSurfaces {
 public:
  explicit CoarseSurfaces(const scene::SceneData& scene) : scene_(scene) {}
  const scene::SceneSurface& of(std::size_t n, double mm) {
    if (!(mm > 0)) return scene_.surfaces[n];
    const auto found = made_.find({n, mm});
    if (found != made_.end()) return found->second;
    return made_.emplace(std::pair(n, mm), coarse_surface(scene_.surfaces[n], mm)).first->second;
  }

 private:
  const scene::SceneData& scene_;
  std::map<std::pair<std::size_t, double>, scene::SceneSurface> made_;
};

// How coarse each surface must be, so that all of them take no more than `room`: the largest first, and none much
// coarser than another. Returns what they then take, which may be more.
std::size_t fit_surfaces(const scene::SceneData& scene, const std::vector<double>& sizes_mm, std::size_t room,
                         CoarseSurfaces& coarse, std::vector<double>& shown_mm) {
  shown_mm.assign(scene.surfaces.size(), 0);
  std::vector<std::size_t> order;
  std::size_t sum = 0;
  for (std::size_t n = 0; n < scene.surfaces.size(); ++n) {
    if (scene.surfaces[n].live) continue;
    order.push_back(n);
    sum += bytes_of(scene.surfaces[n]);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return bytes_of(scene.surfaces[a]) > bytes_of(scene.surfaces[b]);
  });
  for (const double mm : sizes_mm)
    for (const std::size_t n : order) {
      if (sum <= room) return sum;
      const std::size_t was = bytes_of(coarse.of(n, shown_mm[n])), now = bytes_of(coarse.of(n, mm));
      if (now >= was) continue;
      sum -= was - now;
      shown_mm[n] = mm;
    }
  return sum;
}

}  // namespace

int Stage::samples_of(const scene::ViewParams& p) const {
  return std::min(max_samples_, p.samples > 0 ? p.samples : driver_.software ? 1 : 4);
}

bool Stage::fits(std::size_t bytes) const { return budget_bytes_ == 0 || bytes <= budget_bytes_; }

// The live surfaces are there, for what is cut cannot be coarser. What is missed least is left out first: smooth edges,
// then triangles of what no tool drills, then the CT's resolution.
void Stage::fit_memory() {
  std::vector<double> sizes(std::begin(coarse_sizes_mm), std::end(coarse_sizes_mm));
  if (params_.coarse_mm > 0) sizes = {params_.coarse_mm};
  const std::size_t live = renderer_->scene_bytes();
  CoarseSurfaces coarse(scene_);
  std::size_t needed = 0;
  const auto try_it = [&](int halvings, bool may_be_coarse) {
    const std::size_t ct =
        loaded_.has_ct() && halvings <= max_halvings ? ct_bytes(halved_size(loaded_.ct.size, halvings)) : 0;
    const std::size_t rest = live + room_for_picture(samples_of(params_)) + ct;
    const std::size_t left = budget_bytes_ == 0     ? std::numeric_limits<std::size_t>::max()
                             : budget_bytes_ > rest ? budget_bytes_ - rest
                                                    : 0;
    needed = rest + fit_surfaces(scene_, may_be_coarse ? sizes : std::vector<double>(), left, coarse, needed_mm_);
    return fits(needed);
  };
  int halvings = 0;
  const auto too_large = [&](int h) {
    const std::array<int, 3> size = halved_size(loaded_.ct.size, h);
    return *std::max_element(size.begin(), size.end()) > Renderer::max_ct_side();
  };
  while (loaded_.has_ct() && halvings <= max_halvings && too_large(halvings)) ++halvings;
  if (!try_it(halvings, false)) {
    if (samples_of(params_) > 1) {
      max_samples_ = 1;
      notes_.push_back(texts::NoteId::memory_edges);
    }
    while (!try_it(halvings, true)) {
      if (!loaded_.has_ct() || halvings > max_halvings)
        throw Error(ExitCode::io, "", "graphics_budget_mb",
                    fmt::format("{:g} is too little: surfaces and pictures need {:.0f}", params_.graphics_budget_mb,
                                std::ceil(1e-6 * double(needed))));
      ++halvings;
    }
  }
  shown_mm_ = needed_mm_;
  needed_.assign(scene_.surfaces.size(), nullptr);
  for (std::size_t n = 0; n < scene_.surfaces.size(); ++n) {
    if (scene_.surfaces[n].live) continue;
    const scene::SceneSurface& shown = coarse.of(n, shown_mm_[n]);
    needed_[n] = std::make_shared<const SurfaceParts>(parts_of(shown));
    renderer_->set_surface(int(n), needed_[n]);
    if (shown_mm_[n] > 0)
      notes_.push_back(
          {texts::NoteId::memory_coarse, coarse_facts(scene_.surfaces[n], shown).values(scene_.surfaces[n].name)});
  }
  show_ct(halvings);
}

void Stage::show_ct(int halvings) {
  if (!loaded_.has_ct()) return;
  if (halvings == 0) {
    renderer_->set_ct(loaded_.ct);
    return;
  }
  if (halvings > max_halvings) {
    notes_.push_back(texts::NoteId::memory_no_ct);
    return;
  }
  grid::Grid<std::int16_t> less = halved(loaded_.ct);
  for (int n = 1; n < halvings; ++n) less = halved(less);
  notes_.push_back({texts::NoteId::memory_ct, {fmt::format("{:.1f}", less.spacing_mm.x)}});
  renderer_->set_ct(less);
}

// The newest incision is what somebody looks at: older ones go for it.
void Stage::fit_incisions(std::size_t of_newest) {
  const auto over = [&] { return !fits(renderer_->scene_bytes() + room_for_picture(samples_of(params_))); };
  bool dropped = false;
  while (over() && renderer_->incisions() > of_newest) {
    renderer_->drop_oldest_incision();
    dropped = true;
  }
  if (dropped && !std::exchange(told_incisions_, true)) notes_.push_back(texts::NoteId::memory_old_incisions);
  if (over() && !std::exchange(told_over_, true))
    notes_.push_back({texts::NoteId::memory_new_incision,
                      {fmt::format("{:.2f}", 1e-6 * double(renderer_->scene_bytes() +
                                                           room_for_picture(samples_of(params_)) - budget_bytes_))}});
}

// A window may be larger than the screen that was reckoned with: it then has fewer pixels.
double Stage::picture_scale(int width, int height) {
  const auto sized = [&](double scale) {
    return std::pair(std::max(1, int(width * scale)), std::max(1, int(height * scale)));
  };
  const auto bytes = [&](double scale) {
    const auto [w, h] = sized(scale);
    return picture_bytes(w, h, samples_);
  };
  const std::size_t used = renderer_->scene_bytes();
  if (fits(used + bytes(scale_))) return scale_;
  const std::size_t left =
      std::max(room_for_picture(samples_of(params_)), budget_bytes_ > used ? budget_bytes_ - used : 0);
  double scale = std::min(scale_, std::sqrt(double(left) / double(bytes(1))));
  while (bytes(scale) > left && scale > 0.01) scale *= 0.99;
  if (std::exchange(told_picture_, {width, height}) != std::pair(width, height))
    notes_.push_back({texts::NoteId::memory_pictures,
                      {std::to_string(sized(scale).first), std::to_string(sized(scale).second), std::to_string(width),
                       std::to_string(height)}});
  return scale;
}

}  // namespace trephine::render
