// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/delayed_walls.h"

#include <algorithm>

namespace trephine::haptics {
namespace {

constexpr double spent = 0.8;  // of the device's damping

}  // namespace

DelayedWalls walls_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz) {
  DelayedWalls out;
  if (!port.bounds_walls()) return out;
  const double late_s = 0.5 / rate_hz + 1e-3 * port.device_delay_ms, b = spent * port.device_own_damping_n_s_per_mm;
  double drag = 0, wall = 0, everywhere = free.viscosity_n_s_per_mm;
  if (free.guide != FreeParams::Guide::none) everywhere += free.guide_n_per_mm * late_s;
  for (const ShapeFeel& feel : feels) {
    drag = std::max(drag, feel.drag_n_s_per_mm);
    for (const cases::CaseFace* face : {&feel.front, &feel.back})
      if (face->touchable) wall = std::max(wall, face->stiffness_n_per_mm * late_s + face->damping_n_s_per_mm);
  }
  const auto ratio = [](double asked, double most) { return asked > most ? most / asked : 1.0; };
  out.drag_ratio = ratio(drag, 0.25 * b);
  out.free_ratio = ratio(everywhere, 0.25 * b);
  out.stiffness_ratio = ratio(wall, b - drag * out.drag_ratio - everywhere * out.free_ratio);
  return out;
}

Feels feels_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz) {
  const DelayedWalls walls = walls_behind(feels, free, port, rate_hz);
  Feels out = feels;
  for (ShapeFeel& feel : out) {
    feel.drag_n_s_per_mm *= walls.drag_ratio;
    for (cases::CaseFace* face : {&feel.front, &feel.back}) {
      face->stiffness_n_per_mm *= walls.stiffness_ratio;
      face->damping_n_s_per_mm *= walls.stiffness_ratio;
    }
  }
  return out;
}

FreeParams free_behind(const Feels& feels, const FreeParams& free, const PortParams& port, double rate_hz) {
  const double ratio = walls_behind(feels, free, port, rate_hz).free_ratio;
  FreeParams out = free;
  out.viscosity_n_s_per_mm *= ratio;
  out.guide_n_per_mm *= ratio;
  return out;
}

}  // namespace trephine::haptics
