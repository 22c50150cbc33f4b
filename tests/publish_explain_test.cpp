// SPDX-License-Identifier: GPL-3.0-or-later
// Only what the scene requires: of every scene that is shipped, nothing is computed that no output needs, and what is
// left out is said.
#include "publish/explain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>

#include "base/error.h"
#include "cases/case.h"
#include "publish/case_content.h"
#include "publish/run_case.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

const fs::path configs = fs::path(TREPHINE_SOURCE_DIR) / "configs";

// Every shipped configuration of a case.
std::vector<fs::path> shipped_cases() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(configs))
    if (entry.path().extension() == ".yaml") {
      const std::string name = entry.path().filename().string();
      if (name.rfind("ct_", 0) == 0 || name.rfind("sample", 0) == 0) all.push_back(entry.path());
    }
  std::sort(all.begin(), all.end());
  return all;
}

std::set<int> ancestors(const pipeline::Graph& graph, const std::vector<int>& of) {
  std::set<int> all;
  std::vector<int> open(of.begin(), of.end());
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    if (!all.insert(n).second) continue;
    for (const auto& [port, source] : graph.nodes[std::size_t(n)].sources) open.push_back(source);
  }
  return all;
}

TEST(OnlyWhatTheSceneRequires, EveryStageOfEveryShippedSceneLeadsToAnOutput) {
  const auto cases = shipped_cases();
  ASSERT_GE(cases.size(), 9u);
  for (const fs::path& file : cases) {
    const config::CaseConfig config = config::read_case_config(file);
    const pipeline::Graph graph = pipeline::make_graph(config, "input");
    const std::vector<int> wanted = publish::wanted_nodes(graph, true);
    const std::set<int> needed = ancestors(graph, wanted);
    for (std::size_t i = 0; i < graph.nodes.size(); ++i)
      EXPECT_TRUE(needed.count(int(i))) << file << " computes " << graph.nodes[i].name << " for nothing";
    // And each output is one that the scene names, or a gate or a measure of such.
    std::set<std::string> shown;
    for (const config::SceneAnatomy& a : config.scene) shown.insert(a.name);
    for (const pipeline::Graph::Anatomy& a : graph.anatomies) EXPECT_TRUE(shown.count(a.name)) << file << " " << a.name;
    EXPECT_EQ(graph.anatomies.size(), shown.size()) << file;
    EXPECT_EQ(graph.result(stages::DataKind::haptic) >= 0, config.haptic.wanted) << file;
  }
}

TEST(OnlyWhatTheSceneRequires, WhatIsNotComputedIsSaidAndWhy) {
  const pipeline::StageCache none{fs::path()};
  for (const fs::path& file : shipped_cases()) {
    const config::CaseConfig config = config::read_case_config(file);
    const pipeline::Graph graph = pipeline::make_graph(config, "input");
    const publish::Explanation e = publish::explain(config, graph, publish::wanted_nodes(graph, true), none);
    std::set<std::string> told;
    for (const auto& s : e.stages) {
      EXPECT_EQ(s.state, publish::Explanation::Stage::State::compute);
      EXPECT_FALSE(s.why.empty()) << file << " " << s.name;
      told.insert(s.name);
    }
    for (const auto& p : e.pruned) {
      EXPECT_LT(graph.find(p.name), 0) << file << " " << p.name;
      EXPECT_TRUE(told.insert(p.name).second) << p.name;
    }
    for (const config::RecipeAnatomy& a : config.anatomies)
      for (const config::RecipeStep& s : a.steps)
        EXPECT_TRUE(told.count(a.name + "." + s.type->name))
            << file << " says nothing of " << a.name << "." << s.type->name;
  }
}

// Also what is no parameter of a stage: roles, colours, materials, given landmarks.
TEST(Explain, SaysOfEveryValueOfTheCaseWhereItComesFrom) {
  const auto rows_of = [](const fs::path& file, const config::ConfigOverrides& overrides) {
    const config::CaseConfig config = config::read_case_config(file, overrides);
    const pipeline::Graph graph = pipeline::make_graph(config, "input");
    std::map<std::string, config::ValueRow> rows;
    for (const config::ValueRow& row :
         publish::explain(config, graph, publish::wanted_nodes(graph, true), pipeline::StageCache{fs::path()}).values)
      rows[row.path] = row;
    return rows;
  };
  const ScratchFolder folder;
  const fs::path points = folder.write("points.fcsv",
                                       "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
                                       "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
                                       "1,0,-93,40,0,0,0,1,1,1,0,nasion,,\n2,1,2,3,0,0,0,1,1,1,0,Jane Doe,,\n");
  config::ConfigOverrides overrides;
  overrides.landmarks = points;
  const auto rows = rows_of(configs / "sample_drilled.yaml", overrides);
  const auto expect_row = [&](const std::string& path, const std::string& value, config::ValueSource source,
                              const char* where) {
    ASSERT_TRUE(rows.count(path)) << path;
    EXPECT_EQ(rows.at(path).value, value) << path;
    EXPECT_EQ(rows.at(path).origin.source, source) << path;
    EXPECT_NE(rows.at(path).origin.where.find(where), std::string::npos) << rows.at(path).origin.where;
  };
  expect_row("skull.shows_face", "false", config::ValueSource::recipe, "ventriculostomy.yaml:");
  expect_row("skull.colour_rgb", "[0.93, 0.89, 0.78]", config::ValueSource::recipe, "ventriculostomy.yaml:");
  expect_row("burr_holes.bone", "\"skull\"", config::ValueSource::recipe, "ventriculostomy.yaml:");
  expect_row("class_of", "\"ventricles\"", config::ValueSource::recipe, "ventriculostomy.yaml:");
  expect_row("materials.bone.front.stiffness_n_per_mm", "1", config::ValueSource::scene, "materials.yaml:");
  expect_row("given_landmarks.landmarks.nasion.position_mm", "[0, -93, 40]", config::ValueSource::command_line,
             "points.fcsv");
  expect_row("given_landmarks.landmarks.inion.position_mm", "[0, 89.4, 5.8]", config::ValueSource::set,
             "sample_drilled.yaml:");
  EXPECT_FALSE(rows.count("materials.vein.front.stiffness_n_per_mm")) << "no shape of the scene is made of it";
  for (const auto& [path, row] : rows) EXPECT_EQ(path.find("Jane"), std::string::npos) << path;
  // A skull alone has no material and no landmark.
  for (const auto& [path, row] : rows_of(configs / "ct_skull.yaml", {}))
    EXPECT_TRUE(path.rfind("materials.", 0) != 0 && path.rfind("given_", 0) != 0 && path != "brain.colour_rgb") << path;
  // They are told where they are said, and not set by a path.
  config::ConfigOverrides hidden;
  hidden.set = {"skin.shows_face=false"};
  EXPECT_THROW(config::read_case_config(configs / "sample.yaml", hidden), ErrorList);
}

TEST(OnlyWhatTheSceneRequires, ASkullAloneNeedsNoBrain) {
  const config::CaseConfig config = config::read_case_config(configs / "ct_skull.yaml");
  std::set<std::string> names;
  for (const pipeline::Node& n : pipeline::make_graph(config, "input").nodes) names.insert(n.name);
  EXPECT_EQ(names, (std::set<std::string>{"import", "body_part", "scan", "body", "head_region", "skin.segment",
                                          "skull.segment", "skull.simplify", "skull.shape_interpolate", "skull.contour",
                                          "skull.decimate", "skull.smooth", "skull.normals", "skull.measure"}));
}

// What the scan must be of is asked where the configuration says it, and else no stage looks.
TEST(OnlyWhatTheSceneRequires, ThePartOfTheBodyIsAskedWhereItIsSaid) {
  const auto looks = [&](const char* config, const std::vector<std::string>& set) {
    config::ConfigOverrides overrides;
    overrides.set = set;
    return pipeline::make_graph(config::read_case_config(configs / config, overrides), "input").find("body_part") >= 0;
  };
  for (const char* c : {"ct_head.yaml", "ct_skull.yaml", "ct_spine.yaml", "ct_spine_bone.yaml", "ct_chest.yaml",
                        "ct_chest_bone.yaml"}) {
    EXPECT_TRUE(looks(c, {})) << c;
    EXPECT_FALSE(looks(c, {"body_part.expected=any"})) << c;
  }
  EXPECT_FALSE(looks("sample.yaml", {}));
  EXPECT_TRUE(looks("sample.yaml", {"body_part.expected=head"}));
}

// Skull of the sample on coarse voxels: what the explanation foretells is what the run does, before and after.
TEST(OnlyWhatTheSceneRequires, ARunDoesWhatTheExplanationSays) {
  struct Recorder : pipeline::RunObserver {
    void progressed(const std::string& node, double share) override {
      const std::lock_guard<std::mutex> lock(mutex);
      if (node == publish::publishing_step) published.insert(share);
    }
    void finished(const std::string& node, bool is_cached, double, const stages::StageOutcome&) override {
      const std::lock_guard<std::mutex> lock(mutex);
      (is_cached ? cached : computed).insert(node);
    }
    std::mutex mutex;
    std::set<std::string> computed, cached;
    std::set<double> published;  ///< how far publishing said to be
  };
  const ScratchFolder folder;
  publish::RunRequest request;
  request.config = configs / "ct_skull.yaml";
  request.library = folder.path();
  request.overrides.series = fs::path(TREPHINE_SOURCE_DIR) / "sample_dicom";
  request.overrides.set = {"resample.spacing_mm=[3, 3, 3]"};
  request.params.case_token = "skull";
  request.params.pictures = false;
  request.program_version = "test";
  const auto foretold = [&](publish::Explanation::Stage::State state) {
    std::set<std::string> names;
    for (const auto& s : publish::explain_case(request).stages)
      if (s.state == state) names.insert(s.name);
    return names;
  };
  using State = publish::Explanation::Stage::State;
  const std::set<std::string> all = foretold(State::compute);
  EXPECT_EQ(all.size(), 15u);
  Recorder first;
  publish::run_case(request, first);
  EXPECT_EQ(first.computed, all);
  EXPECT_TRUE(first.cached.empty());

  const auto to_compute = foretold(State::compute), cached = foretold(State::cached);
  for (const auto& s : publish::explain_case(request).stages) EXPECT_TRUE(s.seconds.has_value()) << s.name;
  Recorder second;
  publish::run_case(request, second);
  EXPECT_EQ(second.computed, to_compute);
  EXPECT_EQ(second.cached, cached);
  EXPECT_LT(second.computed.size(), first.computed.size());

  // One parameter late in the chain: what stands before it is made again only where that is quicker than to keep it.
  request.overrides.set.push_back("skull.smooth.iterations_count=3");
  Recorder third;
  const auto changed = foretold(State::compute);
  publish::run_case(request, third);
  EXPECT_EQ(third.computed, changed);
  EXPECT_TRUE(changed.count("skull.smooth"));
  EXPECT_TRUE(changed.count("skull.measure"));

  for (const Recorder* r : {&first, &second, &third}) {
    EXPECT_GE(r->published.size(), 5u);
    EXPECT_EQ(*r->published.rbegin(), 1);
    for (auto at = r->published.begin(); std::next(at) != r->published.end(); ++at)
      EXPECT_LT(*std::next(at) - *at, 0.8);
  }
}

}  // namespace
}  // namespace trephine
