// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/hash.h"
#include "cases/case.h"

namespace trephine::cases_test {

/// A manifest with something of everything but the haptic part.
inline cases::CaseManifest sample_manifest() {
  cases::CaseManifest m;
  m.case_token = "sample";
  m.center_mm = {10, 20.5, -30.1};
  cases::CaseAnatomy a;
  a.name = "skull";
  a.colour_rgb = {0.93, 0.89, 0.78};
  a.triangles = 4;
  a.points = 4;
  a.volume_ml = 0.1 + 0.2;
  a.area_cm2 = 1e-7;
  a.deviation = {0.75, 0.5, 1 / 3.0};
  a.budget_asked_mm = 0.3;
  a.budget_used_mm = 0.2;
  a.figures = {{"stopped_by", std::string("max_deviation_mm")}, {"genus", std::int64_t{0}}, {"closed", true}};
  m.anatomies = {a};
  m.landmarks = {{"nasion", {0, -95, 10}, 0.9, "found"}};
  m.targets = {{"foramen_right", {-5, 1, 2}, 0.8, "ventricles"}};
  m.burr_holes = {{"kocher_right",
                   {-30, -20, 80},
                   {0, 0, -1},
                   14,
                   {"skull"},
                   {{"bone_thickness_mm", 6.25}, {"skull.removed_haptic_mm3", 900.5}}}};
  m.figures = {{"class", std::string("normal")}, {"evans_index_ratio", 0.27}};
  m.face_policy = "keep";
  m.face_reason = "a synthetic \"patient\"";
  m.program_version = "trephine 0.1.0";
  m.input_sha256 = sha256_of_bytes("input");
  m.parameters = {{"skull.segment.lower_hu", 226.5},
                  {"skull.decimate.target_triangles_count", std::int64_t{80000}},
                  {"skull.segment.roi_min_mm", std::vector<double>{-1, 0.5, 1e6}}};
  return m;
}

}  // namespace trephine::cases_test
