// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <variant>

#include "base/params.h"
#include "itk/transform.h"

namespace trephine::phantom {

/// What truth.json says: a point; a matrix's rows, each with its offset; and the values of parameters, of those that
/// came later where they are not at their defaults.
inline nlohmann::ordered_json json_of(Vec3 v) { return {v.x, v.y, v.z}; }
inline nlohmann::ordered_json json_of(const itk::LinearMap& m) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int a = 0; a < 3; ++a)
    rows.push_back({m.matrix.column[0][a], m.matrix.column[1][a], m.matrix.column[2][a], m.offset_mm[a]});
  return rows;
}
template <class P>
nlohmann::ordered_json json_of_params(const P& params) {
  nlohmann::ordered_json out;
  const P fresh;
  for (const Parameter& p : parameters_of<P>().parameters) {
    const auto value = p.get(&params);
    if (p.came_later && value == p.get(&fresh)) continue;
    if (const double* number = std::get_if<double>(&value))
      out[p.name] = *number;
    else
      out[p.name] = to_text(value);
  }
  return out;
}

}  // namespace trephine::phantom
