// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Heads of which the truth is known, and what is found in them.
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/parallel.h"
#include "findings/findings.h"
#include "mask/filters.h"
#include "phantom/head.h"
#include "phantom/phantom.h"

namespace trephine {

using findings::Finding, findings::FindingKind;

/// A head in voxels of 1.5 x 1.5 x 2 mm, with its true shapes as fields, and how much of it is blood.
struct Scene {
  grid::HuVolume volume;
  grid::Field skull, brain, ventricles;
  double blood_ml = 0;
  Vec3 blood_mm;
  std::vector<Finding> found;
  findings::FindingsResult result;
  Warnings warnings;
  grid::LabelFile labels;

  explicit Scene(const phantom::HardParams& hard, phantom::Variant variant = phantom::Variant::normal,
                 double slice_mm = 2, std::int64_t seed = 5,
                 const std::function<void(Scene&, const phantom::Head&)>& spoil = {}) {
    phantom::HeadParams who;
    who.level = phantom::Level::hard;
    who.seed = seed;
    who.variant = variant;
    who.hard = hard;
    who.hard.fillings_count = 0;
    const phantom::Head head(who);
    phantom::ScanParams how;
    how.columns_count = how.rows_count = 144;
    how.pixel_mm = 1.6;
    how.slices_count = int(176 / slice_mm);
    how.slice_step_mm = how.slice_thickness_mm = slice_mm;
    how.subvoxel_mm = 1.6;
    how.noise_hu = 8;
    volume = phantom::volume_of(phantom::scan(head, how));
    const grid::Lattice l = grid::lattice_of(volume);
    const auto field_of = [&](phantom::Anatomy a) {
      grid::Field f(l, -1.f);
      parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
        for (int j = 0; j < l.size[1]; ++j)
          for (int i = 0; i < l.size[0]; ++i)
            f.at(i, j, int(k)) = float(-head.implicit_mm(a, l.to_world_mm({double(i), double(j), double(k)})));
      });
      return f;
    };
    skull = field_of(phantom::Anatomy::skull);
    brain = field_of(phantom::Anatomy::brain);
    ventricles = field_of(phantom::Anatomy::ventricles);
    std::vector<double> ml(std::size_t(l.size[2]), 0);
    parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i)
          ml[std::size_t(k)] += head.thing(l.to_world_mm({double(i), double(j), double(k)})) == phantom::Thing::blood;
    });
    for (const double m : ml) blood_ml += m * l.voxel_volume_mm3() / 1000;
    for (const auto& [name, at] : head.things_mm())
      if (name == "blood") blood_mm = at;
    if (spoil) spoil(*this, head);
    findings::Findings all = findings::find_findings(volume, {&skull, &brain, &ventricles, nullptr}, {});
    result = all.result;
    warnings = all.warnings;
    found = all.result.list;
    labels = std::move(all.value);
  }

  /// Adds `hu` to the voxels of the brain in the box about a point.
  void brighten(Vec3 middle_mm, Vec3 half_mm, int hu) {
    auto& v = std::get<grid::Grid<std::int16_t>>(volume);
    for (int k = 0; k < v.size[2]; ++k)
      for (int j = 0; j < v.size[1]; ++j)
        for (int i = 0; i < v.size[0]; ++i) {
          const Vec3 d = v.to_world_mm({double(i), double(j), double(k)}) - middle_mm;
          if (brain.at(i, j, k) > 2 && std::abs(d.x) < half_mm.x && std::abs(d.y) < half_mm.y &&
              std::abs(d.z) < half_mm.z)
            v.at(i, j, k) = std::int16_t(v.at(i, j, k) + hu);
        }
  }

  std::vector<Finding> of(FindingKind kind) const {
    std::vector<Finding> some;
    for (const Finding& f : found)
      if (f.kind == kind) some.push_back(f);
    return some;
  }
  static double figure(const Finding& f, const std::string& name) {
    for (const auto& [n, value] : f.figures)
      if (n == name)
        return std::holds_alternative<double>(value) ? std::get<double>(value) : double(std::get<std::int64_t>(value));
    return -1;
  }
};

}  // namespace trephine
