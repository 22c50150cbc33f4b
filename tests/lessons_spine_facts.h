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
inline const lessons::CasePedicle& pedicle_named(const std::string& name) {
  static const std::vector<lessons::CasePedicle> all = lessons::pedicles_of(phantom_spine().felt().loaded.manifest);
  for (const lessons::CasePedicle& p : all)
    if (p.name == name) return p;
  throw std::runtime_error(name);
}

inline void pass_along(const std::string& name, const SpineAim& aim, lessons::SpineNeedleFacts& facts) {
  const lessons::CasePedicle& p = pedicle_named(name);
  const Vec3 f = p.forwards(), up = normalized(Vec3{0, 0, 1} - f * f.z);
  const double side = name.find("_left") != std::string::npos ? 1 : -1;
  const Vec3 outer = normalized(Vec3{side, 0, 0} - f * (side * f.x));
  const Vec3 entry = p.entry_mm + outer * aim.aside_mm + up * aim.up_mm;
  const Vec3 target = p.target_mm + outer * (aim.aside_mm + aim.turn_aside_mm) + up * (aim.up_mm + aim.turn_up_mm);
  const Vec3 way = normalized(target - entry);
  const int bone = lessons::spine_bone_of(phantom_spine().felt().loaded.manifest);
  lessons::NeedlePass pass;
  pass.tool = aim.tool;
  pass.diameter_mm = aim.diameter_mm;
  pass.length_mm = aim.length_mm;
  pass.axis = -way;
  double time_s = 5;
  walk<lessons::NeedlePoint>(phantom_spine().whole(), entry - way * 60, target + way * aim.beyond_mm,
                             [&](Vec3 at, int inside) {
                               time_s += 0.01;
                               if (pass.path.empty() && inside != bone) return;
                               if (pass.path.empty()) pass.begin_s = time_s, pass.entry_mm = at;
                               pass.path.push_back({time_s, at, -way, inside});
                               pass.end_s = time_s;
                             });
  if (pass.path.empty()) return;
  pass.in_place = true;
  facts.passes.push_back(pass);
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
