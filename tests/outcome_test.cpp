// SPDX-License-Identifier: GPL-3.0-or-later
// What a CT after a procedure shows, of phantoms whose truth is known. Each case is made of the truth's shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "outcome/bone_fit.h"
#include "outcome/measure_outcome.h"
#include "outcome_case.h"
#include "phantom/phantom.h"

namespace trephine::outcome {
namespace {

using lesson::OutcomeRecord;
using lesson::Sighting;

phantom::HeadParams head_after(phantom::Implants implants, int seed = 3) {
  phantom::HeadParams p;
  p.seed = seed;
  p.level = phantom::Level::hard;
  p.implants.implants = implants;
  return p;
}

phantom::ScanParams scanner() {
  phantom::ScanParams s;
  s.columns_count = s.rows_count = 224;
  s.field_of_view_mm = 224;
  s.slices_count = 76;
  s.slice_step_mm = s.slice_thickness_mm = 2;
  s.centre_mm = {14, -30, 99};  // the upper head, where it lies
  s.noise_hu = 8;
  s.subvoxel_mm = 1.2;
  s.head_turn_deg = {9, -6, 12};
  s.head_shift_mm = {14, -22, 37};
  return s;
}

const cases::LoadedCase& the_case() {
  static const cases::LoadedCase made = [] {
    phantom::HeadParams p;
    p.seed = 3;
    return case_of(phantom::Head(p));
  }();
  return made;
}

grid::HuVolume scanned(const phantom::HeadParams& who, const phantom::ScanParams& with) {
  return phantom::volume_of(phantom::scan(phantom::Head(who), with));
}

// The catheter of a usual scan, which several tests spoil.
const grid::HuVolume& usual_scan() {
  static const grid::HuVolume made = scanned(head_after(phantom::Implants::catheter), scanner());
  return made;
}

Vec3 placed(const std::array<double, 12>& m, Vec3 p) {
  Vec3 out;
  for (std::size_t a = 0; a < 3; ++a)
    out[int(a)] = m[4 * a] * p.x + m[4 * a + 1] * p.y + m[4 * a + 2] * p.z + m[4 * a + 3];
  return out;
}

double angle_deg(Vec3 a, Vec3 b) { return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 57.29577951308232; }

TEST(Outcome, ACatheterAndItsHoleAreFoundWhereTheyLie) {
  const phantom::Head head(head_after(phantom::Implants::catheter));
  const phantom::ImplantTruth& truth = head.implants().front();
  const OutcomeRecord r = measure_outcome(the_case(), usual_scan(), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found);
  const itk::LinearMap pose = phantom::head_pose(scanner());
  for (const Vec3 p : {truth.tip_mm, truth.hole_mm, Vec3{40, 30, 60}})
    EXPECT_LT(norm(placed(r.registration.transform, p) - pose(p)), 0.5);
  ASSERT_EQ(r.catheter, Sighting::found) << (r.catheter_doubts.empty() ? "" : r.catheter_doubts.front());
  ASSERT_EQ(r.courses.size(), 1u);
  const lesson::OutcomeCourse& c = r.courses.front();
  EXPECT_LT(norm(c.tip_mm - truth.tip_mm), 1.0);
  EXPECT_LT(angle_deg(c.axis, normalized(truth.tip_mm - truth.hole_mm)), 1.5);
  EXPECT_EQ(c.side, "right");
  EXPECT_LT(norm(c.outer_mm - truth.hole_mm), 1.5);
  EXPECT_LT(c.error_mm, 0.6);
  ASSERT_EQ(r.hole, Sighting::found);
  ASSERT_EQ(r.holes.size(), 1u);
  EXPECT_LT(norm(r.holes.front().outer_mm - truth.hole_mm), 0.8);
  EXPECT_NEAR(r.holes.front().diameter_mm, truth.hole_diameter_mm, 0.6);
  EXPECT_EQ(r.holes.front().side, "right");
  EXPECT_TRUE(r.openings.empty());
}

TEST(Outcome, AHeadWithoutAnythingNewHasNone) {
  const OutcomeRecord r = measure_outcome(the_case(), scanned(head_after(phantom::Implants::none), scanner()), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found);
  EXPECT_EQ(r.catheter, Sighting::none);
  EXPECT_TRUE(r.courses.empty());
  EXPECT_EQ(r.hole, Sighting::none);
  EXPECT_TRUE(r.holes.empty());
  EXPECT_TRUE(r.openings.empty());
}

// A piece of bone of 9 cm that was taken out is no burr hole. Its truth by rays through the two heads.
TEST(Outcome, AMissingPieceOfBoneIsAnOpening) {
  phantom::HeadParams who = head_after(phantom::Implants::none);
  const phantom::Head before(who);
  who.hard.craniectomy = true;
  const phantom::Head after(who);
  const OutcomeRecord r = measure_outcome(the_case(), scanned(who, scanner()), {});
  EXPECT_TRUE(r.holes.empty());
  ASSERT_EQ(r.openings.size(), 1u);
  constexpr int rays = 20000;
  const Vec3 from{0, -20, 60};
  double area_mm2 = 0;
  for (int n = 0; n < rays; ++n) {
    const double z = 1 - 2 * (n + 0.5) / rays, s = std::sqrt(1 - z * z), turn = M_PI * (3 - std::sqrt(5.0)) * n;
    const Vec3 way{s * std::cos(turn), s * std::sin(turn), z};
    double t = 120;
    while (t > 40 && before.implicit_mm(phantom::Anatomy::skull, from + way * t) > 0) t -= 0.25;
    if (t <= 40 || after.implicit_mm(phantom::Anatomy::skull, from + way * (t - 1)) < 0) continue;
    const auto at = [&](Vec3 d) { return before.implicit_mm(phantom::Anatomy::skull, from + way * t + d); };
    const Vec3 out =
        normalized({at({1, 0, 0}) - at({-1, 0, 0}), at({0, 1, 0}) - at({0, -1, 0}), at({0, 0, 1}) - at({0, 0, -1})});
    area_mm2 += 4 * M_PI * t * t / rays / std::max(0.3, dot(out, way));
  }
  const lesson::OutcomeOpening& o = r.openings.front();
  EXPECT_NEAR(o.area_cm2, area_mm2 / 100, 0.1 * area_mm2 / 100);
  EXPECT_NEAR(o.longest_mm, 90, 5);
  EXPECT_EQ(o.side, "left");
  EXPECT_GE(o.confidence, 0.5);
  EXPECT_LT(norm(o.middle_mm - after.things_mm().front().second), 6);
}

TEST(Outcome, PaddingAtAScansEndIsNoOpening) {
  grid::HuVolume scan = usual_scan();
  auto& grid = std::get<grid::Grid<std::int16_t>>(scan);
  for (int k = 50; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j) std::fill_n(&grid.at(0, j, k), grid.size[0], std::int16_t(-1000));
  for (const lesson::OutcomeOpening& o : measure_outcome(the_case(), scan, {}).openings)
    EXPECT_LT(o.confidence, 0.5) << o.area_cm2 << " cm2";
}

TEST(Outcome, TwoCathetersAreDoubtful) {
  const OutcomeRecord r =
      measure_outcome(the_case(), scanned(head_after(phantom::Implants::two_catheters), scanner()), {});
  EXPECT_EQ(r.courses.size(), 2u);
  EXPECT_EQ(r.catheter, Sighting::doubtful);
  EXPECT_NE(std::find(r.catheter_doubts.begin(), r.catheter_doubts.end(), "two_courses"), r.catheter_doubts.end());
  EXPECT_EQ(r.holes.size(), 2u);
}

TEST(LongOutcome, AnotherPatientIsRefusedOrDoubtful) {
  for (const int seed : {5, 8, 13}) {
    const grid::HuVolume other = scanned(head_after(phantom::Implants::catheter, seed), scanner());
    try {
      const OutcomeRecord r = measure_outcome(the_case(), other, {});
      EXPECT_EQ(r.registration.sighting, Sighting::doubtful) << seed << ": " << r.registration.residual_mm << " mm";
      EXPECT_NE(r.catheter, Sighting::found) << seed;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
    }
  }
}

TEST(Outcome, AMirroredScanIsRefusedOrDoubtful) {
  grid::HuVolume scan = usual_scan();
  auto& grid = std::get<grid::Grid<std::int16_t>>(scan);
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j) std::reverse(&grid.at(0, j, k), &grid.at(0, j, k) + grid.size[0]);
  try {
    const OutcomeRecord r = measure_outcome(the_case(), scan, {});
    EXPECT_EQ(r.registration.sighting, Sighting::doubtful) << r.registration.residual_mm << " mm";
    EXPECT_NE(r.catheter, Sighting::found);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
  }
}

TEST(Outcome, TheSameBytesOnAnyNumberOfThreads) {
  const std::string all = lesson::to_json(measure_outcome(the_case(), usual_scan(), {}));
  set_thread_count(1);
  EXPECT_EQ(lesson::to_json(measure_outcome(the_case(), usual_scan(), {})), all);
  set_thread_count(0);
}

TEST(Outcome, ARecordComesBackAsItWasWritten) {
  OutcomeRecord r;
  r.case_token = "a";
  r.case_sha256 = r.series_sha256 = std::string(64, '0');
  r.program = "trephine";
  r.registration.sighting = Sighting::doubtful;
  r.registration.doubts = {"shape", "mirrored"};
  r.catheter = Sighting::doubtful;
  r.catheter_doubts = {"two_courses"};
  lesson::OutcomeCourse c;
  c.side = "left";
  c.tip_mm = {1, 2, 3};
  c.course = {{{1, 2, 3}}, {{4, 5, 6}}};
  r.courses = {c};
  const std::string text = lesson::to_json(r);
  const OutcomeRecord back = lesson::parse_outcome(text);
  EXPECT_EQ(lesson::to_json(back), text);
  EXPECT_EQ(back.registration.doubts, r.registration.doubts);
  ASSERT_EQ(back.courses.size(), 1u);
  EXPECT_EQ(back.courses[0].course.size(), 2u);
  std::string spoilt = text;
  spoilt.replace(spoilt.find("\"left\""), 6, "\"both\"");
  EXPECT_THROW(lesson::parse_outcome(spoilt), Error);
}

TEST(Outcome, LeavingPartsOutMovesWhatIsFarMost) {
  const ScanView scan(usual_scan());
  const auto points = bone_points(the_case().haptic, 2, 5);
  EXPECT_GT(points.size(), 1000u);
  const auto fit = fit_bone(points, scan);
  ASSERT_TRUE(fit);
  const LeftOutFits fits(points, scan, *fit);
  const double near = fits.standard_error_mm({0, -5, 60}), far = fits.standard_error_mm({0, -5, -240});
  EXPECT_GT(near, 0);
  EXPECT_GT(far, near);
}

}  // namespace
}  // namespace trephine::outcome
