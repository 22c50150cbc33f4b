// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/ventriculostomy/head_frame.h"

#include <algorithm>
#include <vector>

#include "base/error.h"

namespace trephine::lessons {
namespace {

constexpr double min_area_mm2 = 500;  // of the triangle: a narrower one says nothing of the plane

// The middle of the circle through three points.
Vec3 circle_centre(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 u = b - a, v = c - a, w = cross(u, v);
  return a + (cross(w, u) * dot(v, v) + cross(v, w) * dot(u, u)) / (2 * dot(w, w));
}

}  // namespace

const cases::CaseLandmark* find_landmark(const cases::CaseManifest& manifest, const std::string& name) {
  for (const cases::CaseLandmark& l : manifest.landmarks)
    if (l.name == name) return &l;
  return nullptr;
}

std::optional<Vec3> foramen_of(const cases::CaseManifest& manifest, bool left, double* confidence) {
  const std::string name = left ? "monro_left" : "monro_right";
  for (const cases::CaseTarget& t : manifest.targets)
    if (t.name == name) {
      if (confidence) *confidence = t.confidence;
      return t.position_mm;
    }
  if (const cases::CaseLandmark* l = find_landmark(manifest, name)) {
    if (confidence) *confidence = l->confidence;
    return l->position_mm;
  }
  return {};
}

HeadFrame head_frame_of(const cases::CaseManifest& manifest) {
  std::vector<const cases::CaseLandmark*> midline;
  for (const char* name : {"nasion", "bregma", "vertex", "inion"})
    if (const cases::CaseLandmark* l = find_landmark(manifest, name)) midline.push_back(l);
  const cases::CaseLandmark* nasion = find_landmark(manifest, "nasion");
  if (!nasion || midline.size() < 3)
    throw Error(ExitCode::bad_input, "", "landmarks",
                "the lesson needs a nasion and two more of bregma, vertex and inion, by which the midline is known");
  double best = 0, best_area = 0;
  const cases::CaseLandmark* three[3] = {};
  for (std::size_t a = 0; a < midline.size(); ++a)
    for (std::size_t b = a + 1; b < midline.size(); ++b)
      for (std::size_t c = b + 1; c < midline.size(); ++c) {
        const Vec3 at = midline[a]->position_mm;
        const double area = 0.5 * norm(cross(midline[b]->position_mm - at, midline[c]->position_mm - at));
        const double worth = area * std::min({midline[a]->confidence, midline[b]->confidence, midline[c]->confidence});
        if (!(worth > best)) continue;
        best = worth;
        best_area = area;
        three[0] = midline[a];
        three[1] = midline[b];
        three[2] = midline[c];
      }
  if (best_area < min_area_mm2)
    throw Error(ExitCode::bad_input, "", "landmarks", "those of the midline lie on a line, so it is not known");

  HeadFrame f;
  const Vec3 a = three[0]->position_mm, b = three[1]->position_mm, c = three[2]->position_mm;
  f.left = normalized(cross(b - a, c - a));
  if (f.left.x < 0) f.left = -f.left;
  f.plane_mm = dot(f.left, a);
  f.midline_confidence = std::min({three[0]->confidence, three[1]->confidence, three[2]->confidence});
  f.centre_mm = circle_centre(a, b, c);
  f.nasion_mm = nasion->position_mm;
  const cases::CaseLandmark* bregma = find_landmark(manifest, "bregma");
  const cases::CaseLandmark* top = bregma ? bregma : find_landmark(manifest, "vertex");
  if (bregma) {
    f.bregma_mm = bregma->position_mm;
    f.suture_confidence = std::min(bregma->confidence, nasion->confidence);
  }
  if (top) {
    f.upwards = normalized(top->position_mm - f.centre_mm);
    const Vec3 to_nasion = f.nasion_mm - f.centre_mm;
    f.forwards = normalized(to_nasion - f.upwards * dot(to_nasion, f.upwards));
  }
  return f;
}

}  // namespace trephine::lessons
