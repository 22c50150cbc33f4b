// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/scan_facts.h"

#include "lessons/scan_way.h"

namespace trephine::lessons {
namespace {

constexpr double sure = 0.5;

// Which shape holds the point, as a tool's tip would say it.
int shape_at(const voxel::HapticDecoder& decoder, const HeadShapes& shapes, Vec3 p) {
  for (const int number : {shapes.ventricles, shapes.bone, shapes.brain, shapes.skin})
    if (number != 0 && decoder.trilinear(number, p) >= 0.5) return number;
  return 0;
}

std::optional<CatheterPass> pass_of(const lesson::OutcomeCourse& course, const voxel::HapticDecoder& decoder,
                                    const HeadShapes& shapes) {
  CatheterPass pass;
  for (const Vec3& p : way_inwards(course.course, course.tip_mm)) {
    const int inside = shape_at(decoder, shapes, p);
    const bool in_brain = inside == shapes.brain || inside == shapes.ventricles;
    if (pass.path.empty() && !in_brain) continue;
    if (pass.path.empty()) pass.entry_mm = p;
    pass.path.push_back({0, p, inside});
  }
  if (pass.path.size() < 2) return {};
  pass.out = -course.axis;
  pass.in_place = true;
  return pass;
}

}  // namespace

std::shared_ptr<LessonFacts> facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                           const std::string&) {
  auto facts = std::make_shared<VentriculostomyFacts>();
  facts->from_scan = true;
  facts->end = LessonEnd::finished;
  facts->seen = record.catheter;
  facts->drilled_beforehand = !loaded.manifest.burr_holes.empty();
  const HeadShapes shapes = head_shapes_of(loaded.manifest);
  const voxel::HapticDecoder decoder(loaded.haptic);
  if (record.catheter == lesson::Sighting::found && !record.courses.empty()) {
    if (const auto pass = pass_of(record.courses.front(), decoder, shapes))
      facts->passes.push_back(*pass);
    else
      facts->seen = lesson::Sighting::doubtful;  // it lies in no brain of this case
  }
  if (facts->drilled_beforehand) {
    if (!facts->passes.empty()) facts->hole = find_case_hole(loaded.manifest, facts->passes.front().entry_mm);
    return facts;
  }
  if (record.hole != lesson::Sighting::found) return facts;
  for (const lesson::OutcomeHole& h : record.holes) {
    if (h.confidence < sure) continue;
    BoneHole hole;
    hole.outer_mm = h.outer_mm, hole.inner_mm = h.inner_mm, hole.out = h.out;
    hole.radius_mm = h.diameter_mm / 2;
    hole.removed_mm3 = h.area_mm2 * h.bone_mm;
    hole.drilled = hole.through = true;
    facts->holes.push_back(hole);
  }
  // Of several the one that the catheter goes through; else the largest, which comes first.
  for (const BoneHole& hole : facts->holes) {
    const auto off = [&](const BoneHole& h) {
      const Vec3 d = facts->passes.front().entry_mm - h.outer_mm;
      return norm(d - h.out * dot(d, h.out));
    };
    if (!facts->hole || (!facts->passes.empty() && off(hole) < off(*facts->hole))) facts->hole = hole;
  }
  return facts;
}

std::shared_ptr<LessonFacts> facts_of_drilled(const cases::LoadedCase& loaded, const voxel::HapticVolume& now) {
  auto facts = std::make_shared<VentriculostomyFacts>();
  facts->from_scan = facts->from_volume = true;
  facts->end = LessonEnd::finished;
  facts->drilled_beforehand = !loaded.manifest.burr_holes.empty();
  const Vec3 centre = head_frame_of(loaded.manifest).centre_mm;
  HoleSearch search;
  search.bone = head_shapes_of(loaded.manifest).bone;
  // Their middles first, which say along which line each was drilled.
  for (const BoneHole& hole : find_drilled_holes(loaded.haptic, now, search)) {
    const Vec3 middle = (hole.outer_mm + hole.inner_mm) / 2;
    search.sites.push_back({middle, middle - centre});
  }
  for (const BoneHole& hole : find_drilled_holes(loaded.haptic, now, search))
    if (hole.removed_mm3 >= scratch_mm3) facts->holes.push_back(hole);
  if (!facts->holes.empty()) facts->hole = facts->holes.front();
  return facts;
}

}  // namespace trephine::lessons
