// SPDX-License-Identifier: GPL-3.0-or-later
#include "drill/bone_heat.h"

#include <algorithm>
#include <cmath>

namespace trephine::drill {
namespace {

constexpr double conductivity_w_per_mm_k = 0.54e-3, capacity_j_per_g_k = 1.26, density_g_per_mm3 = 2.1e-3;
constexpr double shell_mm = 1, film_w_per_mm2_k = 2e-3;  // ours
constexpr double saline_j_per_ml_k = 4.1;
constexpr double max_dose_min = 1e6;

}  // namespace

BoneHeat::BoneHeat(const HeatParams& p, double radius_mm)
    : into_bone_ratio_(p.heat_into_bone_ratio), saline_c_(p.irrigation_c), water_ml_per_min_(p.irrigation_ml_per_min) {
  set_radius(radius_mm);
}

void BoneHeat::set_radius(double radius_mm) {
  const double area_mm2 = 2 * M_PI * radius_mm * radius_mm;
  capacity_j_per_k_ = density_g_per_mm3 * capacity_j_per_g_k * area_mm2 * shell_mm;
  bone_w_per_k_ = 2 * M_PI * conductivity_w_per_mm_k * radius_mm;
  saline_w_per_k_ = std::min(film_w_per_mm2_k * area_mm2, saline_j_per_ml_k * water_ml_per_min_ / 60);
}

// The temperature goes to that at which gain and loss are equal, exactly, however long the step.
void BoneHeat::step(double power_w, bool runs, double dt_s) {
  const double saline = runs ? saline_w_per_k_ : 0, loss = bone_w_per_k_ + saline;
  const double rests_at = (into_bone_ratio_ * power_w + bone_w_per_k_ * body_c + saline * saline_c_) / loss;
  now_c_ = rests_at + (now_c_ - rests_at) * std::exp(-dt_s * loss / capacity_j_per_k_);
  max_c_ = std::max(max_c_, now_c_);
  if (now_c_ > harm_c) above_s_ += dt_s;
  if (now_c_ > 39) {
    const double base = now_c_ >= 43 ? 0.5 : 0.25;
    dose_min_ = std::min(max_dose_min, dose_min_ + dt_s / 60 * std::pow(base, 43 - now_c_));
  }
}

}  // namespace trephine::drill
