// SPDX-License-Identifier: GPL-3.0-or-later
// The recipes and scenes of spine and chest; on real scans where they are unpacked
// (${TREPHINE_DATA:-$HOME/.cache/trephine-data}; skipped, with a message, where not).
#include <gtest/gtest.h>

#include <cstdlib>

#include "base/error.h"
#include "cases/case.h"
#include "publish/other_config.h"
#include "publish/run_case.h"
#include "publish/verdict.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

std::filesystem::path shipped(const std::string& name) {
  return std::filesystem::path(TREPHINE_SOURCE_DIR) / "configs" / name;
}

TEST(Recipes, OfSpineAndChestHaveTheirAnatomiesAndShowNoFace) {
  const std::map<std::string, std::vector<std::string>> scenes = {
      {"ct_spine.yaml", {"skin", "bone", "canal"}},
      {"ct_spine_bone.yaml", {"bone", "canal"}},
      {"ct_chest.yaml", {"skin", "clavicle", "lung", "pleura", "vein", "other_bone"}},
      {"ct_chest_bone.yaml", {"skin", "bone"}},
  };
  for (const auto& [name, anatomies] : scenes) {
    const config::CaseConfig c = config::read_case_config(shipped(name));
    for (const config::RecipeAnatomy& a : c.anatomies) EXPECT_FALSE(a.shows_face) << name << " " << a.name;
    std::vector<std::string> wanted;
    for (const config::SceneAnatomy& a : c.scene) wanted.push_back(a.name);
    EXPECT_EQ(wanted, anatomies) << name;
    EXPECT_EQ(c.import.clamp_low_hu, -1024) << name;
    EXPECT_EQ(c.face, "") << name;
  }
}

// A chest's bone is a step on the way to its clavicles and the rest: what speaks against it speaks against these.
TEST(Recipes, WhatSpeaksAgainstAStepSpeaksAgainstWhatIsMadeOfIt) {
  const auto heirs = [](const char* name, const char* anatomy) {
    const config::CaseConfig config = config::read_case_config(shipped(name));
    std::vector<std::string> all = publish::heirs_of(anatomy, pipeline::make_graph(config, ""), config);
    std::sort(all.begin(), all.end());
    return all;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(heirs("ct_chest.yaml", "bone"), (Names{"clavicle", "other_bone", "vein"}));
  EXPECT_EQ(heirs("ct_chest.yaml", "clavicle"), Names{"clavicle"});
  EXPECT_EQ(heirs("ct_chest_bone.yaml", "bone"), Names{"bone"});
  EXPECT_EQ(heirs("ct_skull.yaml", "skin"), Names{}) << "the skin only says where the head is";
  EXPECT_EQ(heirs("ct_head.yaml", "nothing_of_that_name"), Names{});
  EXPECT_EQ(heirs("ct_head.yaml", ""), Names{""}) << "about all of them";
}

TEST(Recipes, ARefusedAnatomyNamesTheConfigurationThatDoesWithout) {
  const config::CaseConfig spine = config::read_case_config(shipped("ct_spine.yaml"));
  EXPECT_EQ(publish::configs_without(shipped("ct_spine.yaml"), spine, "skin"),
            std::vector<std::string>{"ct_spine_bone.yaml"});
  EXPECT_EQ(publish::configs_without(shipped("ct_spine.yaml"), spine, "bone"), std::vector<std::string>());
  Error skin(ExitCode::quality, "", "max_scan_edge_ratio", "97 % of its rim");
  skin.in_stage("skin.segment");
  const std::optional<Error> told = publish::with_other_configs(skin, shipped("ct_spine.yaml"), spine);
  ASSERT_TRUE(told);
  EXPECT_EQ(std::string(told->what()), "97 % of its rim; a case without skin is made by ct_spine_bone.yaml");
  EXPECT_EQ(told->field(), skin.field());
  Error input(ExitCode::bad_input, "", "", "is empty");
  input.in_stage("skin.segment");
  EXPECT_FALSE(publish::with_other_configs(input, shipped("ct_spine.yaml"), spine));
}

using Nobody = pipeline::RunObserver;

/// Makes the case of a real scan; its manifest.
cases::CaseManifest made_of(const char* config, const char* data, const ScratchFolder& folder) {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  publish::RunRequest r;
  r.config = shipped(config);
  r.overrides.series =
      std::filesystem::path(own ? own : std::string(home ? home : "") + "/.cache/trephine-data") / data;
  if (!std::filesystem::exists(r.overrides.series)) return {};
  r.library = folder.path();
  r.params.case_token = "real";
  r.params.use_cache = false;
  r.params.pictures = false;
  r.program_version = "test";
  Nobody nobody;
  return cases::read_case(publish::run_case(r, nobody).case_folder);
}
#define NEEDS(manifest) \
  if ((manifest).case_token.empty()) GTEST_SKIP() << "no real data"

void expect_volume(const cases::CaseManifest& m, const char* anatomy, double low_ml, double high_ml) {
  const cases::CaseAnatomy* a = m.find_anatomy(anatomy);
  ASSERT_NE(a, nullptr);
  EXPECT_GT(a->volume_ml, low_ml) << anatomy;
  EXPECT_LT(a->volume_ml, high_ml) << anatomy;
  EXPECT_LT(a->deviation.max_mm, a->budget_asked_mm) << anatomy;
}

TEST(LongRecipes, ALumbarSpineIsWholeAndItsFieldOfViewHoldsNoSkin) {
  const ScratchFolder folder;
  const cases::CaseManifest m = made_of("ct_spine_bone.yaml", "spine_lumbar_hitachi", folder);
  NEEDS(m);
  // Three osteoporotic vertebrae and parts of others: 87 to 100 ml where their bodies stay hollow.
  expect_volume(m, "bone", 140, 165);
  expect_volume(m, "canal", 33, 46);  // 100 mm of 350 to 450 mm^2
  try {
    made_of("ct_spine.yaml", "spine_lumbar_hitachi", folder);
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(e.field().find("max_scan_edge_ratio"), std::string::npos) << e.what() << " " << e.field();
    EXPECT_NE(std::string(e.what()).find("ct_spine_bone.yaml"), std::string::npos) << e.what();
  }
}

TEST(LongRecipes, AChestHasItsBonesAndNoCouchInItsSkin) {
  const ScratchFolder folder;
  const cases::CaseManifest m = made_of("ct_chest.yaml", "chest_clavicle_LIDC-0314_top80", folder);
  NEEDS(m);
  expect_volume(m, "other_bone", 340, 410);
  expect_volume(m, "clavicle", 36, 48);
  expect_volume(m, "vein", 10, 20);      // no contrast medium: estimated
  expect_volume(m, "skin", 4700, 4800);  // with the mat and what lies between it and the back: 4834
}

}  // namespace
}  // namespace trephine
