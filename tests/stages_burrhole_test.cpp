// SPDX-License-Identifier: GPL-3.0-or-later
// What the stage burrhole asks of Kocher's point and of a position, on a hollow ball of bone.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "boolean/burr_hole_params.h"
#include "head/head_landmarks.h"
#include "meshing/contour.h"
#include "report_of.h"
#include "stages/stage.h"

namespace trephine {
namespace {

constexpr double outer_mm = 80, inner_mm = 73;

std::shared_ptr<const surface::TriMesh> hollow_ball() {
  static const auto mesh = [] {
    grid::Lattice l;
    l.size = {90, 90, 90};
    l.spacing_mm = {2, 2, 2};
    l.origin_mm = {-89, -89, -89};
    grid::Field f(l);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const double r = norm(l.to_world_mm({double(i), double(j), double(k)}));
          f.at(i, j, k) = float(std::min(outer_mm - r, r - inner_mm));
        }
    Report report;
    return std::make_shared<const surface::TriMesh>(value_of(report, meshing::contour(f, meshing::ContourParams())));
  }();
  return mesh;
}

/// On the midline, that far from the nasion over the ball.
Vec3 on_midline(double arc_mm) { return Vec3{0, -std::cos(arc_mm / outer_mm), std::sin(arc_mm / outer_mm)} * outer_mm; }

head::HeadLandmarks marks(double bregma_arc_mm, double bregma_confidence = 1, double nasion_confidence = 1) {
  head::HeadLandmarks all;
  all.landmarks = {{"nasion", on_midline(0), nasion_confidence, "found"},
                   {"inion", {0, outer_mm, 0}, 1, "found"},
                   {"tragus_left", {outer_mm, 0, 0}, 1, "found"},
                   {"tragus_right", {-outer_mm, 0, 0}, 1, "found"},
                   {"bregma", on_midline(bregma_arc_mm), bregma_confidence, "found"}};
  return all;
}

/// What the stage says: "made", or its error.
std::string said(const head::HeadLandmarks& landmarks, Report& report, const boolean::BurrHoleParams& params = {}) {
  const stages::StageType& stage = stages::stage_named("burrhole");
  AnyParams any = stage.make_params();
  any.as<boolean::BurrHoleParams>() = params;
  stages::StageInputs in;
  in.by_port["bone"] = hollow_ball();
  in.by_port["landmarks"] = std::make_shared<const head::HeadLandmarks>(landmarks);
  try {
    add(report, stage.run(any, in, {}).report());
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
    return e.field() + ": " + e.what();
  }
  return "made";
}
std::string said(const head::HeadLandmarks& landmarks, const boolean::BurrHoleParams& params = {}) {
  Report report;
  return said(landmarks, report, params);
}

TEST(StageBurrHole, KochersPointLies5To25MillimetresBeforeTheSuture) {
  Report report;
  EXPECT_EQ(said(marks(125), report), "made");
  EXPECT_NEAR(std::get<double>(*report.find("before_suture_mm")), 14.5, 2);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(said(marks(117)), "made");
  EXPECT_EQ(said(marks(133)), "made");
  const std::string far = said(marks(150)), behind = said(marks(100));
  EXPECT_NE(far.find("before the coronal suture, 5 to 25 mm before it are allowed"), std::string::npos) << far;
  EXPECT_NE(far.find("landmarks_file"), std::string::npos) << far;
  EXPECT_NE(behind.find("behind the coronal suture"), std::string::npos) << behind;
  // What the message says to do works.
  boolean::BurrHoleParams followed;
  const std::string key = "; --along-mm ";
  ASSERT_NE(far.find(key), std::string::npos) << far;
  followed.along_mm = std::stod(far.substr(far.find(key) + key.size()));
  EXPECT_EQ(said(marks(150), followed), "made");
  boolean::BurrHoleParams wider;
  wider.max_before_suture_mm = 45;
  EXPECT_EQ(said(marks(150), wider), "made");
}

TEST(StageBurrHole, ADoubtfulSutureIsSaidAndADoubtfulNasionRefused) {
  Report report;
  EXPECT_EQ(said(marks(150, 0.3), report), "made");
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("coronal suture was not seen"), std::string::npos);
  // Seen beside the midline alone, it is good enough to refuse what lies far off.
  EXPECT_NE(said(marks(150, 0.45)).find("before the coronal suture"), std::string::npos);
  const std::string refused = said(marks(125, 1, 0.3));
  EXPECT_NE(refused.find("nasion"), std::string::npos) << refused;
  EXPECT_NE(refused.find(".mrk.json"), std::string::npos) << refused;
}

TEST(StageBurrHole, APositionIsCheckedForBoneAndDirectionAlone) {
  boolean::BurrHoleParams at;
  at.at = boolean::BurrHoleRequest::At::position;
  at.position_mm = {0, 0, outer_mm};  // 25 mm behind the suture
  EXPECT_EQ(said(marks(100, 1, 0.1), at), "made");
}

TEST(StageBurrHole, ATargetIsWhereTheAxisPoints) {
  boolean::BurrHoleParams at;
  at.at = boolean::BurrHoleRequest::At::position;
  at.position_mm = {0, 0, outer_mm};
  at.target_mm = {20, 0, 10};
  Report report;
  EXPECT_EQ(said(marks(100), report, at), "made");
  EXPECT_NEAR(std::get<double>(*report.find("axis_to_normal_deg")), std::atan2(20, outer_mm - 10) * 180 / M_PI, 1.5);
  at.direction = {0, 0, -1};
  EXPECT_THROW(boolean::check_request(at, ExitCode::bad_config), Error);
}

}  // namespace
}  // namespace trephine
