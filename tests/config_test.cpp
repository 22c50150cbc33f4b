// SPDX-License-Identifier: GPL-3.0-or-later
// Configurations: every fault named at once with line, column and the nearest key; nothing that YAML guesses gets
// through.
#include <gtest/gtest.h>

#include "base/error.h"
#include "config/config.h"
#include "config/yaml_document.h"
#include "grid/resample.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "pipeline/graph.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

const char* const recipe = R"(trephine: 1
anatomies:
  skull:
    shows_face: false
    stages:
      - segment: {lower_hu: 226}
      - contour
      - decimate: {max_deviation_mm: 0.25}
      - normals
  brain:
    colour_rgb: [0.9, 0.7, 0.7]
    shows_face: false
    stages:
      - brain: {skull: skull.segment}
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

const std::string beginning = "trephine: 1\npipeline: recipe.yaml\nscene: scene.yaml\n";

// The lines that the user would see, without the scratch folder's name.
std::vector<std::string> faults(const Files& files, const config::ConfigOverrides& overrides = {},
                                ExitCode code = ExitCode::bad_config) {
  std::vector<std::string> lines;
  try {
    config::read_case_config(files.config, overrides);
  } catch (const ErrorList& e) {
    for (const Error& one : e.all()) {
      EXPECT_EQ(one.code(), code);
      std::string line = one.line("");
      const std::string prefix = ": " + files.folder.path().string() + "/";
      lines.push_back(line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : line);
    }
  }
  return lines;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const meshing::DecimateParams& decimation(const config::CaseConfig& c) {
  return c.find_anatomy("skull")->find_step("decimate")->params.as<meshing::DecimateParams>();
}

}  // namespace

TEST(Config, WhatWins) {
  const Files plain(beginning);
  EXPECT_EQ(decimation(config::read_case_config(plain.config)).max_deviation_mm, 0.25);
  EXPECT_EQ(decimation(config::read_case_config(plain.config)).target_triangles_count, 80000);
  const Files set(beginning +
                  "set: {skull.decimate.max_deviation_mm: 0.5, skull.decimate.target_triangles_count: 5000}\n");
  EXPECT_EQ(decimation(config::read_case_config(set.config)).max_deviation_mm, 0.5);
  EXPECT_EQ(decimation(config::read_case_config(set.config)).target_triangles_count, 5000);
  // For a machine that shows half of it.
  const Files half(beginning + "set: {scene.triangles_ratio: 0.5}\n");
  EXPECT_EQ(decimation(config::read_case_config(half.config)).target_triangles_count, 40000);
  EXPECT_EQ(config::read_case_config(half.config).scene.at(0).max_triangles, 40000);
  config::ConfigOverrides overrides;
  overrides.set = {"skull.decimate.max_deviation_mm=0.125"};
  EXPECT_EQ(decimation(config::read_case_config(set.config, overrides)).max_deviation_mm, 0.125);
}

TEST(Config, TheContourHasAShareOfDecimationsBound) {
  const auto shares = [](const std::string& bound, std::vector<std::string> flags = {}) {
    config::ConfigOverrides overrides;
    overrides.set = std::move(flags);
    const std::string scene = "trephine: 1\nanatomies: {skull: {max_deviation_mm: " + bound + "}}\n";
    const config::CaseConfig c = config::read_case_config(Files(beginning, recipe, scene).config, overrides);
    const double used = c.find_anatomy("skull")->find_step("contour")->params.as<meshing::ContourParams>().within_mm;
    EXPECT_EQ(decimation(c).input_within_mm, used);
    return used;
  };
  EXPECT_EQ(shares("1.2"), 1.2 / 8);
  EXPECT_EQ(shares("0.3"), 0);  // a tight bound leaves the contour as it is
  EXPECT_EQ(shares("1.2", {"skull.decimate.max_deviation_mm=0.1"}), 0);
  EXPECT_EQ(shares("1.2", {"skull.decimate.max_deviation_mm=0"}), 0);
  EXPECT_EQ(shares("0.3", {"skull.decimate.max_deviation_mm=2.4"}), 2.4 / 8);
  EXPECT_EQ(shares("1.2", {"skull.contour.within_mm=0"}), 0);
  EXPECT_EQ(shares("0.3", {"skull.contour.within_mm=0.15"}), 0.15);
}

TEST(Config, TheScenesDeviationIsDecimationsBudgetLessSmoothings) {
  std::string smoothed = recipe;
  smoothed.replace(smoothed.find("      - normals"), 0, "      - smooth: {max_displacement_mm: 0.25}\n");
  const auto scene_with = [](const std::string& mm) {
    return "trephine: 1\nanatomies: {skull: {max_deviation_mm: " + mm + "}}\n";
  };
  EXPECT_EQ(
      decimation(config::read_case_config(Files(beginning, smoothed, scene_with("1.25")).config)).max_deviation_mm, 1);
  EXPECT_TRUE(has(faults(Files(beginning, smoothed, scene_with("0.25"))).at(0), "must exceed what smooth may move"));

  // What smoothing may take counts as it is in force at last; a bound that decimation was given by path stays.
  const auto after = [&](const std::string& set, std::vector<std::string> flags = {}) {
    config::ConfigOverrides overrides;
    overrides.set = std::move(flags);
    return decimation(config::read_case_config(Files(beginning + set, smoothed, scene_with("1.25")).config, overrides))
        .max_deviation_mm;
  };
  EXPECT_EQ(after("set: {skull.smooth.max_displacement_mm: 0.5}\n"), 0.75);
  EXPECT_EQ(after("set: {skull.smooth.max_displacement_mm: 0.5}\n", {"skull.smooth.max_displacement_mm=0.75"}), 0.5);
  EXPECT_EQ(after("set: {skull.smooth.max_displacement_mm: 0.5, skull.decimate.max_deviation_mm: 1}\n"), 1);
  EXPECT_EQ(after("", {"skull.decimate.max_deviation_mm=2"}), 2);
  const Files greedy(beginning + "set: {skull.smooth.max_displacement_mm: 1.25}\n", smoothed, scene_with("1.25"));
  const auto refused = faults(greedy);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_TRUE(has(refused[0], "scene.yaml:2") && has(refused[0], "must exceed what smooth may move")) << refused[0];
}

TEST(Config, EveryFaultAtOnceWithItsPlaceAndTheNearestKey) {
  const Files files(
      beginning + "sereis: x\ncase: Has Blanks\nset: {skull.decimate.max_deviaton_mm: 1}\n",
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
  const auto one = [](const std::string& extra) { return faults(Files(beginning + extra)); };
  EXPECT_TRUE(has(one("case: a\ncase: b\n").at(0), "case.yaml:5:1: case: the key is repeated"));
  EXPECT_TRUE(has(one("set: {skull.decimate.max_deviation_mm: 0,5}\n").at(0), "case.yaml:4"));
  EXPECT_TRUE(has(one("case: &a x\n").at(0), "anchors"));
  EXPECT_TRUE(has(one("case: [\n").at(0), "case.yaml:4:7: is not YAML: the brace or bracket that opens here"));
  EXPECT_TRUE(has(one("case: a\nset: {skull.decimate.max_deviation_mm: 0.3\n\n").at(0), "case.yaml:5:6: is not YAML"));
  EXPECT_TRUE(has(one("case: a: b\n").at(0), "case.yaml:4:8: is not YAML: "));
  EXPECT_TRUE(has(one("case: " + std::string(600, '[') + std::string(600, ']') + "\n").at(0), "nested deeper than 32"));
  EXPECT_TRUE(has(one(std::string(10 << 20, '#')).at(0), "larger than 1 MiB"));
  EXPECT_TRUE(has(one(std::string("case: \x01\n")).at(0), "case.yaml:4:1"));
  EXPECT_TRUE(has(one("---\ncase: x\n").at(0), "second document"));
  EXPECT_TRUE(has(faults(Files("- a\n")).at(0), "must hold keys and values"));
  EXPECT_TRUE(has(faults(Files("")).at(0), "must hold keys and values"));
}

TEST(Config, TextThatIsNotUtf8AndTagsAnywhereAreRefused) {
  const auto one = [](const std::string& extra) { return faults(Files(beginning + extra)).at(0); };
  EXPECT_TRUE(has(one("case: a\nseries: b\xff\n"), "case.yaml:5:10: is not UTF-8"));
  EXPECT_TRUE(has(one("case: \xc0\xaf\n"), "is not UTF-8")) << "overlong";
  EXPECT_TRUE(has(one("case: \xed\xa0\x80\n"), "is not UTF-8")) << "a surrogate";
  EXPECT_TRUE(has(one("case: \xf4\x90\x80\x80\n"), "is not UTF-8")) << "above U+10FFFF";
  EXPECT_TRUE(has(one("case: \xe2\x82"), "is not UTF-8")) << "cut short";
  EXPECT_TRUE(faults(Files(beginning + "# \xc3\xbc \xe2\x82\xac \xf0\x9f\xa7\xa0\n")).empty());
  EXPECT_TRUE(has(one("case: !str x\n"), "tags"));
  EXPECT_TRUE(has(one("set: !!map {a: b}\n"), "tags"));
  EXPECT_TRUE(has(one("landmarks: {nasion: !point [1, 2, 3]}\n"), "tags"));
}

TEST(Config, FaultsOfAllFilesJoinAlsoWhereOneCannotBeParsed) {
  const auto lines = faults(Files(beginning + "sereis: x\n", "trephine: [\n", "trephine: 1\ntrephine: 1\n"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_TRUE(has(lines[0], "case.yaml:4:1: sereis"));
  EXPECT_TRUE(has(lines[1], "recipe.yaml:") && has(lines[1], "is not YAML"));
  EXPECT_TRUE(has(lines[2], "scene.yaml:2:1: trephine: the key is repeated"));
  const Files files("trephine: 1\npipeline: recipe.yaml\nscene: nowhere.yaml\nsereis: x\n");
  try {
    config::read_case_config(files.config);
    FAIL() << "no error";
  } catch (const ErrorList& e) {
    ASSERT_EQ(e.all().size(), 2u);
    EXPECT_EQ(e.all()[1].code(), ExitCode::no_input);
  }
}

TEST(Config, ARecipeSaysOfEveryAnatomyWhetherItShowsAFace) {
  std::string silent = recipe;
  silent.erase(silent.find("    shows_face: false\n"), 22);
  EXPECT_TRUE(has(faults(Files(beginning, silent)).at(0), "anatomies.skull.shows_face: is missing"));
  const std::string blank = "face: {policy: keep, reason: '  '}\n";
  EXPECT_TRUE(has(faults(Files(beginning, recipe, scene + blank)).at(0), "scene.yaml:4:30: face.reason: is blank"));
}

TEST(Config, TheOrderOfKeysInAFileSaysNothing) {
  // Roles name anatomies, shapes name materials: both may stand before what they name.
  const std::string roles = "burr_holes: {bone: skull}\nclass_of: skull\nresample: {spacing_mm: [2, 2, 2]}\n";
  std::string first = recipe;
  first.insert(first.find("anatomies:"), roles);
  const config::CaseConfig before = config::read_case_config(Files(beginning, first).config),
                           after = config::read_case_config(Files(beginning, recipe + roles).config);
  EXPECT_EQ(before.roles.class_of, "skull");
  EXPECT_EQ(before.roles.burr_holes.bone, after.roles.burr_holes.bone);
  ASSERT_EQ(before.scan_steps.size(), 2u);  // with the look at the part of the body, which every recipe has
  EXPECT_EQ(before.scan_steps[1].params.as<grid::ResampleParams>().spacing_mm[2], 2);
  std::string wrong = first;
  wrong.replace(wrong.find("bone: skull"), 11, "bone: skul");
  EXPECT_TRUE(has(faults(Files(beginning, wrong)).at(0), "did you mean skull?"));
  wrong.replace(wrong.find("bone: skul"), 10, "bone: skull, ovr: skull");
  EXPECT_TRUE(has(faults(Files(beginning, wrong)).at(0), "burr_holes.ovr: unknown key, did you mean over?"));
}

TEST(Config, AStepIsSaidOnceWithItsParametersAndPorts) {
  const auto with = [](const std::string& stages) {
    return faults(
        Files(beginning, "trephine: 1\nanatomies:\n  skull:\n    shows_face: false\n    stages: [" + stages + "]\n"));
  };
  EXPECT_TRUE(has(with("segment, contour, contour").at(0), "contour, is there already"));
  EXPECT_TRUE(has(with("segment, contour: {iso: 1}").at(0), "anatomies.skull.stages.contour.iso: unknown key"));
  EXPECT_TRUE(has(with("segment, [contour]").at(0), "each item is `- name`"));
  EXPECT_TRUE(has(with("ventricles, contour").at(0), "anatomies.skull.stages.ventricles.brain: is missing"));
  EXPECT_TRUE(has(with("segment: {within: 3}, contour").at(0), "3, must be the field of an anatomy"));
  EXPECT_TRUE(with("segment: , contour: null").empty());
  const std::string nothing = "trephine: 1\nanatomies:\n  skull:\n";
  EXPECT_TRUE(has(faults(Files(beginning, nothing)).at(0), "anatomies.skull: must hold keys and values"));
}

TEST(Config, AQuotedNumberIsAText) {
  const auto one = [](const std::string& extra) { return faults(Files(beginning + extra)); };
  EXPECT_TRUE(
      has(one("import: {max_gap_mm: \"3\"}\n").at(0), "case.yaml:4:22: import.max_gap_mm: 3, must be a number"));
  EXPECT_TRUE(has(one("import: {max_gap_mm: '3'}\n").at(0), "without quotes"));
  EXPECT_TRUE(has(one("landmarks: {nasion: [1, '2', 3]}\n").at(0), "without quotes"));
  EXPECT_TRUE(one("case: '1'\n").empty());
  EXPECT_TRUE(one("set: {skull.decimate.max_deviation_mm: '0.5'}\n").empty());
}

TEST(Config, AValueBelowSetIsReportedOnce) {
  const auto lines = faults(Files(beginning + "set: {skull.decimate: {max_deviation_mm: 1}, import.max_gap_mm: }\n"));
  ASSERT_EQ(lines.size(), 2u) << lines[0];
  for (const std::string& line : lines) EXPECT_TRUE(has(line, "must be a value or a list of values")) << line;
}

TEST(Config, ADecimalCommaIsAnsweredWithThePoint) {
  const auto lines = faults(Files(beginning + "set: {skull.decimate.max_deviation_mm: 0,3}\n"));
  ASSERT_EQ(lines.size(), 1u) << lines[0];
  EXPECT_TRUE(has(lines[0], "set.3: must be a value") && has(lines[0], "a point, no comma")) << lines[0];
}

TEST(Config, ACountIsAWholeNumber) {
  const auto one = [](const std::string& count) {
    return faults(Files(beginning, recipe, "trephine: 1\nanatomies: {skull: {max_triangles: " + count + "}}\n")).at(0);
  };
  EXPECT_TRUE(has(one("1000.5"), "max_triangles: 1000.5, must be a whole number from 4 to 100,000,000"));
  EXPECT_TRUE(has(one("3"), "must be a whole number"));
}

TEST(Config, OverridesReachTheImportAndTheirFaultsAreUsage) {
  const auto with = [](std::vector<std::string> set) {
    config::ConfigOverrides overrides;
    overrides.set = std::move(set);
    return overrides;
  };
  const Files files(beginning);
  EXPECT_EQ(config::read_case_config(files.config, with({"import.series=s1"})).import.series, "s1");
  const Files in_file(beginning + "set: {import.max_gap_mm: 5}\n");
  EXPECT_EQ(config::read_case_config(in_file.config).import.max_gap_mm, 5);
  const auto one = [&](const std::string& set) {
    const auto lines = faults(files, with({set}), ExitCode::usage);
    return lines.size() == 1 ? lines[0] : "not one line";
  };
  EXPECT_EQ(one("skull.decimate.max_deviation_mm"),
            ": --set: skull.decimate.max_deviation_mm, must be anatomy.stage.parameter=value");
  EXPECT_EQ(one("skull.decimate.max_deviaton_mm=1"),
            ": --set skull.decimate.max_deviaton_mm: no such parameter, did you mean skull.decimate.max_deviation_mm?");
  EXPECT_TRUE(has(one("import.max_gap_mm=x"), ": --set import.max_gap_mm: x, "));
}

TEST(Config, PathsStayUnderTheRoot) {
  ScratchFolder other;
  const auto refused = faults(Files(beginning + "series: " + other.path().string() + "\n"));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_TRUE(has(refused[0], "leads out of the root"));
  EXPECT_TRUE(has(faults(Files(beginning + "series: ../../../etc\n")).at(0), "leads out of the root"));
  config::ConfigOverrides overrides;
  overrides.roots = {other.path()};
  EXPECT_TRUE(faults(Files(beginning + "series: " + other.path().string() + "\n"), overrides).empty());
  // The root may stand above the configuration.
  Files files(beginning);
  files.folder.write("trephine.root", "");
  files.folder.write("deep/case.yaml", "trephine: 1\npipeline: ../recipe.yaml\nscene: ../scene.yaml\n");
  EXPECT_NO_THROW(config::read_case_config(files.folder.path() / "deep/case.yaml"));
}

TEST(Config, NoPathOfAFileLeavesTheRootByALinkOrByWhatDoesNotExist) {
  namespace fs = std::filesystem;
  ScratchFolder other;
  other.write("recipe.yaml", recipe);
  const auto said = [&](const std::string& path) {
    Files files(beginning);
    fs::create_directory_symlink(other.path(), files.folder.path() / "out");
    fs::create_directory_symlink("loop", files.folder.path() / "loop");
    fs::create_directory_symlink(".", files.folder.path() / "here");
    files.folder.write("case.yaml", "trephine: 1\npipeline: \"" + path + "\"\nscene: scene.yaml\n");
    const auto all = faults(files);
    return all.empty() ? std::string() : all.at(0);
  };
  EXPECT_EQ(said("recipe.yaml"), "");
  EXPECT_EQ(said("here/./here/recipe.yaml"), "") << "a link within the root";
  EXPECT_TRUE(has(said("out/recipe.yaml"), "leads out of the root"));
  EXPECT_TRUE(has(said("x/../out/recipe.yaml"), "goes up again from x, which does not exist"));
  EXPECT_TRUE(has(said("here/../out/recipe.yaml"), "leads out of the root"));
  EXPECT_TRUE(has(said("recipe.yaml\\0/../x"), "NUL")) << said("recipe.yaml\\0/../x");
  EXPECT_TRUE(has(said("loop/recipe.yaml"), "in a circle"));
  EXPECT_TRUE(has(said(std::string(300, 'n') + "/recipe.yaml"), "too long"));
  std::string deep;
  for (int i = 0; i < 3000; ++i) deep += "d/";
  EXPECT_TRUE(has(said(deep + "recipe.yaml"), "too long"));
}

TEST(Config, PortsNameAnEarlierAnatomysStage) {
  std::string wrong = recipe;
  wrong.replace(wrong.find("skull.segment"), 13, "brain.contour");
  EXPECT_TRUE(
      has(faults(Files(beginning, wrong)).at(0), "brain.contour, must be the field of an anatomy before this one"));
  std::string unfinished = "trephine: 1\nanatomies:\n  skull:\n    shows_face: false\n    stages: [segment]\n";
  EXPECT_TRUE(has(faults(Files(beginning, unfinished)).at(0), "must end in a surface"));
  const std::string empty = "trephine: 1\nanatomies:\n  skull:\n    shows_face: false\n    stages: []\n";
  EXPECT_TRUE(has(faults(Files(beginning, empty)).at(0), "must end in a surface"));
}

TEST(Graph, HoldsOnlyWhatTheSceneDemands) {
  const Files files(beginning);
  const pipeline::Graph skull = pipeline::make_graph(config::read_case_config(files.config), "input");
  EXPECT_LT(skull.find("brain.brain"), 0);
  EXPECT_GE(skull.find("skull.normals"), 0);
  // The brain needs the skull's field, but not its surface.
  const Files brain_files(beginning, recipe, "trephine: 1\nanatomies: {brain: }\n");
  const pipeline::Graph brain = pipeline::make_graph(config::read_case_config(brain_files.config), "input");
  EXPECT_GE(brain.find("skull.segment"), 0);
  EXPECT_LT(brain.find("skull.contour"), 0);
}

TEST(Graph, AKeyChangesWithWhatTheOutputDependsOn) {
  const Files files(beginning);
  const auto keys = [&](const std::string& set, const std::string& input) {
    config::ConfigOverrides overrides;
    if (!set.empty()) overrides.set = {set};
    return pipeline::make_graph(config::read_case_config(files.config, overrides), input);
  };
  const pipeline::Graph base = keys("", "input"), again = keys("", "input"), other_input = keys("", "other"),
                        other_bound = keys("skull.decimate.max_deviation_mm=0.3", "input");
  for (std::size_t i = 0; i < base.nodes.size(); ++i) {
    EXPECT_EQ(base.nodes[i].key, again.nodes[i].key);
    EXPECT_NE(base.nodes[i].key, other_input.nodes[i].key);
  }
  const auto key = [](const pipeline::Graph& g, const char* name) {
    return g.nodes[static_cast<std::size_t>(g.find(name))].key;
  };
  EXPECT_EQ(key(base, "skull.contour"), key(other_bound, "skull.contour"));
  EXPECT_NE(key(base, "skull.decimate"), key(other_bound, "skull.decimate"));
  EXPECT_NE(key(base, "skull.normals"), key(other_bound, "skull.normals"));
}
