// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The head that the landmarks are looked for in, and what is found in it.
#include "base/report.h"
#include "craniometry_scenes.h"
#include "report_of.h"

namespace trephine::craniometry_test {

inline const LandmarkScene& scene() {
  static const LandmarkScene s = [] {
    phantom::HeadParams who;
    who.seed = 3;
    phantom::ScanParams how;
    how.columns_count = how.rows_count = 216;
    how.slices_count = 104;
    how.pixel_mm = 1.12;
    how.slice_step_mm = how.slice_thickness_mm = 1.8;
    how.subvoxel_mm = 1;
    return make_scene(who, how);
  }();
  return s;
}

inline head::HeadLandmarks find(const LandmarkScene& s, Report& report) {
  return value_of(report, head::find_landmarks(s.volume, s.inputs(), {}));
}

inline head::HeadLandmarks find(const LandmarkScene& s) {
  Report report;
  return find(s, report);
}

inline double confidence(const head::HeadLandmarks& l, const char* name) {
  const cases::CaseLandmark* found = l.find(name);
  return found ? found->confidence : 0;
}

}  // namespace trephine::craniometry_test
