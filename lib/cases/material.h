// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>

#include "base/params.h"
#include "cases/case.h"

namespace trephine {

/// What configs/materials.yaml says of a material, declared once. A CaseMaterial is its form in a case.

struct MaterialFaceParams {
  bool touchable = true;
  double stiffness_n_per_mm = 0, damping_n_s_per_mm = 0;
  double static_friction_ratio = 0, dynamic_friction_ratio = 0;
  double pop_through_n = 0;
  template <class V>
  static void describe(V& v) {
    using P = MaterialFaceParams;
    v.flag(&P::touchable, "touchable", "Whether this side is felt at all.");
    v.number(&P::stiffness_n_per_mm, "stiffness_n_per_mm", Range{0, 10},
             "Stiffness of the spring between tool and surface.");
    v.number(&P::damping_n_s_per_mm, "damping_n_s_per_mm", Range{0, 0.1}, "Damping beside the spring.");
    v.number(&P::static_friction_ratio, "static_friction_ratio", Range{0, 5},
             "Ratio of tangential to normal force up to which the tool sticks; at least the dynamic one.");
    v.number(&P::dynamic_friction_ratio, "dynamic_friction_ratio", Range{0, 5},
             "Ratio of tangential to normal force of a sliding tool.");
    v.number(&P::pop_through_n, "pop_through_n", Range{0, 100}, "Force above which the tool enters; 0: never.");
  }
};

struct MaterialParams {
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double drag_n_s_per_mm = 0, shaft_friction_n_per_mm = 0, removal_energy_j_per_mm3 = 0;
  template <class V>
  static void describe(V& v) {
    using P = MaterialParams;
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1}, "Colour (sRGB) of what is displayed from the haptic volume.");
    v.number(&P::drag_n_s_per_mm, "drag_n_s_per_mm", Range{0, 1}, "Drag on a tip that has entered.");
    v.number(&P::shaft_friction_n_per_mm, "shaft_friction_n_per_mm", Range{0, 1},
             "Friction on the shaft, for each mm of it inside.");
    v.number(&P::removal_energy_j_per_mm3, "removal_energy_j_per_mm3", Range{0, 10},
             "Energy that a drill spends on a mm^3; 0: it cannot be drilled.");
  }
};

inline CaseFace make_face(const MaterialFaceParams& p) {
  return {p.touchable,    p.stiffness_n_per_mm, p.damping_n_s_per_mm, p.static_friction_ratio, p.dynamic_friction_ratio,
          p.pop_through_n};
}

inline MaterialFaceParams face_params(const CaseFace& f) {
  return {f.touchable,    f.stiffness_n_per_mm, f.damping_n_s_per_mm, f.static_friction_ratio, f.dynamic_friction_ratio,
          f.pop_through_n};
}

inline CaseMaterial make_material(const std::string& name, const MaterialParams& p, const MaterialFaceParams& front,
                                  const MaterialFaceParams& back) {
  CaseMaterial m;
  m.name = name;
  m.colour_rgb = p.colour_rgb;
  m.front = make_face(front);
  m.back = make_face(back);
  m.drag_n_s_per_mm = p.drag_n_s_per_mm;
  m.shaft_friction_n_per_mm = p.shaft_friction_n_per_mm;
  m.removal_energy_j_per_mm3 = p.removal_energy_j_per_mm3;
  return m;
}

/// What is wrong with a material, naming the value, or "". Every number must be finite and in its declared range, no
/// face may have more dynamic than static friction, a face that is felt must have a stiffness, and one that gives way
/// must do so within 30 mm of the surface. A face that is not felt need not set more.
std::string fault_of(const CaseMaterial& material);

}  // namespace trephine
