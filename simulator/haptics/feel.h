// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <string>

#include "base/params.h"
#include "cases/case.h"
#include "contact/contact.h"
#include "touch/mesh_surfaces.h"

namespace trephine::haptics {

/// How every shape of a case feels, by its number, and after the shapes of its volume the surfaces that are touched
/// beside it (touch/mesh_surfaces.h). Shapes that the case does not name cannot be touched.
using ShapeFeel = cases::MaterialParams;
using Feels = std::array<ShapeFeel, touch::max_shape + 1>;

/// Where a transfer function has stiffnesses, its shape has the largest of them.
inline Feels feels_of(const cases::CaseHaptic& haptic) {
  Feels feels;
  for (ShapeFeel& f : feels) f.front.touchable = f.back.touchable = false;
  for (const cases::CaseShape& s : haptic.shapes) {
    if (s.number < 1 || s.number > voxel::haptic_max_shapes) continue;
    ShapeFeel& feel = feels[std::size_t(s.number)];
    feel = s.material;
    const double ramp = s.transfer ? voxel::stiffest_n_per_mm(*s.transfer) : 0;
    for (cases::CaseFace* face : {&feel.front, &feel.back})
      if (ramp > 0 && face->touchable) face->stiffness_n_per_mm = ramp;
  }
  return feels;
}

inline contact::TouchableFaces touchable_of(const Feels& feels) {
  contact::TouchableFaces faces{0, 0};
  for (std::size_t n = 1; n < feels.size(); ++n) {
    if (feels[n].front.touchable) faces.front |= std::uint64_t{1} << n;
    if (feels[n].back.touchable) faces.back |= std::uint64_t{1} << n;
  }
  return faces;
}

/// Limits on the force of the device, and how forces rise and fall.
struct ForceParams {
  enum class Shape { cosine, line, snap };
  double max_force_n = 3.3, max_force_rate_n_per_s = 0;
  double ramp_s = 0.5, velocity_cutoff_hz = 100;
  double max_torque_n_mm = 180, turn_stiffness_n_mm_per_rad = 200;
  double max_step_s = 1;
  double release_s = 0.02, event_s = 0.01;
  Shape event_shape = Shape::cosine;
  double force_rate_n_per_s() const {
    return max_force_rate_n_per_s > 0 ? max_force_rate_n_per_s : 1000 * std::max(1.0, max_force_n / 3.3);
  }
  template <class V>
  static void describe(V& v) {
    using P = ForceParams;
    v.number(&P::max_force_n, "max_force_n", Range{0.01, 100}, "Largest force that the device is asked for.");
    v.number(&P::max_force_rate_n_per_s, "max_force_rate_n_per_s", Range{0, 1e6},
             "Largest rate at which the force may change; 0: 1,000, of a device of more than 3.3 N its whole force in "
             "3.3 ms. Where a hand presses so that a wall asks for more, the force lags behind it, and it swings.");
    v.number(
        &P::ramp_s, "ramp_s", Range{0, 10},
        "Time over which forces rise to their full size after the start. A hand that is in a wall meanwhile is given "
        "the energy that the rise adds.");
    v.number(&P::velocity_cutoff_hz, "velocity_cutoff_hz", Range{0, 1e5},
             "Cutoff of the low-pass filter on the velocity for dampers and drag; 0: no filter.");
    v.number(&P::max_torque_n_mm, "max_torque_n_mm", Range{0, 1e5},
             "Largest torque that a device with torques is asked for; 0: none.");
    v.number(&P::turn_stiffness_n_mm_per_rad, "turn_stiffness_n_mm_per_rad", Range{0, 1e5},
             "Torque for each radian by which surfaces or a lock keep the tool from turning with the device.");
    v.number(&P::release_s, "release_s", Range{0, 0.1},
             "Longest time over which a force changes that would jump, as where bone gives way; 0: it jumps.");
    v.number(&P::event_s, "event_s", Range{0.005, 0.02},
             "Time that the pop of a membrane or the breach of bone takes under a drill.");
    v.choice(&P::event_shape, "event_shape", {{"cosine", Shape::cosine}, {"line", Shape::line}, {"snap", Shape::snap}},
             "How the force changes in that time; snap: at once most, then slowly.");
    v.number(&P::max_step_s, "max_step_s", Range{0.001, 3600},
             "A tick that stands for more time than this is a fault: the loop stood still, and the force stays zero.");
  }
};

/// The shaft of a tool, behind its tip, on which shaft friction acts and which holds it on a line.
struct ShaftParams {
  double shaft_length_mm = 0, shaft_rigidity_n_mm2 = 0;
  std::string line_lock_in;
  template <class V>
  static void describe(V& v) {
    v.number(&ShaftParams::shaft_length_mm, "shaft_length_mm", Range{0, 500},
             "Length of the shaft behind the tip, for friction; 0: the tool's length.");
    v.text(&ShaftParams::line_lock_in, "line_lock_in",
           "Shapes, such as skull,brain, that hold a tool whose tip has entered them: it keeps its orientation and "
           "moves along its own axis alone until it has left them.")
        .not_always();
    v.number(&ShaftParams::shaft_rigidity_n_mm2, "shaft_rigidity_n_mm2", Range{0, 1e6},
             "Bending stiffness E I of the shaft between the hand and the shape that holds it on a line; 0: rigid.")
        .not_always();
  }
};

}  // namespace trephine::haptics
