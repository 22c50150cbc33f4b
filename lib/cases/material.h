// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <string_view>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::cases {

/// What the materials of a haptic volume are made of, each value declared once: here. From these lines come
/// configs/materials.yaml and its schema, case.json, its schema and its reference page, what `trephine diff` and
/// `trephine-sim check` say, and the digest by which a recording knows its case's materials. A value that no hand feels
/// also stands in `not_felt`.

/// How one side of a shape's surface acts on the tool. A front face is met from outside, a back face from inside.
struct CaseFace {
  bool touchable = true;
  double stiffness_n_per_mm = 0, damping_n_s_per_mm = 0;
  double static_friction_ratio = 0, dynamic_friction_ratio = 0;
  double pop_through_n = 0, across_grain_ratio = 1;
  template <class V>
  static void describe(V& v) {
    using P = CaseFace;
    v.flag(&P::touchable, "touchable", "Whether this side is felt at all.");
    v.number(&P::stiffness_n_per_mm, "stiffness_n_per_mm", Range{0, 10},
             "Stiffness of the spring between tool and surface.");
    v.number(&P::damping_n_s_per_mm, "damping_n_s_per_mm", Range{0, 0.1}, "Damping beside the spring.");
    v.number(&P::static_friction_ratio, "static_friction_ratio", Range{0, 5},
             "Ratio of tangential to normal force up to which the tool sticks; at least the dynamic one.");
    v.number(&P::dynamic_friction_ratio, "dynamic_friction_ratio", Range{0, 5},
             "Ratio of tangential to normal force of a sliding tool.");
    v.number(&P::pop_through_n, "pop_through_n", Range{0, 100}, "Force above which the tool enters; 0: never.");
    v.number(&P::across_grain_ratio, "across_grain_ratio", Range{0.1, 10},
             "Friction across the material's grain, as a share of that along it, which the two ratios say.")
        .not_always();
  }
  /// No face may have more dynamic than static friction, one that is felt must have a stiffness, and one that gives way
  /// must do so within 30 mm of the surface. A face that is not felt need not set more.
  std::string fault() const;
};

struct MaterialParams {
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  CaseFace front, back;
  double drag_n_s_per_mm = 0, shaft_friction_n_per_mm = 0, removal_energy_j_per_mm3 = 0;
  double rest_ratio = 1, relaxation_s = 0, tip_force_n = 0;
  Vec3 grain_direction{};
  /// The values that no hand feels: what is seen, and what a drill makes of it, which a recording's outcome tells.
  static constexpr std::string_view not_felt[] = {"colour_rgb", "removal_energy_j_per_mm3"};
  template <class V>
  static void describe(V& v) {
    using P = MaterialParams;
    v.numbers(&P::colour_rgb, "colour_rgb", Range{0, 1}, "Colour (sRGB) of what is displayed from the haptic volume.");
    v.group(&P::front, "front", "The face that a tool meets from outside.").is_required();
    v.group(&P::back, "back", "The face that a tool meets from inside.").is_required();
    v.number(&P::drag_n_s_per_mm, "drag_n_s_per_mm", Range{0, 1}, "Drag on a tip that has entered.");
    v.number(&P::shaft_friction_n_per_mm, "shaft_friction_n_per_mm", Range{0, 1},
             "Friction on the shaft, for each mm of it inside.");
    v.number(&P::rest_ratio, "rest_ratio", Range{0.01, 1},
             "What remains of the springs' force on a deformation that is held; 1: all of it, they do not relax.")
        .not_always();
    v.number(&P::relaxation_s, "relaxation_s", Range{0, 100},
             "Time in which the rest of it decreases by a factor of e, as in a standard linear solid; 0: they do not "
             "relax.")
        .not_always();
    v.number(&P::tip_force_n, "tip_force_n", Range{0, 20},
             "Force with which a tip that has entered cuts its way on, apart from drag and friction.")
        .not_always();
    v.number(&P::removal_energy_j_per_mm3, "removal_energy_j_per_mm3", Range{0, 10},
             "Energy that a drill spends on a mm^3; 0: it cannot be drilled.");
    v.numbers(&P::grain_direction, "grain_direction", Range{-1, 1},
              "Along which its fibres run, in the patient (LPS); only the direction counts. [0, 0, 0]: none.")
        .not_always();
  }
  /// A face whose friction depends on the direction needs one, of a length of 0.1 or more.
  std::string fault() const;
};

struct CaseMaterial : MaterialParams {
  std::string name;
  template <class V>
  static void describe(V& v) {
    v.text(&CaseMaterial::name, "name", "Name of the material.").of_form(some_text);
    v.template all_of<MaterialParams>();
  }
};

}  // namespace trephine::cases
