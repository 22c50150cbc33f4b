// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/parallel.h"
#include "consistency/anatomy_gate.h"
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

inline grid::Lattice raster(Vec3 spacing, double half_mm) {
  grid::Lattice l;
  l.spacing_mm = spacing;
  l.origin_mm = {-half_mm, -half_mm, -half_mm};
  for (int a = 0; a < 3; ++a) l.size[a] = int(2 * half_mm / spacing[a]) + 1;
  return l;
}

/// A head of ellipsoids that is right.
struct EllipsoidHead {
  grid::Lattice l = raster({1.8, 1.8, 2.2}, 90);
  Vec3 ventricles_at{0, 0, 5}, brain_at, skull_at;
  double slit_mm = 0;
  grid::Field skin, skull, brain, ventricles;
  void make() {
    const auto ellipsoid = [](Vec3 p, Vec3 r) {
      return (1 - norm({p.x / r.x, p.y / r.y, p.z / r.z})) * std::min({r.x, r.y, r.z});
    };
    skin = field_of(l, [&](Vec3 p) { return ellipsoid(p, {82, 86, 84}); });
    skull = field_of(l, [&](Vec3 p) {
      const Vec3 q = p - skull_at;
      return std::min(ellipsoid(q, {75, 79, 77}), -ellipsoid(q, {68, 72, 70}));
    });
    brain = field_of(l, [&](Vec3 p) {
      const Vec3 q = p - brain_at;
      return std::min(ellipsoid(q, {65, 69, 67}), std::abs(q.x - 30) - slit_mm / 2);
    });
    ventricles = field_of(l, [&](Vec3 p) { return ellipsoid(p - ventricles_at, {17, 40, 12}); });
  }
  head::HeadFields fields() const { return {&skin, &skull, &brain, &ventricles}; }
  consistency::AnatomyFindings examine() const {
    return consistency::examine_anatomy(fields(), nullptr, consistency::AnatomyGateParams());
  }
};

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
