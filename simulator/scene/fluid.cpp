// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/fluid.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"

namespace trephine::scene {
namespace {

constexpr double gravity_mm_per_s2 = 9810;
constexpr double pa_per_mmhg = 133.322;
constexpr double bead_apart_mm = 14, tube_mm2 = 1.33;  // of a bore of 1.3 mm
constexpr double drop_ml = 0.05, drop_mm = 2.3;        // a ball of that volume
constexpr double swells = 0.65;                        // of the time from one drop to the next
constexpr double seen_falling_mm = 400;
constexpr std::size_t most_falling = 12;

}  // namespace

// Hagen and Poiseuille.
CsfDrain::CsfDrain(const CsfPressure& params)
    : params_(params),
      ml_per_s_mmhg_(1e6 * pa_per_mmhg * pi * std::pow(0.5e-3 * params.bore_mm, 4) /
                     (8 * 1e-3 * params.viscosity_mpa_s * 1e-3 * params.tube_mm)) {}

double CsfDrain::pressure_mmhg() const { return params_.opening_mmhg * std::pow(10.0, -drained_ml_ / params_.pvi_ml); }

double CsfDrain::ml_per_s(double height_mm) const {
  const double column_mmhg = 1e-6 * params_.density_kg_per_m3 * gravity_mm_per_s2 * height_mm / pa_per_mmhg;
  return std::max(0.0, pressure_mmhg() - std::max(0.0, column_mmhg)) * ml_per_s_mmhg_;
}

void CsfDrain::step(double height_mm, double dt_s) {
  constexpr double most_s = 0.05;  // some thousandth of the time in which the pressure falls
  for (; dt_s > 0; dt_s -= most_s) drained_ml_ += ml_per_s(height_mm) * std::min(dt_s, most_s);
}

std::vector<Marker> drops_of(const Tube& t, double drained_ml, double ml_per_s, const std::array<float, 3>& rgb) {
  std::vector<Marker> drops;
  if (!(ml_per_s > 0)) return drops;
  for (double at = std::fmod(1000 * drained_ml / tube_mm2, bead_apart_mm); at < t.to_mm; at += bead_apart_mm)
    drops.push_back({t.tip_mm + t.axis * at, 1.2 * t.radius_mm, rgb});
  // The drop that swells, and those before it as long as they are seen to fall.
  const Vec3 end = t.tip_mm + t.axis * t.to_mm;
  double grown = std::fmod(drained_ml / drop_ml, 1.0);
  for (std::size_t n = 0; n < most_falling; ++n, grown += 1) {
    const double falling_s = std::max(0.0, grown - swells) * drop_ml / ml_per_s;
    const double fallen_mm = 0.5 * gravity_mm_per_s2 * falling_s * falling_s;
    if (fallen_mm > seen_falling_mm) break;
    const double size = drop_mm * std::cbrt(std::min(1.0, grown / swells));
    drops.push_back({end + t.down * (0.5 * size + fallen_mm), size, rgb});
  }
  return drops;
}

}  // namespace trephine::scene
