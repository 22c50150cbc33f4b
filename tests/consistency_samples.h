// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/parallel.h"
#include "head/head_figures.h"
#include "head/head_landmarks.h"
#include "phantom/head.h"

namespace trephine {

/// The phantom's anatomies as fields, from its analytic functions.
struct TrueHead {
  grid::Field skin, skull, brain, ventricles;
  head::HeadLandmarks landmarks;
  head::HeadFields fields() const { return {&skin, &skull, &brain, &ventricles}; }
};

inline grid::Lattice head_lattice(double step_mm) {
  grid::Lattice l;
  l.spacing_mm = {step_mm, step_mm, step_mm};
  l.origin_mm = {-110, -130, -60};
  l.size = {int(220 / step_mm), int(250 / step_mm), int(190 / step_mm)};
  return l;
}

inline grid::Field field_of(const grid::Lattice& l, const std::function<double(Vec3)>& inside_mm) {
  grid::Field f(l);
  parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const float v = float(std::clamp(inside_mm(l.to_world_mm({double(i), double(j), double(k)})), -20.0, 20.0));
        f.at(i, j, int(k)) = v == 0 ? -1e-3f : v;
      }
  });
  return f;
}

inline head::HeadLandmarks true_landmarks(const phantom::Head& head) {
  head::HeadLandmarks out;
  out.midsagittal.confidence = 1;  // the plane x = 0
  for (const auto& [name, at] : head.landmarks()) out.landmarks.push_back({name, at, 1, "truth"});
  return out;
}

inline TrueHead true_head(const phantom::HeadParams& params, double step_mm) {
  using phantom::Anatomy;
  const phantom::Head head(params);
  const auto field = [&](Anatomy a) {
    return field_of(head_lattice(step_mm), [&](Vec3 p) { return -head.implicit_mm(a, p); });
  };
  return {field(Anatomy::skin), field(Anatomy::skull), field(Anatomy::brain), field(Anatomy::ventricles),
          true_landmarks(head)};
}

}  // namespace trephine
