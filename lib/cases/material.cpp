// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/material.h"

namespace trephine::cases {
namespace {

constexpr double min_direction = 0.1;  ///< what is shorter is no direction that somebody meant
constexpr double deepest_mm = 30;  ///< a face that gives way only beyond this depth is taken for a mistake in the file

}  // namespace

std::string CaseFace::fault() const {
  if (!touchable) return "";
  if (stiffness_n_per_mm == 0) return "stiffness_n_per_mm: 0, must be more where the face is touchable";
  if (dynamic_friction_ratio > static_friction_ratio)
    return "dynamic_friction_ratio: " + to_text(ParameterValue(dynamic_friction_ratio)) +
           ", at most static_friction_ratio, " + to_text(ParameterValue(static_friction_ratio));
  if (pop_through_n > deepest_mm * stiffness_n_per_mm)
    return "pop_through_n: " + to_text(ParameterValue(pop_through_n)) + " N are met " +
           to_text(ParameterValue(pop_through_n / stiffness_n_per_mm)) + " mm deep, at most " +
           to_text(ParameterValue(deepest_mm)) + " mm";
  return "";
}

std::string MaterialParams::fault() const {
  if ((rest_ratio < 1) != (relaxation_s > 0))
    return std::string(relaxation_s > 0 ? "rest_ratio: is 1" : "relaxation_s: is 0") +
           ", so that nothing relaxes; give rest_ratio below 1 and relaxation_s above 0, or neither";
  const bool needs = front.across_grain_ratio != 1 || back.across_grain_ratio != 1;
  const double length = norm(grain_direction);
  if (!needs || length >= min_direction) return "";
  return "grain_direction: is " + to_text(ParameterValue(length)) + " long, at least " +
         to_text(ParameterValue(min_direction)) + " where across_grain_ratio is not 1";
}

}  // namespace trephine::cases
