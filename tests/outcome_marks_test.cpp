// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres of a print, found in a scan of known truth, and what they say of how a case lies in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/error.h"
#include "outcome/marks.h"
#include "outcome/measure_outcome.h"
#include "outcome_case.h"
#include "phantom/body_scan.h"
#include "phantom/phantom.h"
#include "phantom/print_scan.h"
#include "print/print_head.h"

namespace trephine::outcome {
namespace {

constexpr double mark_radius = 5;

std::vector<print::PrintMark> marks_about(double reach_mm) {
  const Vec3 places[] = {{1, 0.1, 0.2},    {-0.9, 0.3, 0.1}, {-0.2, 0.95, 0.4},
                         {0.4, -0.9, 0.1}, {0.2, 0.3, 0.95}, {-0.6, -0.6, 0.5}};
  std::vector<print::PrintMark> marks;
  for (const Vec3& p : places) {
    print::PrintMark m;
    m.number = std::int64_t(marks.size()) + 1;
    m.case_mm = p * reach_mm;
    m.post = -normalized(p);
    m.diameter_mm = 2 * mark_radius;
    marks.push_back(m);
  }
  return marks;
}

/// A thick shell with spheres on posts, in air, as a scanner sees it.
grid::HuVolume scan_of(const std::vector<print::PrintMark>& marks, const itk::LinearMap& pose, double plastic_hu,
                       double noise_hu) {
  phantom::ScanParams s;
  s.columns_count = s.rows_count = 150;
  s.field_of_view_mm = 150;
  s.slices_count = 75;
  s.slice_step_mm = s.slice_thickness_mm = 2;
  s.centre_mm = {0, 0, 10};
  s.noise_hu = noise_hu;
  const itk::LinearMap back = itk::inverse(pose);
  return phantom::volume_of(phantom::scan_body(
      [&](Vec3 lps, double width) {
        const Vec3 p = back(lps);
        double inside = -1e3;  // positive in plastic
        for (const print::PrintMark& m : marks) {
          const Vec3 d = p - m.case_mm;
          const double t = std::clamp(dot(d, m.post), 0.0, 14.0);
          inside = std::max({inside, mark_radius - norm(d), 2.5 - norm(d - m.post * t)});
        }
        const double reach = norm(marks[0].case_mm);
        inside = std::max(inside, std::min(reach - 11 - norm(p), norm(p) - (reach - 17)));
        const double share = std::clamp(0.5 + inside / width, 0.0, 1.0);
        return -1000 + share * (plastic_hu + 1000);
      },
      s, 4));
}

const itk::LinearMap& a_pose() {
  static const itk::LinearMap pose = itk::rigid_map({8, -5, 14}, {3, -4, 9}, {0, 0, 0});
  return pose;
}

TEST(OutcomeMarks, SpheresAreFoundWhereTheyAre) {
  const auto marks = marks_about(60);
  for (const double plastic : {150.0, 900.0}) {
    const grid::HuVolume volume = scan_of(marks, a_pose(), plastic, 12);
    const ScanView scan(volume);
    const auto found = find_spheres(scan, mark_radius);
    const MarkFit fit = fit_marks(marks, found);
    ASSERT_EQ(fit.marks, marks.size()) << plastic;
    for (const print::PrintMark& m : marks) {
      double off = 1e9;
      for (const FoundSphere& f : found) off = std::min(off, norm(f.at_mm - a_pose()(m.case_mm)));
      EXPECT_LT(off, 0.2) << m.number;
      EXPECT_LT(norm(fit.map(m.case_mm) - a_pose()(m.case_mm)), 0.2);
    }
    EXPECT_LT(fit.residual_mm, 0.2);
    EXPECT_GT(fit.residual_mm, 0);
    EXPECT_LT(norm(fit.map({0, 0, 0}) - a_pose()({0, 0, 0})), 0.1);
    EXPECT_LT(fit.error_mm({0, 0, 0}), fit.error_mm({0, 0, -200}));
    EXPECT_LT(fit.mirrored_marks, marks.size());
  }
}

// How far a target moves when the marks are known badly is what error_mm says.
TEST(OutcomeMarks, TheExpectedErrorIsThatOfManyTries) {
  const auto marks = marks_about(60);
  const Vec3 target{10, -20, -30};
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 0.3);
  double moved = 0, said = 0;
  constexpr int tries = 300;
  for (int n = 0; n < tries; ++n) {
    std::vector<FoundSphere> found;
    for (const print::PrintMark& m : marks)
      found.push_back({a_pose()(m.case_mm) + Vec3{normal(random), normal(random), normal(random)}, mark_radius, 0, 1});
    const MarkFit fit = fit_marks(marks, found);
    ASSERT_EQ(fit.marks, marks.size());
    const Vec3 off = fit.map(target) - a_pose()(target);
    moved += dot(off, off) / tries;
    said += fit.error_mm(target) * fit.error_mm(target) / tries;
  }
  EXPECT_NEAR(std::sqrt(said), std::sqrt(moved), 0.1 * std::sqrt(moved));
}

TEST(OutcomeMarks, MirroredTooFewAndOthersAreKnown) {
  const auto marks = marks_about(60);
  std::vector<FoundSphere> all;
  for (const print::PrintMark& m : marks) all.push_back({a_pose()(m.case_mm), mark_radius, 0, 1});
  std::vector<FoundSphere> mirrored = all;
  for (FoundSphere& f : mirrored) f.at_mm.x = -f.at_mm.x;
  const MarkFit turned = fit_marks(marks, mirrored);
  EXPECT_EQ(turned.mirrored_marks, marks.size());
  EXPECT_LT(turned.marks, marks.size());
  const MarkFit few = fit_marks(marks, {all.begin(), all.begin() + 3});
  EXPECT_LT(few.marks, least_marks);
  EXPECT_EQ(fit_marks(marks, {}).marks, 0u);
  // Two that are not the print's, and one that is missing, do not matter.
  std::vector<FoundSphere> more(all.begin() + 1, all.end());
  more.push_back({{20, 30, 40}, mark_radius, 0, 1});
  more.push_back({{-70, 10, 0}, mark_radius, 0, 1});
  const MarkFit fit = fit_marks(marks, more);
  EXPECT_EQ(fit.marks, marks.size() - 1);
  EXPECT_LT(fit.residual_mm, 1e-6);
}

// The loop on a coarse print: what is printed, scanned and measured is what was put in, and what is wrong is refused.
TEST(LongOutcomeMarks, AScanOfThePrintIsLaidOnTheCase) {
  phantom::HeadParams who;
  who.seed = 3;
  const cases::LoadedCase loaded = case_of(phantom::Head(who));
  print::PrintParams coarse;
  coarse.wall_mm = 3.6;
  coarse.voxel_mm = 1.2;
  const print::Printed printed = print::print_head(loaded, coarse);
  std::vector<phantom::ScannedPart> parts;
  for (const print::PrintedPart& p : printed.parts) parts.push_back({p.name, &p.mesh});
  phantom::PrintedParams with;
  const Vec3 kocher = landmark_mm(loaded, "kocher_right"), monro = landmark_mm(loaded, "monro_right");
  const Vec3 tip = monro + normalized(kocher - monro) * 3;
  with.entry_mm = {kocher.x, kocher.y, kocher.z};
  with.tip_mm = {tip.x, tip.y, tip.z};
  with.hole_mm = 12;
  phantom::ScanParams s;
  s.columns_count = s.rows_count = 256;
  s.field_of_view_mm = 256;
  s.slices_count = 80;
  s.slice_step_mm = s.slice_thickness_mm = 1.8;
  s.centre_mm = {14, -32, 112};
  s.head_turn_deg = {9, -6, 12};
  s.head_shift_mm = {14, -22, 37};
  s.noise_hu = 10;
  grid::HuVolume scan = phantom::volume_of(phantom::scan_print(printed.record, parts, with, s, 3));
  const auto found = find_spheres(ScanView(scan), 5);
  const itk::LinearMap pose = phantom::head_pose(s);
  for (const print::PrintMark& m : printed.record.marks) {
    double off = 1e9;
    for (const FoundSphere& f : found) off = std::min(off, norm(f.at_mm - pose(m.case_mm)));
    EXPECT_LT(off, 0.2) << m.number;
  }
  const lesson::OutcomeRecord r = measure_outcome(loaded, scan, {}, {}, &printed.record);
  EXPECT_EQ(r.registration.sighting, lesson::Sighting::found);
  EXPECT_EQ(r.registration.marks_count, std::int64_t(printed.record.marks.size()));
  EXPECT_LT(r.registration.residual_mm, 0.2);
  ASSERT_EQ(r.catheter, lesson::Sighting::found);
  EXPECT_LT(norm(r.courses.front().tip_mm - tip), 1);
  ASSERT_EQ(r.holes.size(), 1u);
  EXPECT_NEAR(r.holes.front().diameter_mm, 12, 1.5);
  auto& grid = std::get<grid::Grid<std::int16_t>>(scan);
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j) std::reverse(&grid.at(0, j, k), &grid.at(0, j, k) + grid.size[0]);
  try {
    measure_outcome(loaded, scan, {}, {}, &printed.record);
    ADD_FAILURE() << "a mirrored print is taken";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("mirrored"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace trephine::outcome
