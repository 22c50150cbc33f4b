// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/material.h"

#include <cmath>

namespace trephine {
namespace {

constexpr double deepest_mm = 30;  ///< a face that gives way only beyond this depth is taken for a mistake in the file

/// The declared ranges, by the declarations themselves; comparisons that NaN fails.
template <class P>
std::string outside_range(const P& params) {
  for (const Parameter& p : parameters_of<P>().parameters) {
    const ParameterValue value = p.get(&params);
    const auto fault = [&](double v) {
      return v >= p.range.min && v <= p.range.max
                 ? std::string()
                 : p.name + ": " + to_text(ParameterValue(v)) + ", must be from " +
                       to_text(ParameterValue(p.range.min)) + " to " + to_text(ParameterValue(p.range.max));
    };
    std::string found;
    if (const double* one = std::get_if<double>(&value)) found = fault(*one);
    if (const auto* list = std::get_if<std::vector<double>>(&value))
      for (const double v : *list)
        if (found.empty()) found = fault(v);
    if (!found.empty()) return found;
  }
  return "";
}

std::string fault_of_face(const CaseFace& f) {
  if (const std::string fault = outside_range(face_params(f)); !fault.empty()) return fault;
  if (!f.touchable) return "";
  if (f.stiffness_n_per_mm == 0) return "stiffness_n_per_mm: 0, must be more where the face is touchable";
  if (f.dynamic_friction_ratio > f.static_friction_ratio)
    return "dynamic_friction_ratio: " + to_text(ParameterValue(f.dynamic_friction_ratio)) +
           ", at most static_friction_ratio, " + to_text(ParameterValue(f.static_friction_ratio));
  if (f.pop_through_n > deepest_mm * f.stiffness_n_per_mm)
    return "pop_through_n: " + to_text(ParameterValue(f.pop_through_n)) + " N are met " +
           to_text(ParameterValue(f.pop_through_n / f.stiffness_n_per_mm)) + " mm deep, at most " +
           to_text(ParameterValue(deepest_mm)) + " mm";
  return "";
}

}  // namespace

std::string fault_of(const CaseMaterial& m) {
  MaterialParams p;
  p.colour_rgb = m.colour_rgb;
  p.drag_n_s_per_mm = m.drag_n_s_per_mm;
  p.shaft_friction_n_per_mm = m.shaft_friction_n_per_mm;
  p.removal_energy_j_per_mm3 = m.removal_energy_j_per_mm3;
  if (const std::string fault = outside_range(p); !fault.empty()) return fault;
  if (const std::string fault = fault_of_face(m.front); !fault.empty()) return "front." + fault;
  if (const std::string fault = fault_of_face(m.back); !fault.empty()) return "back." + fault;
  return "";
}

}  // namespace trephine
