// SPDX-License-Identifier: GPL-3.0-or-later
// What a CT shows of pedicle screws, of phantoms whose truth is known. The case is made of the truth's shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "outcome/measure_outcome.h"
#include "outcome_spine_case.h"
#include "phantom/phantom.h"

namespace trephine::outcome {
namespace {

using lesson::OutcomeRecord;
using lesson::Sighting;
using phantom::SpineScrews;

phantom::SpineParams spine_of(int seed) {
  phantom::SpineParams p;
  p.vertebrae_seed = seed;
  return p;
}

// On another day: turned, shifted, bent, and screwed.
phantom::SpineParams after(SpineScrews::Sides sides, int seed = 3) {
  phantom::SpineParams p = spine_of(seed);
  p.bend_deg = seed == 0 ? 0 : 2;
  p.screws.sides = sides;
  if (sides == SpineScrews::Sides::none) return p;
  p.screws.aside_mm = 2.5;
  p.screws.axial_deg = -5;
  p.screws.sagittal_deg = 4;
  return p;
}

phantom::ScanParams scanner() {
  phantom::ScanParams s;
  s.columns_count = s.rows_count = 150;
  s.field_of_view_mm = 150;
  s.slices_count = 64;
  s.slice_step_mm = s.slice_thickness_mm = 1.5;
  s.head_turn_deg = {4, -3, 6};
  s.head_shift_mm = {6, -5, 9};
  s.centre_mm = {6, -12, 51};
  return s;
}

const cases::LoadedCase& the_case(int seed = 3) {
  static const cases::LoadedCase made = case_of(phantom::Spine(spine_of(3))), alike = case_of(phantom::Spine());
  return seed == 0 ? alike : made;
}

grid::HuVolume scanned(const phantom::SpineParams& who, phantom::ScanParams with = scanner()) {
  return phantom::volume_of(phantom::scan(who, with, 5));
}

const grid::HuVolume& usual_scan() {
  static const grid::HuVolume made = scanned(after(SpineScrews::Sides::both));
  return made;
}

double angle_deg(Vec3 a, Vec3 b) { return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 57.29577951308232; }

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

TEST(OutcomeSpine, ScrewsAreFoundWhereTheyLie) {
  phantom::SpineParams straight = after(SpineScrews::Sides::both);
  straight.bend_deg = 0;  // the case's frame
  const phantom::Spine truth(straight);
  const Vec3 offset = phantom::default_centre_mm() - Vec3{0, 10, 0};
  const OutcomeRecord r = measure_outcome(the_case(), usual_scan(), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found)
      << (r.registration.doubts.empty() ? "" : r.registration.doubts.front());
  EXPECT_GT(r.registration.next_level_residual_mm, 2 * r.registration.residual_mm);
  ASSERT_EQ(r.screws.size(), 2u);
  for (const phantom::Spine::Screw& t : truth.screws()) {
    const lesson::OutcomeScrew& s = r.screws[t.left ? 0 : 1];
    EXPECT_EQ(s.pedicle, t.left ? "pedicle_2_left" : "pedicle_2_right");
    ASSERT_EQ(s.sighting, Sighting::found) << s.doubts.front();
    EXPECT_LT(norm(s.tip_mm - t.tip_mm - offset), 1);
    EXPECT_LT(norm(s.head_mm - t.seat_mm - offset), 1);
    EXPECT_LT(angle_deg(s.axis, t.axis()), 1.5);
    EXPECT_NEAR(s.diameter_mm, straight.screws.diameter_mm, 0.6);
    EXPECT_NEAR(s.length_mm, straight.screws.length_mm, 1);
    EXPECT_LT(s.error_mm, 0.5);
  }
}

TEST(OutcomeSpine, ASpineWithoutScrewsHasNone) {
  const OutcomeRecord r = measure_outcome(the_case(), scanned(after(SpineScrews::Sides::none)), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found);
  EXPECT_TRUE(r.screws.empty());
}

TEST(OutcomeSpine, RodsJoinNoScrews) {
  phantom::SpineParams p = after(SpineScrews::Sides::left);
  p.screws.levels_count = 2;
  p.screws.rods = true;
  phantom::ScanParams higher = scanner();
  higher.slices_count = 80;
  higher.centre_mm = {6, -12, 59};
  const OutcomeRecord r = measure_outcome(the_case(), scanned(p, higher), {});
  ASSERT_EQ(r.screws.size(), 2u);
  EXPECT_EQ(r.screws[0].pedicle, "pedicle_2_left");
  EXPECT_EQ(r.screws[1].pedicle, "pedicle_3_left");
  for (const lesson::OutcomeScrew& s : r.screws) EXPECT_NEAR(s.length_mm, p.screws.length_mm, 1);
}

TEST(OutcomeSpine, ANeedleIsNoScrew) {
  phantom::SpineParams p = after(SpineScrews::Sides::right);
  p.screws.needle = true;
  p.screws.diameter_mm = 3;
  const OutcomeRecord r = measure_outcome(the_case(), scanned(p), {});
  ASSERT_EQ(r.screws.size(), 1u);
  p.bend_deg = 0;
  const phantom::Spine truth(p);
  const lesson::OutcomeScrew& s = r.screws.front();
  EXPECT_EQ(s.kind, "needle");
  EXPECT_EQ(s.pedicle, "pedicle_2_right");
  EXPECT_EQ(s.sighting, Sighting::found) << (s.doubts.empty() ? "" : s.doubts.front());
  EXPECT_LT(norm(s.tip_mm - truth.screws().front().tip_mm - phantom::default_centre_mm() + Vec3{0, 10, 0}), 1);
  EXPECT_LT(angle_deg(s.axis, truth.screws().front().axis()), 1.5);
  EXPECT_NEAR(s.diameter_mm, 3, 0.6);
}

TEST(OutcomeSpine, VertebraeThatAreAlikeLeaveTheLevelDoubtful) {
  const OutcomeRecord r = measure_outcome(the_case(0), scanned(after(SpineScrews::Sides::left, 0)), {});
  EXPECT_TRUE(has(r.registration.doubts, "level"));
  for (const lesson::OutcomeScrew& s : r.screws) EXPECT_TRUE(has(s.doubts, "registration"));
}

TEST(OutcomeSpine, AnotherPatientIsRefusedOrDoubtful) {
  for (const int seed : {8, 13}) try {
      const OutcomeRecord r = measure_outcome(the_case(), scanned(after(SpineScrews::Sides::both, seed)), {});
      EXPECT_EQ(r.registration.sighting, Sighting::doubtful) << seed << ": " << r.registration.residual_mm << " mm";
      for (const lesson::OutcomeScrew& s : r.screws) EXPECT_EQ(s.sighting, Sighting::doubtful);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
    }
}

TEST(OutcomeSpine, AMirroredScanIsRefused) {
  grid::HuVolume scan = usual_scan();
  auto& grid = std::get<grid::Grid<std::int16_t>>(scan);
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j) std::reverse(&grid.at(0, j, k), &grid.at(0, j, k) + grid.size[0]);
  try {
    measure_outcome(the_case(), scan, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("mirrored"), std::string::npos) << e.what();
  }
}

TEST(OutcomeSpine, TheSameBytesOnAnyNumberOfThreads) {
  const std::string all = lesson::to_json(measure_outcome(the_case(), usual_scan(), {}));
  set_thread_count(1);
  EXPECT_EQ(lesson::to_json(measure_outcome(the_case(), usual_scan(), {})), all);
  set_thread_count(0);
  EXPECT_EQ(lesson::to_json(lesson::parse_outcome(all)), all);
}

}  // namespace
}  // namespace trephine::outcome
