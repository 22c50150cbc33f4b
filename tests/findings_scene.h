// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Heads of which the truth is known, and what is found in them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "base/parallel.h"
#include "findings/findings.h"
#include "json/declared_json.h"
#include "mask/filters.h"
#include "phantom/head.h"
#include "phantom/phantom.h"

namespace trephine {

using findings::Finding, findings::FindingKind;

/// A head in voxels of 1.6 x 1.6 x 2 mm, with its true shapes as fields, and how much of it is blood.
struct Truth {
  phantom::Head head;
  grid::HuVolume volume;
  grid::Field skull, brain, ventricles;
  double blood_ml = 0;
  Vec3 blood_mm;
};

inline Truth made(const phantom::HeadParams& who, double slice_mm) {
  phantom::ScanParams how;
  how.columns_count = how.rows_count = 144;
  how.pixel_mm = 1.6;
  how.slices_count = int(176 / slice_mm);
  how.slice_step_mm = how.slice_thickness_mm = slice_mm;
  how.subvoxel_mm = 1.6;
  how.noise_hu = 8;
  Truth t{phantom::Head(who), {}, {}, {}, {}, 0, {}};
  t.volume = phantom::volume_of(phantom::scan(t.head, how));
  const grid::Lattice l = grid::lattice_of(t.volume);
  const auto field_of = [&](phantom::Anatomy a) {
    grid::Field f(l, -1.f);
    parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i)
          f.at(i, j, int(k)) = float(-t.head.implicit_mm(a, l.to_world_mm({double(i), double(j), double(k)})));
    });
    return f;
  };
  t.skull = field_of(phantom::Anatomy::skull);
  t.brain = field_of(phantom::Anatomy::brain);
  t.ventricles = field_of(phantom::Anatomy::ventricles);
  std::vector<double> ml(std::size_t(l.size[2]), 0);
  parallel_for(0, l.size[2], 1, [&](std::int64_t k, std::int64_t) {
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        ml[std::size_t(k)] += t.head.thing(l.to_world_mm({double(i), double(j), double(k)})) == phantom::Thing::blood;
  });
  for (const double m : ml) t.blood_ml += m * l.voxel_volume_mm3() / 1000;
  for (const auto& [name, at] : t.head.things_mm())
    if (name == "blood") t.blood_mm = at;
  return t;
}

/// Most tests begin with the same healthy head, which is made once in a process.
inline const Truth& truth(const phantom::HeadParams& who, double slice_mm) {
  static std::map<std::string, Truth> made_before;
  const std::string key = json::json_of_value(who.hard) + " " + std::to_string(who.seed) + " " +
                          std::to_string(int(who.variant)) + " " + std::to_string(slice_mm);
  const auto found = made_before.find(key);
  return found != made_before.end() ? found->second : made_before.emplace(key, made(who, slice_mm)).first->second;
}

/// Such a head, spoilt or not, and what is found in it.
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
    const Truth& t = truth(who, slice_mm);
    volume = t.volume, skull = t.skull, brain = t.brain, ventricles = t.ventricles;
    blood_ml = t.blood_ml, blood_mm = t.blood_mm;
    if (spoil) spoil(*this, t.head);
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
