// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/reduction.h"

#include <fmt/format.h>

#include <algorithm>

namespace trephine {
namespace {

constexpr std::size_t looked_at = 8;    // pictures, whose median counts
constexpr double much_quicker = 0.35;   // of the target
constexpr int quick_before_raised = 5;  // medians in a row that are much quicker
constexpr int most_raised = 2;

}  // namespace

Reduction::Reduction(double target_ms, const ViewParams& whole, const Coarseness& coarse, bool software)
    : target_ms_(target_ms), whole_(whole), coarse_(coarse), level_(software && target_ms > 0 ? 1 : 0) {}

bool Reduction::look(double ms) {
  if (!(target_ms_ > 0)) return false;
  times_.push_back(ms);
  if (times_.size() < looked_at) return false;
  std::nth_element(times_.begin(), times_.begin() + looked_at / 2, times_.end());
  const double typical = times_[looked_at / 2];
  times_.clear();
  quick_ = typical < much_quicker * target_ms_ ? quick_ + 1 : 0;
  if (typical > target_ms_ && level_ < most) {
    ++level_;
    if (level_ == 3 && !(coarse_.within_mm > 0)) ++level_;  // nothing is to be made coarser
    return true;
  }
  if (quick_ >= quick_before_raised && level_ > 0 && raised_ < most_raised) {
    --level_;
    if (level_ == 3 && !(coarse_.within_mm > 0)) --level_;
    ++raised_;
    quick_ = 0;
    return true;
  }
  return false;
}

ViewParams Reduction::view() const {
  ViewParams v = whole_;
  if (level_ >= 1) {
    v.samples = 1;
    v.occlusion = false;
  }
  if (level_ >= 2) v.grain = false;
  if (level_ >= 4) v.shadow = false;
  return v;
}

std::string Reduction::text(Language language) const {
  std::string out;
  const auto add = [&](Text text, bool of) {
    if (of) out += (out.empty() ? "" : ", ") + std::string(text_of(language, text));
  };
  add(Text::without_darkening, level_ >= 1);
  add(Text::without_grain, level_ >= 2 && whole_.grain);
  if (level_ >= 3 && coarse_.within_mm > 0)
    out +=
        ", " + fmt::format(fmt::runtime(text_of(language, Text::coarse_surfaces)), coarse_.within_mm, coarse_.fine_mm);
  add(Text::without_shadow, level_ >= 4 && whole_.shadow);
  add(Text::half_the_pixels, level_ >= 4);
  return out;
}

}  // namespace trephine
