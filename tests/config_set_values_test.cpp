// SPDX-License-Identifier: GPL-3.0-or-later
// What is set by path, with `set` or --set, passes the checks that hold for what stands in the files.
#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "config/config.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;
const fs::path configs = fs::path(TREPHINE_SOURCE_DIR) / "configs";

// The lines of the faults, with their codes in front.
std::string faults_of(const fs::path& file, std::vector<std::string> set) {
  config::ConfigOverrides overrides;
  overrides.set = std::move(set);
  std::string all;
  try {
    config::read_case_config(file, overrides);
  } catch (const ErrorList& e) {
    for (const Error& one : e.all()) all += std::to_string(int(one.code())) + one.line("") + "\n";
  }
  return all;
}

TEST(SetValues, NamesAreThoseOfTheRecipe) {
  for (const std::string path : {"haptic.region_of", "haptic.shapes.skin.clear_of"})
    EXPECT_NE(faults_of(configs / "sample.yaml", {path + "=skinn"}).find("64: --set " + path + ": skinn, the pipeline"),
              std::string::npos)
        << path << faults_of(configs / "sample.yaml", {path + "=skinn"});
  EXPECT_EQ(faults_of(configs / "sample.yaml", {"haptic.region_of=skin"}), "");
}

TEST(SetValues, ThousandsOfUnknownPathsTakeNoTime) {
  ScratchFolder folder;
  const auto seconds = [&](int count, std::size_t told) {
    std::ofstream file(folder.path() / "c.yaml");
    file << "trephine: 1\nseries: s\npipeline: p.yaml\nscene: s.yaml\nset:\n";
    for (int i = 0; i < count; ++i) file << "  skul.segment.lower_h" << i << ": 1\n";
    file.close();
    const std::clock_t begin = std::clock();
    try {
      config::read_case_config(folder.path() / "c.yaml", {});
      ADD_FAILURE() << "read";
    } catch (const ErrorList& e) {
      EXPECT_EQ(e.all().size(), told) << count;
      for (const Error& one : e.all()) EXPECT_EQ(one.code(), ExitCode::bad_config);
    }
    return double(std::clock() - begin) / CLOCKS_PER_SEC;
  };
  std::ofstream(folder.path() / "trephine.root").close();
  fs::copy_file(fs::path(TREPHINE_SOURCE_DIR) / "pipelines/ventriculostomy.yaml", folder.path() / "p.yaml");
  std::ofstream(folder.path() / "s.yaml")
      << "trephine: 1\nanatomies: {skull: }\nface: {policy: keep, reason: synthetic}\n";
  EXPECT_LT(seconds(9000, 21), 5);   // the first 20, and how many more: it took 6 s and more
  EXPECT_LT(seconds(30000, 1), 10);  // of 60,000 it took over 60 s
}

TEST(SetValues, TogetherTheyAreSoundOrRefused) {
  EXPECT_NE(faults_of(configs / "sample.yaml", {"haptic.hardness_low_hu=500"}).find("hardness_high_hu"),
            std::string::npos);
  EXPECT_EQ(faults_of(configs / "sample.yaml", {"haptic.hardness_low_hu=500", "haptic.hardness_high_hu=900"}), "");
  EXPECT_NE(faults_of(configs / "sample.yaml", {"haptic.encoding=hu"}).find("window_hu"), std::string::npos);
}

TEST(SetValues, AFaceIsNotKeptWithoutAReason) {
  const fs::path defaced = configs / "ct_head_defaced.yaml";
  EXPECT_EQ(faults_of(defaced, {}), "");
  EXPECT_NE(faults_of(defaced, {"scene.face.policy=keep"}).find("why may the case show"), std::string::npos);
  EXPECT_NE(faults_of(defaced, {"scene.face.policy=keep", "scene.face.reason= "}).find("blank"), std::string::npos);
  EXPECT_EQ(faults_of(defaced, {"scene.face.policy=keep", "scene.face.reason=A phantom."}), "");
  EXPECT_NE(faults_of(defaced, {"deface.policy=crop"}).find("follows scene.face.policy"), std::string::npos);
}

TEST(SetValues, WhatHasBeenReadAlreadyIsNotSet) {
  EXPECT_NE(faults_of(configs / "sample.yaml", {"scene.materials=other.yaml"}).find("is read with the scene"),
            std::string::npos);
  EXPECT_NE(faults_of(configs / "sample_drilled.yaml", {"burr_hole_1.name=other"}).find("where the burr hole is given"),
            std::string::npos);
}

TEST(SetValues, AShorterOrLongerPathIsAnsweredWithTheWholeOne) {
  for (const char* path : {"diameter_mm=12", "burr_holes.burr_hole_1.diameter_mm=12"})
    EXPECT_NE(faults_of(configs / "sample_drilled.yaml", {path}).find("did you mean burr_hole_1.diameter_mm?"),
              std::string::npos)
        << faults_of(configs / "sample_drilled.yaml", {path});
  EXPECT_NE(
      faults_of(configs / "sample_drilled.yaml", {"along_mm=1"}).find("burr_hole_1.along_mm or landmarks.along_mm"),
      std::string::npos);
  EXPECT_NE(faults_of(configs / "sample_drilled.yaml", {"what=1"}).find("scene.key or burr_hole_1.parameter"),
            std::string::npos);
}

// The origin of each value of a burr hole is the file that gives it.
TEST(SetValues, ABurrHolesValuesComeFromTheCase) {
  const config::CaseConfig config = config::read_case_config(configs / "sample_drilled.yaml");
  int from_the_case = 0;
  for (const config::ValueRow& row : config.values)
    if (row.path.rfind("burr_hole_1.", 0) == 0) from_the_case += row.origin.source == config::ValueSource::set;
  EXPECT_GE(from_the_case, 3);
}

}  // namespace
}  // namespace trephine
