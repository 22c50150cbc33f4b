// SPDX-License-Identifier: GPL-3.0-or-later
// What a configuration says of the head as a whole: landmarks, the face, the anatomical gate; and what of it is
// computed.
#include <gtest/gtest.h>

#include <fstream>

#include "base/error.h"
#include "config/config.h"
#include "head/head_region.h"
#include "mask/scan_verdict.h"
#include "picture/image.h"
#include "pipeline/graph.h"
#include "publish/case_pictures.h"
#include "publish/face_clearance.h"
#include "publish/head_content.h"
#include "publish/verdict.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

const std::string head = "trephine: 1\npipeline: recipe.yaml\nscene: scene.yaml\n";

std::string anatomy(const std::string& name, const std::string& stage, bool shows_face = false) {
  return "  " + name + ":\n    shows_face: " + (shows_face ? "true" : "false") + "\n    stages:\n      - " + stage +
         "\n      - contour\n      - decimate\n      - smooth\n      - normals\n";
}

const std::string recipe =
    "trephine: 1\nanatomies:\n" + anatomy("skin", "segment: {lower_hu: -400}", true) +
    anatomy("skull", "segment: {lower_hu: 226, within: skin.segment}") +
    anatomy("brain", "brain: {skull: skull.segment}") + anatomy("ventricles", "ventricles: {brain: brain.brain}") +
    "burr_holes: {bone: skull, over: skin}\ntargets: {monro_right: ventricles, monro_left: ventricles}\n"
    "class_of: ventricles\n"
    "landmarks: {skin: skin.segment, skull: skull.segment, brain: brain.brain, ventricles: ventricles.ventricles}\n"
    "deface: {skin: skin.segment}\n"
    "anatomy: {skin: skin.segment, skull: skull.segment, brain: brain.brain, ventricles: ventricles.ventricles}\n";

const std::string keep = "face: {policy: keep, reason: a test}\n";

struct Read {
  ScratchFolder folder;
  config::CaseConfig config;
  std::string faults;
  Read(const std::string& case_yaml, const std::string& scene, const config::ConfigOverrides& overrides = {},
       const std::string& recipe_yaml = recipe) {
    folder.write("recipe.yaml", recipe_yaml);
    folder.write("scene.yaml", "trephine: 1\n" + scene);
    folder.write("points.fcsv",
                 "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                 "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
                 "1,0,-93,40,0,0,0,1,1,1,0,Nasion,,\n2,0,90,6,0,0,0,1,1,1,0,Jane Roe,,\n");
    try {
      config = config::read_case_config(folder.write("case.yaml", head + case_yaml), overrides);
    } catch (const ErrorList& e) {
      for (const Error& one : e.all()) faults += one.line("") + "\n";
    }
  }
  pipeline::Graph graph() const { return pipeline::make_graph(config, "input"); }
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

int source(const pipeline::Graph& g, const char* node, const char* port) {
  const int n = g.find(node);
  if (n < 0) return -2;
  const auto& sources = g.nodes[static_cast<std::size_t>(n)].sources;
  const auto found = sources.find(port);
  return found == sources.end() ? -1 : found->second;
}

// What a run says at its end of the face is what the next run can do.
TEST(PublishHead, AFaceIsOfferedToBeTakenOffWhereItsLandmarksAreSure) {
  std::vector<cases::CaseLandmark> all = {{"nasion", {0, -95, 10}, 0.9, "found"},
                                          {"tragus_left", {72, 0, -20}, 0.9, "found"},
                                          {"tragus_right", {-72, 0, -20}, 0.9, "found"}};
  const std::string sure = publish::how_to_take_face_off(all);
  EXPECT_EQ(sure, "`--set scene.face.policy=deface` takes it off");
  EXPECT_EQ(publish::how_to_take_face_off({}), sure) << "nobody has looked for them";
  all[1].confidence = 0.33649917399162155;
  const std::string unsure = publish::how_to_take_face_off(all);
  EXPECT_NE(unsure.find("once the landmarks of the face are given"), std::string::npos) << unsure;
  EXPECT_NE(unsure.find("by landmarks.tragus_left as it was found"), std::string::npos) << unsure;
}

}  // namespace

TEST(HeadConfig, FaultsHaveTheirPlace) {
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nlandmarks: {nasoin: 0.5}\n").faults, "did you mean nasion?"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nlandmarks: {nasion: 1.5}\n").faults, "landmarks.nasion"));
  EXPECT_TRUE(
      has(Read("", "anatomies: {skull: }\nface: {policy: blur}\n").faults, "must be one of crop, deface, keep"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nface: {policy: keep}\n").faults, "face.reason: is missing"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nface: {policy: keep, reason: ' '}\n").faults, "is blank"));
  EXPECT_EQ(Read("", "anatomies: {skull: }\nface: {policy: deface}\n").faults, "");
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nface: crop\n").faults,
                  "{policy: ..., reason: ..., believe: ..., believe_reason: ...}"));
  const std::string no_head = recipe.substr(0, recipe.find("landmarks:"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\nface: {policy: crop}\n", {}, no_head).faults, "need `landmarks`"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\n", {}, no_head + "landmarks: {skin: skin.segment}\n").faults,
                  "landmarks.skull: is missing"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\n", {}, no_head + "deface: {skin: skin.contour}\n").faults,
                  "must be the field"));
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\n", {}, no_head + "deface: {skin: skin.segment, dept_mm: 3}\n").faults,
                  "did you mean depth_mm?"));
}

TEST(HeadConfig, WhereAnotherStageMakesAnAnatomyItsNameIsSaid) {
  std::string other = recipe;
  const std::string by = "ventricles: {brain: brain.brain}";
  other.replace(other.find(by), by.size(), "labels: {file: v.nrrd}");
  const std::string faults = Read("", "anatomies: {skull: }\n" + keep, {}, other).faults;
  EXPECT_TRUE(has(faults,
                  "landmarks.ventricles: ventricles.ventricles, must be the field of an anatomy, as "
                  "anatomy.stage: here ventricles.labels"));
  other = recipe;
  other.replace(other.find("skull: skull.segment}"), 21, "skull: skull.contour}");
  EXPECT_TRUE(has(Read("", "anatomies: {skull: }\n" + keep, {}, other).faults, ": here skull.segment"));
}

TEST(HeadConfig, ParametersOfTheWholeHeadHavePaths) {
  config::ConfigOverrides overrides;
  overrides.set = {"landmarks.lateral_mm=30"};
  const Read r("set: {deface.depth_mm: 14}\n", "anatomies: {skull: }\n" + keep, overrides);
  ASSERT_EQ(r.faults, "");
  const config::RecipeStep* deface = r.config.face_step();
  EXPECT_EQ(to_text(deface->params.get(*deface->params.set->find("depth_mm"))), "14");
  const config::RecipeStep* landmarks = r.config.landmarks_step();
  EXPECT_EQ(to_text(landmarks->params.get(*landmarks->params.set->find("lateral_mm"))), "30");
}

TEST(HeadConfig, PointsOfSlicerAreLandmarksAndOtherLabelsGoNowhere) {
  const Read r("landmarks_file: points.fcsv\n", "anatomies: {skull: }\n" + keep);
  ASSERT_EQ(r.faults, "");
  ASSERT_EQ(r.config.landmarks.size(), 1u);  // whatever else is called in the file stays there
  EXPECT_EQ(r.config.landmarks[0].name, "nasion");
  EXPECT_EQ(r.config.landmarks[0].position_mm.y, -93);
  EXPECT_EQ(r.config.landmarks[0].source, "given");
  EXPECT_TRUE(
      has(Read("landmarks_file: points.fcsv\nlandmarks: {nasion: [0, 1, 2]}\n", "anatomies: {skull: }\n" + keep).faults,
          "which is meant?"));
  EXPECT_TRUE(has(Read("landmarks_file: gone.fcsv\n", "anatomies: {skull: }\n" + keep).faults, "gone.fcsv"));
  // The command line's file wins.
  ScratchFolder other;
  config::ConfigOverrides overrides;
  overrides.landmarks = other.write("p.fcsv",
                                    "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                                    "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
                                    "1,0,-77,40,0,0,0,1,1,1,0,nasion,,\n");
  const Read won("landmarks: {nasion: [0, 1, 2]}\n", "anatomies: {skull: }\n" + keep, overrides);
  ASSERT_EQ(won.config.landmarks.size(), 1u);
  EXPECT_EQ(won.config.landmarks[0].position_mm.y, -77);
}

// What skin and skull alone may refuse is asked before brain and ventricles are made.
TEST(HeadGraph, ACheckIsMadeFirstOfWhatAloneMayBeRefused) {
  const pipeline::Graph g = Read("", "anatomies: {skin: , skull: , brain: }\n" + keep).graph();
  const int whole = g.find("anatomy"), early = g.find("anatomy.skin_skull");
  ASSERT_GE(whole, 0);
  ASSERT_GE(early, 0);
  const pipeline::Node& node = g.nodes[std::size_t(early)];
  EXPECT_TRUE(node.is_early && node.wanted && !g.nodes[std::size_t(whole)].is_early);
  for (const char* port : {"skin", "skull", "volume"}) EXPECT_GE(source(g, "anatomy.skin_skull", port), 0) << port;
  EXPECT_EQ(source(g, "anatomy.skin_skull", "brain"), -1);
  EXPECT_EQ(g.find_stage(*g.nodes[std::size_t(whole)].params.set, ""), whole);
  // Without another anatomy it is the check itself.
  EXPECT_EQ(Read("", "anatomies: {skull: , brain: }\n" + keep).graph().find("anatomy.skin_skull"), -1);
}

TEST(HeadGraph, LandmarksAreFoundOnlyWhereTheyAreNeeded) {
  const pipeline::Graph skull = Read("", "anatomies: {skull: }\n" + keep).graph();
  for (const char* needless : {"landmarks", "anatomy", "deface", "face", "skin.contour"})
    EXPECT_LT(skull.find(needless), 0) << needless;
  const pipeline::Graph wanted = Read("", "anatomies: {skull: }\nlandmarks: {nasion: 0.5}\n" + keep).graph();
  EXPECT_GE(wanted.result(stages::DataKind::landmarks), 0);
  EXPECT_LT(wanted.find("ventricles.ventricles"), 0);  // the nasion does without
  const pipeline::Graph monro = Read("", "anatomies: {skull: }\nlandmarks: {monro_left: 0.5}\n" + keep).graph();
  EXPECT_GE(monro.find("ventricles.ventricles"), 0);
  EXPECT_EQ(source(monro, "landmarks", "ventricles"), monro.find("ventricles.ventricles"));
  EXPECT_LT(monro.find("ventricles.contour"), 0);
}

TEST(HeadGraph, AGivenLandmarkSparesTheSearchAndChangesWhatHangsOnIt) {
  const std::string scene = "anatomies: {skull: , skin: }\nburr_holes: {skull: {}}\n" + keep;
  const std::string hole = "burr_holes: [{side: left, diameter_mm: 12}]\n";
  const pipeline::Graph given = Read("landmarks: {nasion: [0, -93, 40], inion: [0, 89, 6]}\n" + hole, scene).graph();
  EXPECT_LT(given.result(stages::DataKind::landmarks), 0);
  const pipeline::Graph found = Read("landmarks: {inion: [0, 89, 6]}\n" + hole, scene).graph();
  ASSERT_GE(found.result(stages::DataKind::landmarks), 0);
  EXPECT_EQ(source(found, "burr_hole_1", "landmarks"), found.result(stages::DataKind::landmarks));
  const pipeline::Graph moved = Read("landmarks: {inion: [0, 88, 6]}\n" + hole, scene).graph();
  EXPECT_NE(moved.nodes[moved.result(stages::DataKind::landmarks)].key,
            found.nodes[found.result(stages::DataKind::landmarks)].key);
}

TEST(HeadGraph, TheGateSeesWhatTheSceneShows) {
  const pipeline::Graph two = Read("", "anatomies: {skull: , brain: }\n" + keep).graph();
  ASSERT_GE(two.find("anatomy"), 0);
  EXPECT_EQ(source(two, "anatomy", "skull"), two.find("skull.segment"));
  EXPECT_EQ(source(two, "anatomy", "skin"), -1);
  EXPECT_LT(two.result(stages::DataKind::landmarks), 0);  // there are no ventricles whose shift could be measured
  const pipeline::Graph all = Read("", "anatomies: {skin: , skull: , brain: , ventricles: }\n" + keep).graph();
  EXPECT_EQ(source(all, "anatomy", "landmarks"), all.result(stages::DataKind::landmarks));
  EXPECT_GE(all.result(stages::DataKind::landmarks), 0);
}

// What a stage takes off the scan is drawn, but not where it might have lain on a face that is taken away.
TEST(HeadGraph, WhatIsTakenOffIsDrawn) {
  const std::string with_body = recipe + "body: {}\n", scene = "anatomies: {skin: }\n";
  const pipeline::Graph kept = Read("", scene + keep, {}, with_body).graph();
  ASSERT_EQ(kept.removals.size(), 1u);
  EXPECT_EQ(kept.removals[0].before, 0);
  EXPECT_EQ(kept.removals[0].after, kept.find("body"));
  const pipeline::Graph defaced = Read("", scene + "face: {policy: deface}\n", {}, with_body).graph();
  EXPECT_GE(defaced.find("body"), 0);
  EXPECT_TRUE(defaced.removals.empty());
}

TEST(HeadGraph, TheOutlineOfWhatIsMissingIsInThePicture) {
  grid::Lattice lattice;
  lattice.size = {60, 60, 40};
  lattice.spacing_mm = {1, 1, 1};
  grid::Grid<std::int16_t> scan(lattice, -1000);
  const auto fill = [&](int from, int to, std::int16_t hu) {
    for (int k = 5; k < 35; ++k)
      for (int j = from; j < to; ++j)
        for (int i = 10; i < 50; ++i) scan.at(i, j, k) = hu;
  };
  fill(10, 40, 40);
  const auto held = [](const grid::Grid<std::int16_t>& hu) {
    return [of = std::make_shared<const grid::HuVolume>(hu)] { return of; };
  };
  const auto body = held(scan);
  EXPECT_FALSE(publish::make_removed_picture(body, body, "body")) << "nothing is missing";
  fill(48, 54, -500);  // a cushion
  const auto picture = publish::make_removed_picture(held(scan), body, "body");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->name, "removed_by_body.png");
  const picture::Image image = picture::decode_png(picture->png);
  // Of the first slice the part below its legend: red lines, and only in its lower half, where the cushion lay.
  const auto red = [&](int from, int to) {
    int count = 0;
    for (int y = from; y < to; ++y)
      for (int x = 0; x < 640; ++x) {
        const std::uint8_t* p = image.at(x, y);
        count += p[0] > 150 && p[1] < 100 && p[2] < 80;
      }
    return count;
  };
  EXPECT_EQ(red(60, 400), 0);
  EXPECT_GT(red(400, 640), 500);
  grid::Lattice other = lattice;
  other.size[0] = 50;
  EXPECT_THROW(publish::make_removed_picture(held(scan), held(grid::Grid<std::int16_t>(other)), "body"), Error);
}

TEST(HeadGraph, TheFaceIsGoneBeforeAnythingIsMade) {
  const std::string scene = "anatomies: {skin: , ventricles: }\n";
  const pipeline::Graph kept = Read("", scene + keep).graph(),
                        gone = Read("", scene + "face: {policy: deface}\n").graph();
  EXPECT_EQ(kept.scan, 0);
  EXPECT_LT(kept.find("face"), 0);
  ASSERT_EQ(gone.scan, gone.find("deface"));
  for (const char* made : {"skin.segment", "skull.segment", "brain.brain", "ventricles.ventricles"})
    EXPECT_EQ(source(gone, made, "volume"), gone.scan) << made;
  // What tells where the face is sees it: skin, skull and the landmarks of the scan as it came.
  EXPECT_EQ(source(gone, "original.skin.segment", "volume"), 0);
  EXPECT_EQ(source(gone, "original.landmarks", "skin"), gone.find("original.skin.segment"));
  EXPECT_EQ(source(gone, "landmarks", "skin"), gone.find("original.skin.segment"));
  EXPECT_EQ(source(gone, "landmarks", "ventricles"), gone.find("ventricles.ventricles"));
  EXPECT_LT(gone.find("original.brain.brain"), 0);
  // And everything that is published is held against it.
  EXPECT_EQ(source(gone, "face", "skin"), gone.find("original.skin.segment"));
  EXPECT_EQ(source(gone, "face", "surface.skin"), gone.find("skin.normals"));
  EXPECT_EQ(source(gone, "face", "surface.ventricles"), gone.find("ventricles.normals"));
  EXPECT_LT(gone.find("original.found_landmarks"), 0) << "nobody gave any";
  // What a person gave says nothing alone: the same search without it goes in beside it.
  const pipeline::Graph given = Read("landmarks: {nasion: [0, -93, 40]}\n", scene + "face: {policy: deface}\n").graph();
  const int found = given.find("original.found_landmarks");
  ASSERT_GE(found, 0);
  EXPECT_EQ(given.nodes[static_cast<std::size_t>(found)].sources.count("given"), 0u);
  EXPECT_EQ(source(given, "deface", "found"), found);
  EXPECT_EQ(source(given, "face", "found"), found);
  EXPECT_EQ(source(given, "original.landmarks", "given"), given.find("given_landmarks"));
  const pipeline::Graph cropped = Read("", scene + "face: {policy: crop}\n").graph();
  EXPECT_NE(cropped.nodes[cropped.scan].key, gone.nodes[gone.scan].key);
  // A scene that says nothing of the face is held against it as well, in the scan as it is.
  const pipeline::Graph silent = Read("", "anatomies: {skull: }\n").graph();
  EXPECT_EQ(silent.scan, 0);
  EXPECT_EQ(source(silent, "face", "skin"), silent.find("skin.segment"));
}

TEST(HeadContent, AVerdictSaysWhereTheScanEndsInAnAnatomy) {
  head::HeadRegionResult region;
  region.cut = {{"skin", "above and on its left side"}, {"brain", "above"}};
  mask::ScanResult scan;
  scan.suited.brain = mask::Suitability::doubtful;
  scan.because.brain = "slices of 5 mm";
  cases::CaseManifest m;
  m.missing.push_back({"dura", "a test"});
  stages::CaseParts parts;
  const auto verdict = [&](const std::vector<std::string>& wanted) {
    return publish::verdict_text(publish::judge_anatomies(wanted, m, parts.evidence), m, parts.evidence, parts.remarks);
  };
  stages::stage_named("head_region").contribute(AnyParams::make(region), parts);
  EXPECT_EQ(verdict({"skin", "skull", "brain", "dura"}),
            "skin: cut off above and on its left side; skull: good; brain: cut off above; dura: left out");
  stages::stage_named("scan").contribute(AnyParams::make(scan), parts);
  EXPECT_EQ(verdict({"skull", "brain"}), "skull: good; brain: doubtful, cut off above (slices of 5 mm)");
}

TEST(HeadContent, ALandmarkThatIsNotSureEnoughIsRefusedSayingHowToGiveIt) {
  const Read r("landmarks: {inion: [0, 89, 6]}\n", "anatomies: {skull: }\nlandmarks: {nasion: 0.6, inion: 1}\n" + keep);
  const pipeline::Graph g = r.graph();
  std::vector<pipeline::NodeResult> results(g.nodes.size());
  head::HeadLandmarks found;
  found.landmarks = {{"nasion", {0, -93, 40}, 0.55, "found"}, {"inion", {0, 89, 6}, 1, "given"}};
  const auto content = [&] {
    results[std::size_t(g.result(stages::DataKind::landmarks))].data =
        std::make_shared<const head::HeadLandmarks>(found);
    cases::CaseManifest m;
    publish::add_landmarks(r.config, g, results, m);
    return m;
  };
  try {
    content();
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "landmarks.nasion");
    EXPECT_TRUE(has(e.what(), "confidence 0.55")) << e.what();
    EXPECT_TRUE(has(e.what(), "landmarks: {nasion: [x, y, z]}")) << e.what();
  }
  found.landmarks[0].confidence = 0.6;
  EXPECT_EQ(content().landmarks.size(), 2u);
  found.landmarks.erase(found.landmarks.begin());
  EXPECT_THROW(content(), Error);
}
