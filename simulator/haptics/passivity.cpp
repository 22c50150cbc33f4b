// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/passivity.h"

#include <algorithm>
#include <cmath>

namespace trephine::haptics {

// The force of the tick `n` before the last acts from a part `late` of this tick on; until then the one before it does.
void Passivity::observe(Vec3 step_mm, double period_s) {
  const double ticks = std::min(delay_s_ / period_s, double(kept - 4));
  const auto n = std::size_t(ticks);
  const double late = ticks - double(n);
  const Vec3 acted = sent(n) * (1 - late) + sent(n + 1) * late;
  given_n_mm_ += dot(acted, step_mm);
  if (given_n_mm_ > 0) given_n_mm_ = std::max(0.0, given_n_mm_ - 1e3 * forgiven_w * period_s);
  given_n_mm_ = std::max(given_n_mm_, -max_credit_n_mm);
  now_ = (now_ + 1) % kept;
  sent(0) = sent(1);  // what a device does that is sent nothing; of the last tick allow() sets it
}

void Passivity::remember(double mm_per_s, double dt_s) {
  for (part_age_s_ += dt_s; part_age_s_ > part_s; part_age_s_ -= std::min(part_age_s_, part_s)) {
    std::copy_backward(fastest_.begin(), fastest_.end() - 1, fastest_.end());
    fastest_[0] = 0;
  }
  fastest_[0] = std::max(fastest_[0], mm_per_s);
}

double Passivity::allow(Vec3 tip_mm, Vec3 wanted_n, double dt_s, double period_s, bool placed) {
  const int ticks = std::clamp(int(std::lround(dt_s / period_s)), 1, int(kept));
  const Vec3 way = known_ && !placed ? (tip_mm - tip_mm_) / ticks : Vec3{};
  for (int n = 0; n < ticks; ++n) observe(way, period_s);
  remember(norm(way) / period_s, std::min(dt_s, 1.0));
  tip_mm_ = tip_mm;
  known_ = true;

  const double size = norm(wanted_n);
  const auto slots = std::min(std::size_t(std::ceil(delay_s_ / period_s)), kept - 4);
  sent(0) = {};
  if (!(size > 0)) {
    bool any = false;
    for (std::size_t n = 1; n <= slots + 1; ++n) any = any || !(sent(n) == Vec3{});
    if (!any) given_n_mm_ = std::max(given_n_mm_, 0.0);  // each contact pays for itself
    share_ = 1;
    return 1;
  }
  const double fastest_mm = *std::max_element(fastest_.begin(), fastest_.end()) * period_s;  // in a tick
  const double faster_mm = 1e3 * spare_m_per_s2 * period_s * period_s;
  double under_way_n_mm = 0, whole_way_mm = 0, last_way_mm = 0;
  for (std::size_t n = slots + 1; n-- > 0;) {  // the oldest acts next
    last_way_mm = fastest_mm + faster_mm * double(slots + 1 - n);
    whole_way_mm += last_way_mm;
    under_way_n_mm += norm(sent(n)) * last_way_mm;
  }
  const double budget_n_mm = 1e3 * spare_j - given_n_mm_;
  // As much as can go on for a whole delay, and no more than what is under way leaves.
  const double max_n = std::min(budget_n_mm / whole_way_mm, (budget_n_mm - under_way_n_mm) / last_way_mm);
  share_ = std::clamp(max_n / size, 0.0, std::min(1.0, share_ + dt_s / let_in_s));
  sent(0) = wanted_n * share_;
  return share_;
}

}  // namespace trephine::haptics
