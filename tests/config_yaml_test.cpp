// SPDX-License-Identifier: GPL-3.0-or-later
// Configurations are changed as a person would: what is not asked for stays, byte for byte.
#include <gtest/gtest.h>

#include "base/error.h"
#include "config/yaml_edit.h"

namespace trephine {
namespace {

std::string edited(const std::string& text, const std::vector<std::string>& path,
                   const std::optional<std::string>& value) {
  return config::edited_yaml(text, {{path, value}}, "case.yaml");
}

const std::string sample =
    "# The sample case.\n"
    "trephine: 1\n"
    "series: ../sample_dicom   # where it lies\n"
    "landmarks:  # mm, LPS\n"
    "  nasion: [0, -93.2, 40.1]\n"
    "  inion: [0, 89.4, 5.8]  # by hand\n"
    "set: {skull.segment.lower_hu: 300}\n";

TEST(ConfigYaml, AValueIsReplacedWhereItStands) {
  EXPECT_EQ(edited(sample, {"landmarks", "nasion"}, "[1, 2, 3]"),
            "# The sample case.\ntrephine: 1\nseries: ../sample_dicom   # where it lies\nlandmarks:  # mm, LPS\n"
            "  nasion: [1, 2, 3]\n  inion: [0, 89.4, 5.8]  # by hand\nset: {skull.segment.lower_hu: 300}\n");
}

TEST(ConfigYaml, AKeyIsAddedAfterTheLastOfItsMap) {
  EXPECT_EQ(edited(sample, {"landmarks", "tragus_left"}, "[77, 0, 0]"),
            "# The sample case.\ntrephine: 1\nseries: ../sample_dicom   # where it lies\nlandmarks:  # mm, LPS\n"
            "  nasion: [0, -93.2, 40.1]\n  inion: [0, 89.4, 5.8]  # by hand\n  tragus_left: [77, 0, 0]\n"
            "set: {skull.segment.lower_hu: 300}\n");
  EXPECT_EQ(edited("trephine: 1", {"corrections", "skull"}, "a.nrrd"), "trephine: 1\ncorrections: {skull: a.nrrd}\n");
  EXPECT_EQ(edited("a: {b: 1}\n", {"a", "c"}, "2"), "a: {b: 1, c: 2}\n");
  EXPECT_EQ(edited("a: {}\n", {"a", "c"}, "2"), "a: {c: 2}\n");
  EXPECT_EQ(edited("a:\nb: 1\n", {"a", "c"}, "2"), "a: {c: 2}\nb: 1\n");
}

TEST(ConfigYaml, AKeyGoesAndAnEmptyMapWithIt) {
  EXPECT_EQ(edited(sample, {"set", "skull.segment.lower_hu"}, {}), sample.substr(0, sample.find("set:")));
  EXPECT_EQ(edited("a: {b: 1, c: 2}\n", {"a", "c"}, {}), "a: {b: 1}\n");
  EXPECT_EQ(edited("a: {b: 1, c: 2}\n", {"a", "b"}, {}), "a: {c: 2}\n");
  EXPECT_EQ(edited("a:\n  b: 1\n  c: 2\nd: 3\n", {"a", "b"}, {}), "a:\n  c: 2\nd: 3\n");
}

TEST(ConfigYaml, ListsOfMapsGetKeysAndItems) {
  const std::string list = "cases:\n  - case: a  # first\n    series: s/a\n  - {case: b, series: s/b}\nx: 1\n";
  EXPECT_EQ(edited(list, {"cases", "0", "config"}, "a.yaml"),
            "cases:\n  - case: a  # first\n    series: s/a\n    config: a.yaml\n  - {case: b, series: s/b}\nx: 1\n");
  EXPECT_EQ(edited(list, {"cases", "1", "config"}, "b.yaml"),
            "cases:\n  - case: a  # first\n    series: s/a\n  - {case: b, series: s/b, config: b.yaml}\nx: 1\n");
  EXPECT_EQ(edited(list, {"cases", "+"}, "{case: c}"),
            "cases:\n  - case: a  # first\n    series: s/a\n  - {case: b, series: s/b}\n  - {case: c}\nx: 1\n");
  EXPECT_EQ(edited("a: [1, 2]\n", {"a", "+"}, "3"), "a: [1, 2, 3]\n");
  EXPECT_EQ(edited("trephine: 1\n", {"cases", "+"}, "{case: c}"), "trephine: 1\ncases: [{case: c}]\n");
}

TEST(ConfigYaml, ABlockBecomesOneLine) {
  EXPECT_EQ(edited("burr_holes:\n  - at: kocher\n    side: right\nx: 1\n", {"burr_holes"}, "[{at: kocher}]"),
            "burr_holes: [{at: kocher}]\nx: 1\n");
}

TEST(ConfigYaml, QuotesAndCommentsDoNotConfuseIt) {
  EXPECT_EQ(edited("a: {b: \"x, } y\", c: 'it''s'}  # {\n", {"a", "d"}, "1"),
            "a: {b: \"x, } y\", c: 'it''s', d: 1}  # {\n");
  EXPECT_EQ(edited("a: {b: it's, c: 2}\n", {"a", "c"}, "3"), "a: {b: it's, c: 3}\n");
  EXPECT_EQ(edited("a: [1, # one ]\n  2]\n", {"a", "+"}, "3"), "a: [1, # one ]\n  2, 3]\n");
  EXPECT_EQ(edited("ä: \"ü\"\nb: {ö: 1, c: 2}\n", {"b", "c"}, "3"), "ä: \"ü\"\nb: {ö: 1, c: 3}\n");
}

// What it does not understand it leaves alone, and says so.
TEST(ConfigYaml, WhatIsNotUnderstoodIsRefusedAndNotSpoilt) {
  const auto refused = [](const std::string& text, const std::vector<std::string>& path,
                          const std::optional<std::string>& to) {
    try {
      edited(text, path, to);
    } catch (const Error& e) {
      return e.code() == ExitCode::bad_config;
    }
    return false;
  };
  EXPECT_TRUE(refused("a: one\n  two\nb: 1\n", {"a"}, "3"));  // a text of several lines
  EXPECT_TRUE(refused("a: |\n  text\nb: 1\n", {"a"}, "3"));   // a block of text
  EXPECT_TRUE(refused("a: 1\n", {"a", "b"}, "3"));            // a number is no map
  EXPECT_TRUE(refused("a: 1\n", {"b"}, {}));                  // not there
  EXPECT_TRUE(refused("a: 1\n", {"b"}, "[1"));                // the value is no YAML
  EXPECT_TRUE(refused("a: 1\n", {"b"}, "1\nc: 2"));           // a value that would be two keys
  EXPECT_TRUE(refused("- 1\n", {"b"}, "1"));                  // no configuration
}

TEST(ConfigYaml, TextsAreQuotedWhereTheyMust) {
  for (const std::string text : {"a", "a b", "null", "~", "a: b", "x\"y\\z", "- a", "#c", "[1]", ""}) {
    const std::string made = "k: " + config::yaml_scalar(text) + "\n";
    EXPECT_EQ(edited(made, {"z"}, "1"), made + "z: 1\n") << text;
  }
  EXPECT_EQ(config::yaml_list({0, -93.2, 1e-7}), "[0, -93.2, 1e-07]");
}

}  // namespace
}  // namespace trephine
