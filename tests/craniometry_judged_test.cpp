// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks judged together, the coronal suture, and what is said of doubtful ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "craniometry/plausible.h"
#include "craniometry_found.h"
#include "dicom/import.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace craniometry_test;

std::vector<cases::CaseLandmark> of_the_phantom() {
  std::vector<cases::CaseLandmark> all;
  for (const auto& [name, at] : scene().head.landmarks()) all.push_back({name, at, 0.9, "found"});
  return all;
}

bool warns(const Report& report, const std::string& name, const std::string& of) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [&](const std::string& w) { return w.rfind(name, 0) == 0 && w.find(of) != std::string::npos; });
}

TEST(Plausible, ThoseOfOneHeadAreAndAWrongOneIsBlamed) {
  EXPECT_TRUE(craniometry::implausible(of_the_phantom()).empty());
  for (const char* name : {"nasion", "inion", "tragus_left", "monro_right"}) {
    std::vector<cases::CaseLandmark> all = of_the_phantom();
    for (cases::CaseLandmark& l : all)
      if (l.name == name) l.position_mm += Vec3{0, 70, -40};
    const auto doubts = craniometry::implausible(all);
    const bool of_a_pair = std::string(name).find('_') != std::string::npos;  // which of the two is not known
    ASSERT_EQ(doubts.size(), of_a_pair ? 2u : 1u) << name;
    EXPECT_TRUE(
        std::any_of(doubts.begin(), doubts.end(), [&](const craniometry::LandmarkDoubt& d) { return d.name == name; }));
    EXPECT_LT(doubts[0].factor, 0.5);
    EXPECT_NE(doubts[0].reason.find("are plausible"), std::string::npos) << doubts[0].reason;
  }
}

TEST(Plausible, WhatAPersonGaveIsNotBlamed) {
  std::vector<cases::CaseLandmark> all;
  for (const cases::CaseLandmark& l : of_the_phantom())
    if (l.name == "nasion" || l.name == "inion") all.push_back(l);
  all[0].position_mm += Vec3{0, 90, 0};
  EXPECT_EQ(craniometry::implausible(all).size(), 2u);  // nothing tells which
  all[0].source = "given";
  const auto doubts = craniometry::implausible(all);
  ASSERT_EQ(doubts.size(), 1u);
  EXPECT_EQ(doubts[0].name, all[1].name);
  all[1].source = "given";
  EXPECT_TRUE(craniometry::implausible(all).empty());
}

TEST(Plausible, ThePlaceBeforeTheSuture) {
  const Vec3 nasion{0, -100, 0}, centre{0, 0, 0}, bregma{0, 0, 90};
  EXPECT_NEAR(craniometry::before_suture_mm({30, -15, 85}, bregma, centre, nasion), 15, 1e-9);
  EXPECT_NEAR(craniometry::before_suture_mm({-30, 8, 85}, bregma, centre, nasion), -8, 1e-9);
}

/// The height of the outer table of the analytic head.
double table_height_mm(const phantom::Head& head, double x, double y) {
  double z = 200;
  while (z > 60 && head.sample({x, y, z}, 0.3).hu < 700) z -= 0.2;
  return z;
}

TEST(Suture, TheBregmaOfAPhantomIsThatOfItsSuture) {
  Report report;
  const head::HeadLandmarks found = find(scene(), report);
  const cases::CaseLandmark* bregma = found.find("bregma");
  ASSERT_TRUE(bregma);
  EXPECT_EQ(bregma->source, "found");
  EXPECT_GT(bregma->confidence, 0.8);
  // The cleft, beside the sagittal suture: where the bone under the table is least dense.
  double truth = 0;
  for (const double x : {-6.0, 6.0}) {
    double least = 1e9, at = 0;
    for (double y = -60; y < 10; y += 0.2) {
      const double hu = scene().head.sample({x, y, table_height_mm(scene().head, x, y) - 1.2}, 0.3).hu;
      if (hu < least) least = hu, at = y;
    }
    truth += at / 2;
  }
  EXPECT_NEAR(bregma->position_mm.y, truth, 2.5);
  EXPECT_NEAR(bregma->position_mm.x, 0, 1);
  EXPECT_NEAR(bregma->position_mm.z, table_height_mm(scene().head, 4, bregma->position_mm.y), 2);
  for (const char* name : {"kocher_left_before_suture_mm", "kocher_right_before_suture_mm"}) {
    ASSERT_TRUE(report.find(name));
    EXPECT_GT(std::get<double>(*report.find(name)), 5) << name;
    EXPECT_LT(std::get<double>(*report.find(name)), 25) << name;
  }
}

TEST(Suture, WhereNoneIsSeenTheBregmaIsADoubtfulEstimate) {
  LandmarkScene s = scene();
  std::visit(
      [](auto& g) {
        for (auto& v : g.voxels) v = v > 300 ? 300 : v;  // bone of one density
      },
      s.volume);
  // The field's surface shows no cleft either: bone within the closed skull stays what it is.
  Report report;
  const head::HeadLandmarks found = find(s, report);
  const cases::CaseLandmark* bregma = found.find("bregma");
  ASSERT_TRUE(bregma);
  EXPECT_EQ(bregma->source, "estimated");
  EXPECT_LT(bregma->confidence, 0.5);
  EXPECT_TRUE(warns(report, "bregma", "is doubtful"));
  EXPECT_LE(confidence(found, "kocher_right"), bregma->confidence);  // they lie where they do because of the bregma
  EXPECT_GT(confidence(found, "kocher_right"), 0.3);                 // and nothing else speaks against them
}

TEST(Judged, ASheetOverTheForeheadDoubtsWhatIsMeasuredOverIt) {
  LandmarkScene s = scene();
  const Vec3 nasion = s.head.landmark("nasion");
  // A mask 9 mm off the skin that ends above the brow and has a hole.
  grid::Field& f = s.skin;
  const grid::Field before = f;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        const Vec3 p = f.to_world_mm({double(i), double(j), double(k)});
        if (p.z < nasion.z + 20 || p.y > 0 || (p.z > nasion.z + 45 && p.z < nasion.z + 60)) continue;
        const Vec3 inwards = before.to_index(p + normalized(Vec3{0, 0, 60} - p) * 9.0);
        const int a = int(std::lround(inwards.x)), b = int(std::lround(inwards.y)), c = int(std::lround(inwards.z));
        if (before.contains(a, b, c)) f.at(i, j, k) = std::max(f.at(i, j, k), before.at(a, b, c));
      }
  Report report;
  const head::HeadLandmarks found = find(s, report);
  EXPECT_GT(std::get<double>(*report.find("midline_leap_mm")), 4);
  for (const char* name : {"nasion", "kocher_left", "kocher_right", "vertex"}) {
    EXPECT_LT(confidence(found, name), 0.5) << name;
    EXPECT_TRUE(warns(report, name, "doubtful") || !found.find(name)) << name;
  }
  EXPECT_TRUE(warns(report, "nasion", "the midline's skin leaps"));
  // The back of the head is not judged by its front; slices of 1.8 mm take 0.03 from what it has.
  EXPECT_GE(confidence(found, "inion"), 0.47);
}

TEST(Judged, ALandmarkOfWhichNothingSpeaksIsNone) {
  // The right ear moved away by its own length: the tragi do not mirror each other.
  LandmarkScene s = scene();
  head::LandmarkInputs in = s.inputs();
  in.given = {{"tragus_left", s.head.landmark("tragus_left") + Vec3{0, 25, 0}, 1, "given"}};
  Report report;
  const head::HeadLandmarks found = value_of(report, head::find_landmarks(s.volume, in, {}));
  EXPECT_FALSE(found.find("tragus_right"));
  EXPECT_TRUE(warns(report, "tragus_right", "not found: "));
  for (const cases::CaseLandmark& l : found.landmarks) EXPECT_GE(l.confidence, 0.05) << l.name;
}

// An ear is known by its shape alone: without the other one nothing confirms it.
TEST(Judged, ALoneTragusIsDoubtful) {
  const double right = scene().head.landmark("tragus_right").x, all = 1e4;
  const LandmarkScene s = cut(scene(), {right + 12, -all, -all}, {all, all, all});
  Report report;
  EXPECT_LT(confidence(find(s, report), "tragus_left"), 0.5);
  EXPECT_TRUE(warns(report, "tragus_left is doubtful", "the other one, on the right, was not found"));
  // Where a person gives the other one, the two confirm each other.
  head::LandmarkInputs in = scene().inputs();
  in.given = {{"tragus_right", scene().head.landmark("tragus_right"), 1, "given"}};
  EXPECT_GT(confidence(head::find_landmarks(scene().volume, in, {}).value, "tragus_left"), 0.8);
}

TEST(Judged, ATragusWhoseOtherOneIsDoubtfulIsDoubtfulToo) {
  // The scan ends a few millimetres beside the right one, which is found there and not trusted.
  const double right = scene().head.landmark("tragus_right").x, all = 1e4;
  const LandmarkScene s = cut(scene(), {right - 5, -all, -all}, {all, all, all});
  Report report;
  const head::HeadLandmarks found = find(s, report);
  ASSERT_TRUE(found.find("tragus_right"));
  EXPECT_LT(confidence(found, "tragus_right"), 0.5);
  ASSERT_TRUE(found.find("tragus_left"));
  EXPECT_LT(confidence(found, "tragus_left"), 0.5);
  EXPECT_TRUE(warns(report, "tragus_left is doubtful", "the other one, on the right, is itself doubtful"));
}

/// Points that a reader placed on a real head, with the radius within which he was sure.
struct Read {
  const char* name;
  Vec3 at;
  double radius_mm;
};
void expect_read(const char* data, const std::vector<Read>& points) {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  const auto path = std::filesystem::path(own ? own : std::string(home ? home : "") + "/.cache/trephine-data") / data;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data at " << path;
  const grid::HuVolume volume = dicom::import_series(path, {}).volume;
  Report report;
  const grid::Field skin = segmentation::segment(volume, {}, head_recipe::skin()).value;
  segmentation::SegmentMasks masks;
  masks.within = &skin;
  const grid::Field skull = segmentation::segment(volume, masks, head_recipe::skull()).value;
  head::LandmarkInputs in;
  in.skin = &skin;
  in.skull = &skull;
  const head::HeadLandmarks found = value_of(report, head::find_landmarks(volume, in, {}));
  for (const Read& p : points) {
    const cases::CaseLandmark* l = found.find(p.name);
    ASSERT_TRUE(l) << p.name;
    EXPECT_GE(l->confidence, 0.5) << p.name;
    EXPECT_LT(norm(l->position_mm - p.at), p.radius_mm) << p.name;
  }
  // Each doubtful one is told of.
  for (const cases::CaseLandmark& l : found.landmarks)
    EXPECT_TRUE(l.confidence >= 0.5 || warns(report, l.name, "is doubtful")) << l.name;
}

TEST(LongLandmarksReal, AHeadWithAnOpenSuture) {
  expect_read("head_invesalius_0051", {{"nasion", {0.5, -129, 183.5}, 5},
                                       {"inion", {1, 52.1, 129.5}, 8},
                                       {"tragus_left", {77.8, -37.8, 143.8}, 4},
                                       {"tragus_right", {-71.5, -39.3, 143.8}, 4},
                                       {"bregma", {1.4, -37.8, 269.8}, 2}});
}

TEST(LongLandmarksReal, AHeadWhoseSutureGrewTogether) {
  expect_read("head_neuronav_C3N-01192", {{"nasion", {-3.6, -52, -7.4}, 5},
                                          {"inion", {-3.6, 122.2, -63}, 10},
                                          {"tragus_left", {76.7, 33, -51.8}, 4},
                                          {"tragus_right", {-82.3, 30.6, -56.8}, 4}});
}

}  // namespace
}  // namespace trephine
