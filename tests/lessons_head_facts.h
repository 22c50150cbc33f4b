// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What happens in a perfect ventriculostomy of the phantom head, to be spoilt as a test likes.
#include "lessons_head.h"
#include "lessons_monotone.h"

namespace lesson_cases {

inline Head& phantom_head() {
  static Head one(Kind::whole, 1, true);
  return one;
}

// By how much the line misses the foramen there, and how much too deep the tip lies along it.
struct HeadAim {
  Vec3 off_mm;
  double beyond_mm = 0;
};

inline lessons::VentriculostomyFacts perfect_head(bool left) {
  lessons::VentriculostomyFacts f;
  f.task = left ? "left" : "right";
  f.end = lessons::LessonEnd::finished;
  f.end_s = 120;
  lessons::MarkerTrace midline, suture;
  midline.length_mm = 110, suture.length_mm = 40;
  for (int n = 0; n <= 110; ++n) midline.points_mm.push_back(towards(nasion_deg + deg_of(n), 0) * skin_mm);
  for (int n = -20; n <= 20; ++n) suture.points_mm.push_back(towards(nasion_deg + deg_of(125), deg_of(n)) * skin_mm);
  f.traces = {midline, suture};
  f.incisions.emplace_back();
  f.drill_begin_s = 20, f.drill_s = 15, f.through_s = 40;
  lessons::BoneHole hole;
  hole.out = normalized(kocher(left));
  hole.outer_mm = hole.out * outer_mm;
  hole.inner_mm = hole.out * inner_mm;
  hole.removed_mm3 = 800;
  hole.drilled = hole.through = true;
  f.hole = hole;
  f.dura.emplace();
  return f;
}

// A pass through the hole to that foramen. A line that misses it is of the same depth below the inner table, so that
// what spoils the direction spoils no depth.
inline void pass_to(lessons::VentriculostomyFacts& f, const cases::CaseManifest& manifest,
                    const voxel::HapticVolume& volume, Vec3 foramen_mm, const HeadAim& aim) {
  const lessons::BoneHole& hole = *f.hole;
  const auto along = [&](Vec3 from, Vec3 to) {  // towards `to`, where it meets the inner table
    const Vec3 way = normalized(to - from);
    return from + way * (dot(from - hole.inner_mm, hole.out) / -dot(way, hole.out));
  };
  const Vec3 way = normalized(foramen_mm + aim.off_mm - hole.outer_mm);
  const double depth_mm = norm(foramen_mm - along(hole.outer_mm, foramen_mm));
  const Vec3 end = aim.off_mm == Vec3{} ? foramen_mm : along(hole.outer_mm, hole.outer_mm + way) + way * depth_mm;
  const lessons::HeadShapes shapes = lessons::head_shapes_of(manifest);
  lessons::CatheterPass pass;
  pass.out = -way;
  double time_s = 60;
  walk<lessons::PassPoint>(volume, f.hole->outer_mm, end + way * (aim.beyond_mm - 1), [&](Vec3 at, int inside) {
    time_s += 0.01;
    if (pass.path.empty() && inside != shapes.brain && inside != shapes.ventricles) return;
    if (pass.path.empty()) pass.begin_s = time_s, pass.entry_mm = at;
    if (inside == shapes.ventricles && pass.csf_s < 0) pass.csf_s = time_s;
    pass.path.push_back({time_s, at, inside});
    pass.end_s = time_s;
  });
  if (pass.path.empty()) return;
  pass.in_place = true;
  f.passes.push_back(pass);
}

inline void pass_into(lessons::VentriculostomyFacts& f, bool left, const HeadAim& aim) {
  pass_to(f, phantom_head().felt().loaded.manifest, phantom_head().whole(),
          Vec3{left ? -foramen.x : foramen.x, foramen.y, foramen.z}, aim);
}

}  // namespace lesson_cases
