// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What happens in a perfect lesson in the phantom spine, to be spoilt as a test likes.
#include "lessons_monotone.h"
#include "lessons_spine_run.h"

namespace lesson_cases {

struct SpineAim {
  double aside_mm = 0, up_mm = 0, turn_aside_mm = 0, turn_up_mm = 0, beyond_mm = 0;
  std::string tool = "needle";
  double diameter_mm = 3, length_mm = 150;
};

inline SpineCase& phantom_spine() {
  static SpineCase one;
  return one;
}
/// The spine in which it happens: the phantom's, or for a while a case of a library.
struct SpineInUse {
  const cases::CaseManifest* manifest;
  const voxel::HapticVolume* volume;
};
inline SpineInUse& spine_in_use() {
  static SpineInUse one{&phantom_spine().felt().loaded.manifest, &phantom_spine().whole()};
  return one;
}
inline lessons::CasePedicle pedicle_named(const std::string& name) {
  for (const lessons::CasePedicle& p : lessons::pedicles_of(*spine_in_use().manifest))
    if (p.name == name) return p;
  throw std::runtime_error(name);
}

inline void pass_along(const std::string& name, const SpineAim& aim, lessons::SpineNeedleFacts& facts) {
  const lessons::CasePedicle p = pedicle_named(name);
  const Vec3 up = p.up(), outer = p.outer();
  const Vec3 entry = p.entry_mm + outer * aim.aside_mm + up * aim.up_mm;
  const Vec3 target = p.target_mm + outer * (aim.aside_mm + aim.turn_aside_mm) + up * (aim.up_mm + aim.turn_up_mm);
  const Vec3 way = normalized(target - entry);
  const int bone = lessons::spine_bone_of(*spine_in_use().manifest);
  lessons::NeedlePass pass, puncture;
  pass.tool = aim.tool;
  pass.diameter_mm = aim.diameter_mm;
  pass.length_mm = aim.length_mm;
  pass.axis = -way;
  double time_s = facts.passes.empty() ? 5 : facts.passes.back().end_s + 5;
  walk<lessons::NeedlePoint>(*spine_in_use().volume, entry - way * 60, target + way * aim.beyond_mm,
                             [&](Vec3 at, int inside) {
                               time_s += 0.01;
                               if (puncture.path.empty() && inside != 0)
                                 puncture.begin_s = time_s, puncture.entry_mm = at;
                               if (inside != 0 || !puncture.path.empty())
                                 puncture.path.push_back({time_s, at, -way, inside}), puncture.end_s = time_s;
                               if (pass.path.empty() && inside != bone) return;
                               if (pass.path.empty()) pass.begin_s = time_s, pass.entry_mm = at;
                               pass.path.push_back({time_s, at, -way, inside});
                               pass.end_s = time_s;
                             });
  puncture.tool = aim.tool;
  puncture.axis = -way;
  if (!puncture.path.empty()) facts.punctures.push_back(puncture);
  if (pass.path.empty()) return;
  pass.in_place = true;
  facts.passes.push_back(pass);
}

// Of a screw the finder went before, by the same line, and was looked at.
inline void finder_along(const std::string& name, SpineAim aim, lessons::SpineNeedleFacts& facts) {
  if (aim.tool.rfind("screw", 0) != 0) return;
  aim.tool = "finder";
  aim.diameter_mm = 4;
  pass_along(name, aim, facts);
  if (facts.passes.empty()) return;
  facts.passes.back().in_place = false;
  facts.shots[1].begin_s = facts.shots[1].end_s = facts.passes.back().end_s;
  facts.shots[1].end_s += 0.5;
}

inline lessons::SpineNeedleFacts spine_facts(const std::string& task) {
  lessons::SpineNeedleFacts f;
  f.task = task;
  f.end = lessons::LessonEnd::finished;
  f.end_s = 60;
  f.shots.resize(4);
  for (lessons::FluoroShot& s : f.shots) s.begin_s = 1, s.end_s = 1.5;
  return f;
}

}  // namespace lesson_cases
