// SPDX-License-Identifier: GPL-3.0-or-later
// What a scan allows to be sure of: how far apart its slices are, its noise, where it ends, and what lies on the skin.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/joined.h"
#include "head/landmarks_parts.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double tolerance_mm = 5;  ///< how far a reader's own points of one landmark lie apart
/// The contrast by which a landmark is seen: skin against air, bone against what lies beside it, fluid against brain.
constexpr double skin_hu = 500, suture_hu = 250, fluid_hu = 20;
constexpr double worth_telling = 0.85, of_no_account = 0.97;
constexpr double beside_mm = 12, apart_mm = 3;  ///< where and how densely the skin about a point is looked at
constexpr double above_skin_mm = 9;
constexpr double of_a_doubtful_level = 0.5;
constexpr float apparatus_hu = -700, air_hu = -900;

double share_of(double error, double tolerance) { return 1 / (1 + error * error / (tolerance * tolerance)); }

double allowed_by_slices(const mask::ScanFigures& scan) { return share_of(scan.slice_step_mm / 2, tolerance_mm); }

double allowed_by_noise(const std::string& name, const mask::ScanFigures& scan) {
  if (!scan.known()) return 1;
  if (name.rfind("monro", 0) == 0) return share_of(scan.cube_noise_hu, fluid_hu);
  return share_of(scan.noise_hu, name == "bregma" ? suture_hu : skin_hu);
}

/// The value of the voxel at the point; air outside.
float hu_near(const mask::HuView& hu, Vec3 world_mm) {
  const Vec3 p = hu.lattice().to_index(world_mm);
  const int i = int(std::lround(p.x)), j = int(std::lround(p.y)), k = int(std::lround(p.z));
  return hu.lattice().contains(i, j, k) ? hu(i, j, k) : -1000.f;
}

}  // namespace

double allowed_by_scan(const std::string& name, const mask::ScanFigures& scan) {
  return allowed_by_slices(scan) * allowed_by_noise(name, scan);
}

void hold_to_scan(HeadLandmarks& all, const std::set<std::string>& given, const mask::ScanFigures& scan,
                  Reasons& reasons) {
  for (cases::CaseLandmark& l : all.landmarks) {
    if (given.count(l.name) || l.source == "estimated") continue;
    const double by_slices = allowed_by_slices(scan), by_noise = allowed_by_noise(l.name, scan);
    if (by_slices * by_noise > worth_telling) {
      l.confidence *= by_slices * by_noise;
      continue;
    }
    std::vector<std::string> causes;
    if (by_slices < of_no_account) causes.push_back(fmt::format("slices of {:.1f} mm", scan.slice_step_mm));
    if (by_noise < of_no_account) causes.push_back(fmt::format("noise of {:.0f} HU", scan.noise_hu));
    lower_confidence(l, by_slices * by_noise, joined(causes, " and ") + " show it no better", reasons);
  }
}

void hold_to_motion(HeadLandmarks& all, const std::set<std::string>& given, const std::optional<mask::Motion>& motion,
                    const grid::Lattice& slices, Reasons& reasons) {
  const cases::CaseLandmark* nasion = motion ? all.find("nasion") : nullptr;
  for (cases::CaseLandmark& l : all.landmarks)
    if (nasion && l.name.rfind("kocher", 0) == 0 && !given.count(l.name) &&
        mask::lies_between(*motion, slices, l.position_mm, nasion->position_mm, tolerance_mm))
      lower_confidence(l, share_of(norm(motion->by_mm), tolerance_mm),
                       fmt::format("the head moved by {:.1f} mm at or between the slices of it and of the nasion",
                                   norm(motion->by_mm)),
                       reasons);
}

void hold_to_bregma(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  const cases::CaseLandmark* bregma = all.find("bregma");
  const double most = !bregma ? 0.45 : given.count("bregma") ? 1 : bregma->confidence;
  for (cases::CaseLandmark& l : all.landmarks)
    if (l.name.rfind("kocher", 0) == 0 && !given.count(l.name) && l.confidence > most)
      lower_confidence(
          l, most / l.confidence,
          bregma ? "the bregma, which it lies before, is no surer" : "the bregma, which it lies before, is not known",
          reasons);
}

void hold_to_level(HeadLandmarks& all, const std::set<std::string>& given, Reasons& reasons) {
  const auto is_sure = [&](const char* name) {
    const cases::CaseLandmark* l = all.find(name);
    return l && (given.count(name) || l->confidence >= doubtful_confidence);
  };
  if (is_sure("nasion") && (is_sure("tragus_left") || is_sure("tragus_right"))) return;
  for (cases::CaseLandmark& l : all.landmarks)
    if ((l.name == "inion" || l.name == "vertex") && !given.count(l.name))
      lower_confidence(l, of_a_doubtful_level, "the tragi and the nasion, by which the head is levelled, are doubtful",
                       reasons);
}

double scanned_below_mm(const craniometry::FieldView& skin, Vec3 point_mm, Vec3 up, double most_mm) {
  double depth = 0;
  while (depth < most_mm && skin.depth_in_scan_mm(point_mm - up * (depth + 1)) >= 0) depth += 1;
  return depth;
}

double covered_ratio(const grid::HuVolume& as_read, const grid::HuVolume& cleaned, const craniometry::FieldView& skin,
                     Vec3 point_mm, Vec3 outwards) {
  const mask::HuView before(as_read), after(cleaned);
  const Vec3 across = normalized(cross(outwards, std::abs(outwards.z) < 0.8 ? Vec3{0, 0, 1} : Vec3{0, 1, 0})),
             along = cross(outwards, across);
  int looked = 0, covered = 0;
  for (double u = -beside_mm; u <= beside_mm; u += apart_mm)
    for (double v = -beside_mm; v <= beside_mm; v += apart_mm) {
      if (std::hypot(u, v) > beside_mm) continue;
      const auto on_skin = skin.enter(point_mm + across * u + along * v + outwards * 25, -outwards, 45, 0.7);
      if (!on_skin) continue;
      ++looked;
      for (double d = 1; d <= above_skin_mm; d += 1) {
        const Vec3 p = *on_skin + outwards * d;
        if (hu_near(before, p) < apparatus_hu || hu_near(after, p) > air_hu) continue;
        ++covered;
        break;
      }
    }
  return looked ? double(covered) / looked : 0;
}

}  // namespace trephine::head
