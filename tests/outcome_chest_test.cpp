// SPDX-License-Identifier: GPL-3.0-or-later
// What a CT shows of a central line, of phantoms whose truth is known. The case is made of the truth's shapes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "outcome/measure_outcome.h"
#include "outcome_chest_case.h"
#include "phantom/phantom.h"

namespace trephine::outcome {
namespace {

using lesson::OutcomeLine;
using lesson::OutcomeRecord;
using lesson::Sighting;
using phantom::ChestLine;

phantom::ChestParams chest_with(ChestLine::Sides sides, int seed = 3) {
  phantom::ChestParams p;
  p.chest_seed = seed;
  p.line.sides = sides;
  return p;
}

// On another day: turned and shifted, with less of the chest.
phantom::ScanParams scanner() {
  phantom::ScanParams s;
  s.columns_count = s.rows_count = 224;
  s.field_of_view_mm = 324;
  s.slices_count = 48;
  s.slice_step_mm = s.slice_thickness_mm = 2;
  s.head_turn_deg = {4, -3, 5};
  s.head_shift_mm = {6, -5, 9};
  s.centre_mm = {6, -15, 50};
  return s;
}

// The CT of a case, in its frame.
grid::Grid<std::int16_t> case_ct(ChestLine::Sides lines) {
  phantom::ScanParams s = scanner();
  s.head_turn_deg = s.head_shift_mm = {0, 0, 0};
  return phantom::volume_of(phantom::scan(chest_with(lines), s, 7));
}

const cases::LoadedCase& the_case() {
  static const cases::LoadedCase made = [] {
    cases::LoadedCase one = case_of(phantom::Chest(chest_with(ChestLine::Sides::none)));
    one.ct = case_ct(ChestLine::Sides::none);
    return one;
  }();
  return made;
}

grid::HuVolume scanned(const phantom::ChestParams& who) { return phantom::volume_of(phantom::scan(who, scanner(), 5)); }

const grid::HuVolume& usual_scan() {
  static const grid::HuVolume made = scanned(chest_with(ChestLine::Sides::both));
  return made;
}

// How far a place lies off a course.
double off_mm(Vec3 p, const std::vector<Vec3>& course) {
  double best = 1e9;
  for (std::size_t n = 1; n < course.size(); ++n) {
    const Vec3 from = course[n - 1], way = course[n] - from;
    best = std::min(best, norm(p - from - way * std::clamp(dot(p - from, way) / dot(way, way), 0.0, 1.0)));
  }
  return best;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

TEST(OutcomeChest, LinesAreFoundWhereTheyLie) {
  const OutcomeRecord r = measure_outcome(the_case(), usual_scan(), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found)
      << (r.registration.doubts.empty() ? "" : r.registration.doubts.front());
  const itk::LinearMap pose = phantom::head_pose(scanner());
  const auto& rows = r.registration.transform;
  for (const Vec3& p : {Vec3{0, -15, 37}, Vec3{100, -15, 50}, Vec3{-60, -60, 10}}) {
    Vec3 at;
    for (std::size_t a = 0; a < 3; ++a)
      at[int(a)] = rows[4 * a] * p.x + rows[4 * a + 1] * p.y + rows[4 * a + 2] * p.z + rows[4 * a + 3];
    EXPECT_LT(norm(at - pose(p)), 0.5);
  }
  ASSERT_EQ(r.lines.size(), 2u);
  for (const phantom::Chest::PutIn& t : phantom::Chest(chest_with(ChestLine::Sides::both)).put_in()) {
    const std::string side = t.left ? "left" : "right";
    const OutcomeLine& l = r.lines[r.lines.front().side == side ? 0 : 1];
    ASSERT_EQ(l.side, side);
    ASSERT_EQ(l.sighting, Sighting::found) << l.doubts.front();
    EXPECT_LT(norm(l.tip_mm - t.tip_mm - chest_offset_mm()), 1);
    EXPECT_LT(norm(l.skin_mm - t.skin_mm - chest_offset_mm()), 1.5);
    EXPECT_LT(norm(l.vein_mm - t.vein_mm - chest_offset_mm()), 1.5);
    EXPECT_GT(dot(l.axis, normalized(t.vein_mm - t.skin_mm)), std::cos(1.5 / 57.29578));
    for (const lesson::OutcomePlace& p : l.course) EXPECT_LT(off_mm(p.at_mm - chest_offset_mm(), t.course_mm), 1);
    EXPECT_GT(l.in_vein_mm, 30);
    EXPECT_EQ(l.in_lung_mm, 0);
    EXPECT_LT(l.clavicle_moved_mm, 0.5);
    EXPECT_LT(l.error_mm, 0.5);
  }
}

TEST(OutcomeChest, WithoutALineThereIsNone) {
  phantom::ChestParams bare = chest_with(ChestLine::Sides::none);
  bare.line.electrodes_count = 4;
  const OutcomeRecord r = measure_outcome(the_case(), scanned(bare), {});
  EXPECT_EQ(r.registration.sighting, Sighting::found);
  EXPECT_TRUE(r.lines.empty());
}

TEST(OutcomeChest, ALineInTheLungIsSeenThere) {
  phantom::ChestParams p = chest_with(ChestLine::Sides::left);
  p.line.ends = ChestLine::Ends::lung;
  const phantom::Chest::PutIn truth = phantom::Chest(p).put_in().front();
  ASSERT_GT(truth.in_lung_mm, 10);
  const OutcomeRecord r = measure_outcome(the_case(), scanned(p), {});
  ASSERT_EQ(r.lines.size(), 1u);
  EXPECT_EQ(r.lines.front().side, "left");
  EXPECT_NEAR(r.lines.front().in_lung_mm, truth.in_lung_mm, 2.5);
  EXPECT_LT(norm(r.lines.front().tip_mm - truth.tip_mm - chest_offset_mm()), 1);
}

TEST(OutcomeChest, ARaisedShoulderIsADoubt) {
  phantom::ChestParams p = chest_with(ChestLine::Sides::right);
  p.shoulders_raised_deg = 8;
  const OutcomeRecord r = measure_outcome(the_case(), scanned(p), {});
  ASSERT_EQ(r.lines.size(), 1u);
  EXPECT_GT(r.lines.front().clavicle_moved_mm, 4);
  EXPECT_EQ(r.lines.front().sighting, Sighting::doubtful);
  EXPECT_TRUE(has(r.lines.front().doubts, "clavicle"));
}

TEST(OutcomeChest, WhatWasThereBeforeIsNotFound) {
  cases::LoadedCase with = the_case();
  with.ct = case_ct(ChestLine::Sides::both);
  EXPECT_TRUE(measure_outcome(with, usual_scan(), {}).lines.empty());
  with.ct = {};  // a case without its CT does not show it
  const OutcomeRecord unknown = measure_outcome(with, usual_scan(), {});
  ASSERT_EQ(unknown.lines.size(), 2u);
  EXPECT_TRUE(has(unknown.lines[0].doubts, "no_ct"));
}

TEST(OutcomeChest, AnotherPatientIsRefusedOrDoubtful) {
  for (const int seed : {8, 13}) try {
      const OutcomeRecord r = measure_outcome(the_case(), scanned(chest_with(ChestLine::Sides::right, seed)), {});
      EXPECT_EQ(r.registration.sighting, Sighting::doubtful) << seed << ": " << r.registration.residual_mm << " mm";
      for (const OutcomeLine& l : r.lines) EXPECT_EQ(l.sighting, Sighting::doubtful);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
    }
}

TEST(OutcomeChest, AMirroredScanIsRefused) {
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

TEST(OutcomeChest, TheSameBytesOnAnyNumberOfThreads) {
  const std::string all = lesson::to_json(measure_outcome(the_case(), usual_scan(), {}));
  set_thread_count(1);
  EXPECT_EQ(lesson::to_json(measure_outcome(the_case(), usual_scan(), {})), all);
  set_thread_count(0);
  EXPECT_EQ(lesson::to_json(lesson::parse_outcome(all)), all);
}

}  // namespace
}  // namespace trephine::outcome
