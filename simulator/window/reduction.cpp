// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/reduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace trephine::window {
namespace {

constexpr std::size_t looked_at = 8;    // pictures, whose median counts
constexpr double much_quicker = 0.35;   // of the target
constexpr int quick_before_raised = 5;  // medians in a row that are much quicker
constexpr int max_raised = 2;
// Pictures that took so many times too long need this size or a larger one: triangles are about as many as the square
// of their size is small, and much of a picture's time is none of theirs.
constexpr double too_long_for[] = {1, 1.3, 1.7, 2.5};

}  // namespace

double software_cost_ms(double ms, double cpu_ms, unsigned cores) {
  return std::max(ms, cpu_ms / std::max(1.0, 0.5 * cores));
}

Reduction::Reduction(double target_ms, const scene::ViewParams& whole, double fine_mm, bool software)
    : target_ms_(target_ms),
      whole_(whole),
      fine_mm_(fine_mm),
      sizes_mm_(std::begin(render::coarse_sizes_mm), std::end(render::coarse_sizes_mm)),
      level_(software && target_ms > 0 ? 1 : 0) {
  static_assert(std::size(too_long_for) == std::size(render::coarse_sizes_mm));
  if (whole.coarse_mm > 0) sizes_mm_ = {whole.coarse_mm};
}

bool Reduction::look(double ms) {
  if (!(target_ms_ > 0)) return false;
  times_.push_back(ms);
  if (times_.size() < looked_at) return false;
  std::nth_element(times_.begin(), times_.begin() + looked_at / 2, times_.end());
  const double typical = times_[looked_at / 2];
  times_.clear();
  quick_ = typical < much_quicker * target_ms_ ? quick_ + 1 : 0;
  if (typical > target_ms_ && level_ < most) {
    reduce(typical / target_ms_);
    return true;
  }
  if (quick_ >= quick_before_raised && level_ > 0 && raised_ < max_raised) {
    raise();
    return true;
  }
  return false;
}

void Reduction::reduce(double too_long) {
  const bool begins = level_ == coarse_level - 1;
  if (!begins && (level_ != coarse_level || size_ + 1 == sizes_mm_.size())) {
    ++level_;
    return;
  }
  level_ = coarse_level;
  size_ = begins ? 0 : size_ + 1;
  while (size_ + 1 < sizes_mm_.size() && too_long >= too_long_for[size_ + 1]) ++size_;
}

void Reduction::raise() {
  if (level_ == coarse_level && size_ > 0)
    --size_;
  else
    --level_;
  ++raised_;
  quick_ = 0;
}

scene::ViewParams Reduction::view() const {
  scene::ViewParams v = whole_;
  if (level_ >= 1) {
    v.samples = 1;
    v.occlusion = false;
  }
  if (level_ >= 2) v.grain = false;
  if (level_ >= most) v.shadow = false;
  return v;
}

std::string Reduction::text(texts::Language language) const {
  std::string out;
  const auto add = [&](Text text, bool of) {
    if (of) out += (out.empty() ? "" : ", ") + std::string(text_of(language, text));
  };
  add(Text::without_darkening, level_ >= 1);
  add(Text::without_grain, level_ >= 2 && whole_.grain);
  if (level_ >= coarse_level)
    out += ", " + fmt::format(fmt::runtime(text_of(language, Text::coarse_surfaces)), sizes_mm_[size_], fine_mm_);
  add(Text::without_shadow, level_ >= most && whole_.shadow);
  add(Text::half_the_pixels, level_ >= most);
  return out;
}

}  // namespace trephine::window
