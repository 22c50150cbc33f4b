// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "base/text.h"
#include "face/deface.h"

namespace trephine::face {
namespace {

// How steeply the line from the tragi to the nasion ascends against the Frankfurt plane; measured heads lie around it.
constexpr double nasion_ascent_deg = 20;
// From small children to the largest adults.
constexpr double tragi_apart_mm[2] = {70, 220}, nasion_ahead_mm[2] = {45, 160}, nasion_off_midline_mm = 25;

const char* how_to_give =
    "; give it in the case's configuration: `landmarks: {nasion: [x, y, z], tragus_left: ..., tragus_right: ...}` (mm, "
    "LPS)";

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::privacy, "", "landmarks." + field, what);
}

Vec3 position_of(const head::HeadLandmarks& landmarks, const char* name, double min_confidence) {
  const cases::CaseLandmark* found = landmarks.find(name);
  if (!found) refuse(name, std::string("is missing: without it nobody knows where the face is") + how_to_give);
  if (!is_finite(found->position_mm)) refuse(name, "is not finite");
  if (!(found->confidence >= min_confidence))
    refuse(name, "found with a confidence of " + to_text(ParameterValue(std::floor(100 * found->confidence) / 100)) +
                     ", must be at least " + to_text(ParameterValue(min_confidence)) + " to say where the face is" +
                     how_to_give);
  return found->position_mm;
}

void check(const char* field, const char* what, double value_mm, const double (&range_mm)[2]) {
  if (!(value_mm >= range_mm[0] && value_mm <= range_mm[1]))
    refuse(field, std::string(what) + " " + to_text(ParameterValue(std::round(value_mm))) + " mm, must be from " +
                      to_text(ParameterValue(range_mm[0])) + " to " + to_text(ParameterValue(range_mm[1])) +
                      " mm in a head");
}

}  // namespace

FaceRegion face_region(const head::HeadLandmarks& landmarks, double min_confidence) {
  FaceRegion r;
  r.nasion_mm = position_of(landmarks, "nasion", min_confidence);
  const Vec3 left = position_of(landmarks, "tragus_left", min_confidence);
  const Vec3 right = position_of(landmarks, "tragus_right", min_confidence);
  check("tragus_left", "lies apart from the right one by", norm(left - right), tragi_apart_mm);
  r.tragi_mm = 0.5 * (left + right);
  r.left = normalized(left - right);
  const Vec3 to_nasion = r.nasion_mm - r.tragi_mm;
  const double off_mm = dot(to_nasion, r.left);
  check("nasion", "lies off the middle between the tragi by", std::abs(off_mm), {0, nasion_off_midline_mm});
  const Vec3 ahead = to_nasion - off_mm * r.left;
  check("nasion", "lies before the tragi by", norm(ahead), nasion_ahead_mm);
  // The nasion's direction in the plane perpendicular to `left`, and the direction perpendicular to it, upwards.
  const Vec3 v = normalized(ahead), w = cross(v, r.left);
  const double angle = nasion_ascent_deg * pi / 180;
  r.front = std::cos(angle) * v - std::sin(angle) * w;
  r.up = std::sin(angle) * v + std::cos(angle) * w;
  if (!(r.left.x > 0.3))
    refuse("tragus_left", "does not lie to the left of tragus_right (x grows to the patient's left)");
  if (!(r.up.z > 0.2)) refuse("nasion", "and the tragi give a head that is upside down (z grows to the head's top)");
  return r;
}

}  // namespace trephine::face
