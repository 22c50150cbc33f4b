// SPDX-License-Identifier: GPL-3.0-or-later
// Configurations: every fault named at once with line, column and the nearest key; nothing that YAML guesses gets
// through.
#include <gtest/gtest.h>

#include "base/error.h"
#include "meshing/decimate.h"
#include "pipeline/config.h"
#include "pipeline/graph.h"
#include "pipeline/yaml_document.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

const char* const recipe = R"(trephine: 1
anatomies:
  skull:
    stages:
      - segment: {lower_hu: 226}
      - contour
      - decimate: {max_deviation_mm: 0.25}
      - normals
  brain:
    colour_rgb: [0.9, 0.7, 0.7]
    stages:
      - segment: {method: brain, skull: skull.segment}
      - contour
      - normals
)";
const char* const scene = R"(trephine: 1
anatomies:
  skull: {max_triangles: 80000}
)";

struct Files {
  ScratchFolder folder;
  std::filesystem::path config;
  Files(const std::string& case_yaml, const std::string& recipe_yaml = recipe, const std::string& scene_yaml = scene) {
    folder.write("recipe.yaml", recipe_yaml);
    folder.write("scene.yaml", scene_yaml);
    config = folder.write("case.yaml", case_yaml);
  }
};

const std::string head = "trephine: 1\npipeline: recipe.yaml\nscene: scene.yaml\n";

// The lines that the user would see, without the scratch folder's name.
std::vector<std::string> faults(const Files& files, const ConfigOverrides& overrides = {}) {
  std::vector<std::string> lines;
  try {
    read_case_config(files.config, overrides);
  } catch (const ErrorList& e) {
    for (const Error& one : e.all()) {
      EXPECT_EQ(one.code(), ExitCode::bad_config);
      std::string line = one.line("");
      const std::string prefix = ": " + files.folder.path().string() + "/";
      lines.push_back(line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : line);
    }
  }
  return lines;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const DecimateParams& decimation(const CaseConfig& c) {
  return c.find_anatomy("skull")->find_step("decimate")->params.as<DecimateParams>();
}

}  // namespace

TEST(Config, WhatWins) {
  const Files plain(head);
  EXPECT_EQ(decimation(read_case_config(plain.config)).max_deviation_mm, 0.25);
  EXPECT_EQ(decimation(read_case_config(plain.config)).target_triangles_count, 80000);
  const Files set(head + "set: {skull.decimate.max_deviation_mm: 0.5, skull.decimate.target_triangles_count: 5000}\n");
  EXPECT_EQ(decimation(read_case_config(set.config)).max_deviation_mm, 0.5);
  EXPECT_EQ(decimation(read_case_config(set.config)).target_triangles_count, 5000);
  ConfigOverrides overrides;
  overrides.set = {"skull.decimate.max_deviation_mm=0.125"};
  EXPECT_EQ(decimation(read_case_config(set.config, overrides)).max_deviation_mm, 0.125);
}

TEST(Config, TheScenesDeviationIsDecimationsBudgetLessSmoothings) {
  std::string smoothed = recipe;
  smoothed.replace(smoothed.find("      - normals"), 0, "      - smooth: {max_displacement_mm: 0.25}\n");
  const auto scene_with = [](const std::string& mm) {
    return "trephine: 1\nanatomies: {skull: {max_deviation_mm: " + mm + "}}\n";
  };
  EXPECT_EQ(decimation(read_case_config(Files(head, smoothed, scene_with("1.25")).config)).max_deviation_mm, 1);
  EXPECT_TRUE(has(faults(Files(head, smoothed, scene_with("0.25"))).at(0), "must exceed what smooth may move"));
}

TEST(Config, EveryFaultAtOnceWithItsPlaceAndTheNearestKey) {
  const Files files(
      head + "sereis: x\ncase: Has Blanks\nset: {skull.decimate.max_deviaton_mm: 1}\n",
      "trephine: 1\nanatomies:\n  skull:\n    color_rgb: [1, 1, 1]\n    stages:\n      - segment: {lower_hu: 010}\n"
      "      - contuor\n      - contour\n      - decimate: {max_deviation_mm: .nan, target_triangles_count: 12.5}\n",
      "trephine: 1\nanatomies:\n  skul: {}\n");
  const auto lines = faults(files);
  auto expect_fault = [&](const std::string& where, const std::string& key, const std::string& what) {
    for (const std::string& l : lines)
      if (has(l, where) && has(l, key) && has(l, what)) return;
    std::string all;
    for (const std::string& l : lines) all += l + "\n";
    ADD_FAILURE() << where << " " << key << " " << what << " is not among\n" << all;
  };
  expect_fault("case.yaml:4:1", "sereis", "did you mean series?");
  expect_fault("case.yaml:5", "case", "");
  expect_fault("case.yaml:6:7", "skull.decimate.max_deviaton_mm", "did you mean skull.decimate.max_deviation_mm?");
  expect_fault("recipe.yaml:4:5", "color_rgb", "did you mean colour_rgb?");
  expect_fault("recipe.yaml:6", "lower_hu", "010");
  expect_fault("recipe.yaml:7:9", "stages", "did you mean contour?");
  expect_fault("recipe.yaml:9", "max_deviation_mm", ".nan");
  expect_fault("recipe.yaml:9", "target_triangles_count", "12.5");
  expect_fault("scene.yaml:3:3", "skul", "did you mean skull?");
}

TEST(Config, WhatYamlWouldLetThrough) {
  const auto one = [](const std::string& extra) { return faults(Files(head + extra)); };
  EXPECT_TRUE(has(one("case: a\ncase: b\n").at(0), "case.yaml:5:1: case: the key is repeated"));
  EXPECT_TRUE(has(one("set: {skull.decimate.max_deviation_mm: 0,5}\n").at(0), "case.yaml:4"));
  EXPECT_TRUE(has(one("case: &a x\n").at(0), "anchors"));
  EXPECT_TRUE(has(one("case: [\n").at(0), "is not YAML"));
  EXPECT_TRUE(has(one("case: " + std::string(600, '[') + std::string(600, ']') + "\n").at(0), "nested deeper than 32"));
  EXPECT_TRUE(has(one(std::string(10 << 20, '#')).at(0), "larger than 1 MiB"));
  EXPECT_TRUE(has(one(std::string("case: \x01\n")).at(0), "case.yaml:4:1"));
  EXPECT_TRUE(has(one("---\ncase: x\n").at(0), "second document"));
  EXPECT_TRUE(has(faults(Files("- a\n")).at(0), "must hold keys and values"));
  EXPECT_TRUE(has(faults(Files("")).at(0), "must hold keys and values"));
}

TEST(Config, PathsStayUnderTheRoot) {
  ScratchFolder other;
  const auto refused = faults(Files(head + "series: " + other.path().string() + "\n"));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_TRUE(has(refused[0], "leads out of the root"));
  EXPECT_TRUE(has(faults(Files(head + "series: ../../../etc\n")).at(0), "leads out of the root"));
  ConfigOverrides overrides;
  overrides.roots = {other.path()};
  EXPECT_TRUE(faults(Files(head + "series: " + other.path().string() + "\n"), overrides).empty());
  // The root may stand above the configuration.
  Files files(head);
  files.folder.write("trephine.root", "");
  files.folder.write("deep/case.yaml", "trephine: 1\npipeline: ../recipe.yaml\nscene: ../scene.yaml\n");
  EXPECT_NO_THROW(read_case_config(files.folder.path() / "deep/case.yaml"));
}

TEST(Config, PortsNameAnEarlierAnatomysStage) {
  std::string wrong = recipe;
  wrong.replace(wrong.find("skull.segment"), 13, "brain.contour");
  EXPECT_TRUE(has(faults(Files(head, wrong)).at(0), "brain.contour, must be the field of an anatomy before this one"));
  std::string unfinished = "trephine: 1\nanatomies:\n  skull:\n    stages: [segment]\n";
  EXPECT_TRUE(has(faults(Files(head, unfinished)).at(0), "must end in a surface"));
  const std::string empty = "trephine: 1\nanatomies:\n  skull:\n    stages: []\n";
  EXPECT_TRUE(has(faults(Files(head, empty)).at(0), "must end in a surface"));
}

TEST(Graph, HoldsOnlyWhatTheSceneDemands) {
  const Files files(head);
  const Graph skull = make_graph(read_case_config(files.config), "input");
  EXPECT_LT(skull.find("brain.segment"), 0);
  EXPECT_GE(skull.find("skull.normals"), 0);
  // The brain needs the skull's field, but not its surface.
  const Files brain_files(head, recipe, "trephine: 1\nanatomies: {brain: }\n");
  const Graph brain = make_graph(read_case_config(brain_files.config), "input");
  EXPECT_GE(brain.find("skull.segment"), 0);
  EXPECT_LT(brain.find("skull.contour"), 0);
}

TEST(Graph, AKeyChangesWithWhatTheOutputDependsOn) {
  const Files files(head);
  const auto keys = [&](const std::string& set, const std::string& input) {
    ConfigOverrides overrides;
    if (!set.empty()) overrides.set = {set};
    return make_graph(read_case_config(files.config, overrides), input);
  };
  const Graph base = keys("", "input"), again = keys("", "input"), other_input = keys("", "other"),
              other_bound = keys("skull.decimate.max_deviation_mm=0.3", "input");
  for (std::size_t i = 0; i < base.nodes.size(); ++i) {
    EXPECT_EQ(base.nodes[i].key, again.nodes[i].key);
    EXPECT_NE(base.nodes[i].key, other_input.nodes[i].key);
  }
  const auto key = [](const Graph& g, const char* name) { return g.nodes[static_cast<std::size_t>(g.find(name))].key; };
  EXPECT_EQ(key(base, "skull.contour"), key(other_bound, "skull.contour"));
  EXPECT_NE(key(base, "skull.decimate"), key(other_bound, "skull.decimate"));
  EXPECT_NE(key(base, "skull.normals"), key(other_bound, "skull.normals"));
}
