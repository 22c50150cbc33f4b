// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks that a person gave: they win, are measured from, and are refused or doubted where they cannot be right.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "base/error.h"
#include "boolean/burr_hole.h"
#include "craniometry_found.h"
#include "meshing/contour.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace craniometry_test;

TEST(LandmarksFind, GivenOnesWinAndAreMeasuredFrom) {
  head::LandmarkInputs in = scene().inputs();
  for (const char* name : {"nasion", "inion", "tragus_left", "tragus_right"})
    in.given.push_back({name, scene().head.landmark(name), 1, "given"});
  in.given.push_back({"lesion", {1, 2, 3}, 1, "given"});
  Report report;
  const head::HeadLandmarks found = value_of(report, head::find_landmarks(scene().volume, in, {}));
  for (const cases::CaseLandmark& g : in.given) {
    ASSERT_TRUE(found.find(g.name)) << g.name;
    EXPECT_EQ(found.find(g.name)->position_mm, g.position_mm);
    EXPECT_EQ(found.find(g.name)->source, "given");
  }
  EXPECT_EQ(std::get<std::string>(*report.find("midsagittal_from")), "given landmarks");
  EXPECT_EQ(found.midsagittal.confidence, 1);
  // From the true nasion what is left is how the arcs are measured.
  for (const char* name : {"kocher_left", "kocher_right"})
    EXPECT_LT(norm(found.find(name)->position_mm - scene().head.landmark(name)), 0.7) << name;

  const head::HeadLandmarks both =
      head::merged(find(scene()), {{"nasion", {0, -90, 30}, 1, "given"}, {"x", {0, 0, 0}, 1, "given"}});
  EXPECT_EQ(both.find("nasion")->position_mm, (Vec3{0, -90, 30}));
  EXPECT_EQ(both.landmarks.size(), find(scene()).landmarks.size() + 1);
}

TEST(LandmarksFind, TragiThatDoNotMirrorEachOtherAreDoubtful) {
  // Which of the two is wrong cannot be known; what a person gave stays sure.
  double before = 2;
  for (const double off_mm : {0.0, 3.0, 12.0}) {
    head::LandmarkInputs in = scene().inputs();
    in.given = {{"tragus_left", scene().head.landmark("tragus_left") + Vec3{0, -off_mm, 0}, 1, "given"}};
    Report report;
    const head::HeadLandmarks found = value_of(report, head::find_landmarks(scene().volume, in, {}));
    EXPECT_EQ(confidence(found, "tragus_left"), 1);
    EXPECT_LT(confidence(found, "tragus_right"), before) << off_mm;
    before = confidence(found, "tragus_right");
    EXPECT_NEAR(std::get<double>(*report.find("tragi_asymmetry_mm")), off_mm, 5) << "the head itself is lopsided";
  }
  EXPECT_LT(before, 0.3);
}

TEST(LandmarksFind, KochersPointIsThatOfTheBurrHole) {
  head::LandmarkParams params;
  Report report;
  head::LandmarkInputs in = scene().inputs();
  std::map<std::string, Vec3> marks;
  for (const char* name : {"nasion", "inion", "tragus_left", "tragus_right"}) {
    marks[name] = scene().head.landmark(name);
    in.given.push_back({name, marks[name], 1, "given"});
  }
  const head::HeadLandmarks found = value_of(report, head::find_landmarks(scene().volume, in, params));
  const surface::TriMesh skin = value_of(report, meshing::contour(scene().skin, meshing::ContourParams())),
                         skull = value_of(report, meshing::contour(scene().skull, meshing::ContourParams()));
  for (const bool right : {true, false}) {
    boolean::BurrHoleRequest request;
    request.side = right ? boolean::BurrHoleRequest::Side::right : boolean::BurrHoleRequest::Side::left;
    ASSERT_EQ(request.lateral_mm, params.lateral_mm);
    ASSERT_EQ(request.along_mm, params.along_mm);
    const boolean::BurrHole hole = value_of(report, boolean::place_burr_hole(request, marks, &skin, skull));
    const Vec3 ours = found.find(right ? "kocher_right" : "kocher_left")->position_mm;
    EXPECT_LT(norm(hole.skin_mm - ours), 0.5);
  }
}

TEST(LandmarksFind, GivenOnesThatLieFarOutsideAreRefused) {
  head::LandmarkInputs in = scene().inputs();
  const auto refused = [&](const char* name, Vec3 at) {
    in.given = {{name, at, 1, "given"}};
    try {
      head::find_landmarks(scene().volume, in, {});
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), name);
      return std::string(e.what());
    }
    return std::string("taken");
  };
  EXPECT_NE(refused("inion", {0, 900, 0}).find("mm outside of the skin, at most 30"), std::string::npos);
  EXPECT_NE(refused("target", {0, 0, -500}).find("mm outside of the skin"), std::string::npos);
  const Vec3 nasion = scene().head.landmark("nasion");
  EXPECT_EQ(refused("nasion", nasion + Vec3{0, -5, 0}), "taken");
  EXPECT_NE(refused("tragus_left", scene().head.landmark("tragus_right")).find("are left and right exchanged?"),
            std::string::npos);
  EXPECT_NE(refused("kocher_right", scene().head.landmark("kocher_left")).find("to the left of the midsagittal plane"),
            std::string::npos);
}

TEST(LandmarksFind, GivenOnesThatCannotBeRightAreDoubted) {
  head::LandmarkInputs in = scene().inputs();
  const auto doubts = [&](const char* name, Vec3 at) {
    in.given = {{name, at, 1, "given"}};
    Report report;
    value_of(report, head::find_landmarks(scene().volume, in, {}));
    std::string all;
    for (const std::string& w : report.warnings)
      if (w.rfind(name, 0) == 0 && w.find("as given") != std::string::npos) all += w + "; ";
    return all;
  };
  const auto& head = scene().head;
  EXPECT_NE(doubts("nasion", head.landmark("inion")).find("mm from where it would be found"), std::string::npos);
  EXPECT_NE(doubts("inion", {0, 0, 50}).find("more than 8 mm below the skin"), std::string::npos);
  EXPECT_NE(doubts("nasion", head.landmark("nasion") + Vec3{0, 9.5, 0}).find("more than 8 mm below the skin"),
            std::string::npos);
  EXPECT_NE(doubts("nasion", head.landmark("nasion") + Vec3{0, 0, 10}).find("mm from where it would be found"),
            std::string::npos);
  EXPECT_NE(doubts("tragus_left", head.landmark("tragus_left") + Vec3{0, 12, 3}).find("from where it would be found"),
            std::string::npos);
  EXPECT_NE(doubts("bregma", {0, -20, 60}).find("more than 8 mm from the bone"), std::string::npos);
  EXPECT_NE(doubts("monro_left", {55, 40, 60}).find("more than 20 mm from the ventricles"), std::string::npos);
  for (const char* name : {"nasion", "inion", "tragus_left", "tragus_right", "kocher_left", "monro_left"})
    EXPECT_EQ(doubts(name, head.landmark(name)), "") << name;
}

TEST(LandmarksFind, ANameThatIsNotLookedForIsSaidWithTheNearestOne) {
  head::LandmarkInputs in = scene().inputs();
  const Vec3 inside = scene().head.landmark("nasion");
  in.given = {{"naison", inside, 1, "given"}, {"left_tragus", inside, 1, "given"}, {"lesion_edge", inside, 1, "given"}};
  Report report;
  const head::HeadLandmarks found = value_of(report, head::find_landmarks(scene().volume, in, {}));
  EXPECT_EQ(found.find("nasion")->source, "found");
  const auto warned = [&](const std::string& text) {
    return std::find(report.warnings.begin(), report.warnings.end(), text) != report.warnings.end();
  };
  EXPECT_TRUE(warned("naison is none of the landmarks that are looked for, did you mean nasion?"));
  EXPECT_TRUE(warned("left_tragus is none of the landmarks that are looked for, did you mean tragus_left?"));
  EXPECT_TRUE(warned("lesion_edge is none of the landmarks that are looked for: it is kept as it is"));
}

}  // namespace
}  // namespace trephine
