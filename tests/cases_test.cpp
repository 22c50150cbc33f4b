// SPDX-License-Identifier: GPL-3.0-or-later
// case.json: what is written is read exactly, and what is damaged or hostile is refused.
#include "cases/case.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "base/error.h"
#include "base/hash.h"
#include "cases_manifest.h"

namespace trephine {
namespace {

using cases_test::sample_manifest;

// With everything that a case can hold.
cases::CaseManifest full_manifest() {
  cases::CaseManifest m = sample_manifest();
  cases::CaseShape skin, skull;
  skin.name = "skin";
  skin.number = 1;
  skin.window_low = 1001;
  skin.window_high = 1555;
  skin.material.name = "scalp";
  skin.material.front = {true, 0.5, 0.001, 0.3, 0.2, 2.5};
  skin.material.back.touchable = false;
  skin.material.drag_n_s_per_mm = 0.01;
  skin.displayed = "haptic";
  skin.cuttable = true;
  skull.name = "skull";
  skull.number = 3;
  skull.window_low = 3001;
  skull.window_high = 3555;
  skull.material.name = "bone";
  skull.material.front.stiffness_n_per_mm = 0.8;
  skull.material.back.touchable = false;
  skull.material.removal_energy_j_per_mm3 = 0.05;
  skull.volume_ml = 512.25;
  skull.mismatch = {0.01, 0.1, 0.25, 0.5, 0.001, 70000};
  m.files = {{"haptic-0123456789abcdef.nrrd", sha256_of_bytes("h"), 12345},
             {"hardness-0123456789abcdef.nrrd", sha256_of_bytes("d"), 1234},
             {"meshes/skull-0123456789abcdef.glb", sha256_of_bytes("g"), 123}};
  m.anatomies[0].file = m.files[2].name;
  m.haptic.file = m.files[0].name;
  m.haptic.hardness_file = m.files[1].name;
  m.haptic.encoding = "occupancy";
  m.haptic.size = {10, 20, 30};
  m.haptic.spacing_mm = {0.5, 0.5, 1};
  m.haptic.shapes = {skin, skull};
  m.burr_holes[0].cut = {"skull", "skin"};
  m.missing = {{"brainstem", "where it lies is not sure"}};
  m.stand_ins = {{"brain", "simple_brain", "noise of 28 HU in a cube of 2 mm"}};
  return m;
}

TEST(CaseJson, RoundTripIsExact) {
  const cases::CaseManifest m = sample_manifest();
  const std::string json = cases::to_json(m);
  const cases::CaseManifest back = cases::parse_case_json(json);
  EXPECT_EQ(cases::to_json(back), json);
  EXPECT_EQ(back.center_mm, m.center_mm);
  EXPECT_EQ(back.anatomies[0].volume_ml, 0.1 + 0.2);
  EXPECT_EQ(back.anatomies[0].deviation.rms_mm, 1 / 3.0);
  EXPECT_EQ(back.anatomies[0].figures, m.anatomies[0].figures);
  EXPECT_EQ(back.parameters, m.parameters);
  EXPECT_EQ(back.landmarks[0].position_mm, m.landmarks[0].position_mm);
  EXPECT_EQ(back.targets[0].anatomy, "ventricles");
  EXPECT_EQ(back.burr_holes[0].diameter_mm, 14);
  EXPECT_EQ(back.face_reason, m.face_reason);
  EXPECT_NE(json.find("\"max\": 0.75"), std::string::npos);
}

TEST(CaseJson, TheHapticPartRoundTripsExactly) {
  const cases::CaseManifest m = full_manifest();
  const std::string json = cases::to_json(m);
  const cases::CaseManifest back = cases::parse_case_json(json);
  EXPECT_EQ(cases::to_json(back), json);
  ASSERT_EQ(back.missing.size(), 1u);
  EXPECT_EQ(back.missing[0].anatomy, "brainstem");
  EXPECT_EQ(back.missing[0].why, "where it lies is not sure");
  EXPECT_EQ(back.haptic.file, m.haptic.file);
  EXPECT_EQ(back.haptic.hardness_file, m.haptic.hardness_file);
  EXPECT_EQ(back.haptic.size, m.haptic.size);
  EXPECT_EQ(back.haptic.spacing_mm, m.haptic.spacing_mm);
  ASSERT_EQ(back.haptic.shapes.size(), 2u);
  const cases::CaseShape &skin = back.haptic.shapes[0], &skull = back.haptic.shapes[1];
  EXPECT_EQ(skin.displayed, "haptic");
  EXPECT_TRUE(skin.cuttable);
  EXPECT_EQ(skin.material.front.pop_through_n, 2.5);
  EXPECT_EQ(skin.material.front.dynamic_friction_ratio, 0.2);
  EXPECT_EQ(skin.material.drag_n_s_per_mm, 0.01);
  EXPECT_EQ(skin.mismatch.samples, 0u);
  EXPECT_EQ(skull.number, 3);
  EXPECT_EQ(skull.window_high, 3555);
  EXPECT_FALSE(skull.material.back.touchable);
  EXPECT_EQ(skull.material.removal_energy_j_per_mm3, 0.05);
  EXPECT_EQ(skull.volume_ml, 512.25);
  EXPECT_EQ(skull.mismatch.samples, 70000u);
  EXPECT_EQ(skull.mismatch.missed_ratio, 0.001);
  EXPECT_EQ(back.burr_holes[0].cut, m.burr_holes[0].cut);
  EXPECT_EQ(back.burr_holes[0].figures, m.burr_holes[0].figures);
}

TEST(CaseJson, TheOrderOfFilesIsTheirNames) {
  cases::CaseManifest m = sample_manifest(), n = m;
  const cases::CaseFile a{"meshes/a-0123456789abcdef.glb", sha256_of_bytes("a"), 1};
  const cases::CaseFile b{"meshes/b-0123456789abcdef.glb", sha256_of_bytes("b"), 1};
  m.files = {a, b};
  n.files = {b, a};
  EXPECT_EQ(cases::to_json(m), cases::to_json(n));
}

TEST(CaseJson, EveryBitFlipAndTruncationIsRefused) {
  const std::string json = cases::to_json(sample_manifest());
  for (std::size_t i = 0; i < json.size(); ++i) {
    EXPECT_THROW(cases::parse_case_json(std::string_view(json).substr(0, i)), Error) << i;
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = json;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      EXPECT_THROW(cases::parse_case_json(damaged), Error) << i;
    }
  }
  EXPECT_THROW(cases::parse_case_json(json + "\n"), Error);
}

TEST(CaseJson, Versions) {
  cases::CaseManifest m = sample_manifest();
  m.version_minor = cases::case_version_minor + 1;
  EXPECT_EQ(cases::parse_case_json(cases::to_json(m)).version_minor, cases::case_version_minor + 1);
  const auto refused = [&](int major, int minor) -> std::string {
    m.version_major = major;
    m.version_minor = minor;
    try {
      cases::parse_case_json(cases::to_json(m));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.what();
    }
    return "read";
  };
  EXPECT_EQ(
      refused(3, 8),
      "version 3.8, this program reads versions 2.*: take a newer Trephine, or make the case again with this one");
  EXPECT_EQ(refused(1, 7), "version 1.7, this program reads versions 2.*: make the case again with `trephine run`");
}

// `text` put into a valid case.json before its first anatomies, with the checksum that belongs to it.
std::string edited(const std::string& from, const std::string& to, const cases::CaseManifest& m = sample_manifest()) {
  std::string json = cases::to_json(m);
  json.replace(json.find(from), from.size(), to);
  const auto tail = json.rfind(",\n \"checksum\"");
  json.resize(tail);
  return json + ",\n \"checksum\": \"" + sha256_of_bytes(json) + "\"\n}\n";
}

TEST(CaseJson, ANewerMinorVersionMayHoldMore) {
  const cases::CaseManifest m =
      cases::parse_case_json(edited("\"case\":", "\"dose\": {\"file\": [1, {}]},\n \"case\":"));
  EXPECT_EQ(m.case_token, "sample");
}

TEST(CaseJson, AKeyThatIsMissingIsRefused) {
  cases::CaseManifest m = sample_manifest();
  m.burr_holes[0].cut.clear();
  try {
    cases::parse_case_json(edited(",\n   \"cut\": []", "", m));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.field(), "burr_holes.kocher_right.cut");
  }
}

TEST(CaseJson, HostileContentWithARightChecksumIsRefused) {
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"sample\"", "\"../sample\""},
           {"\"sample\"", "7"},
           {"\"LPS\"", "\"RAS\""},
           {"\"files\": []", "\"files\": {}, \"files\": 3"},
           {"\"files\": []",
            "\"files\": [{\"name\": \"../../etc/passwd\", \"sha256\": \"" + sha256_of_bytes("") + "\", \"bytes\": 1}]"},
           {"\"files\": []",
            "\"files\": [{\"name\": \"/etc/passwd\", \"sha256\": \"" + sha256_of_bytes("") + "\", \"bytes\": 1}]"},
           {"\"files\": []",
            "\"files\": [{\"name\": \"a/b/c\", \"sha256\": \"" + sha256_of_bytes("") + "\", \"bytes\": 1}]"},
           {"\"files\": []", "\"files\": [{\"name\": \"a\", \"sha256\": \"x\", \"bytes\": 1}]"},
           {"\"files\": []",
            "\"files\": [{\"name\": \"a\", \"sha256\": \"" + sha256_of_bytes("") + "\", \"bytes\": -1}]"},
           {"\"triangles\": 4", "\"triangles\": -4"},
           {"\"triangles\": 4", "\"triangles\": 1e999"},
           {"\"opacity\": 1.0", "\"opacity\": null"},
           {"\"name\": \"skull\"", "\"name\": \"skull\", \"file\": \"meshes/none.glb\""},
           {"\"frame\"", "\"frme\""}}) {
    ASSERT_NE(cases::to_json(sample_manifest()).find(from), std::string::npos) << from;
    EXPECT_THROW(cases::parse_case_json(edited(from, to)), Error) << to;
  }
}

TEST(CaseJson, EveryFaultOfTheHapticPartIsNamed) {
  const auto field_of = [](const std::string& from, const std::string& to) -> std::string {
    EXPECT_NE(cases::to_json(full_manifest()).find(from), std::string::npos) << from;
    try {
      cases::parse_case_json(edited(from, to, full_manifest()));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << to;
      return e.field();
    }
    return "loaded";
  };
  const std::string haptic_file = "\"file\": \"haptic-0123456789abcdef.nrrd\"";
  for (const auto& [from, to, field] : std::vector<std::array<std::string, 3>>{
           {haptic_file, "\"file\": \"other-0123456789abcdef.nrrd\"", "haptic"},
           {haptic_file, "\"file\": \"\"", "haptic.file"},
           {haptic_file, "\"fill\": 1", "haptic.file"},
           {"\"encoding\": \"occupancy\"", "\"encoding\": \"octree\"", "haptic.encoding"},
           {"\"encoding\": \"occupancy\"", "\"encoding\": 1", "haptic.encoding"},
           {"   10,\n   20,\n   30", "   10,\n   20", "haptic.size"},
           {"   10,\n   20,\n   30", "   10,\n   20,\n   0", "haptic.size"},
           {"   10,\n   20,\n   30", "   10,\n   20,\n   -30", "haptic.size"},
           {"   10,\n   20,\n   30", "   10,\n   20,\n   70000", "haptic.size"},
           {"   10,\n   20,\n   30", "   10,\n   20,\n   18446744073709551615", "haptic.size"},
           {"   10,\n   20,\n   30", "   10,\n   20,\n   30.5", "haptic.size"},
           {"   0.5,\n   0.5,\n   1.0", "   0.5,\n   0.5,\n   0.0", "haptic.spacing_mm"},
           {"   0.5,\n   0.5,\n   1.0", "   0.5,\n   0.5,\n   1e999", "json"},
           {"   0.5,\n   0.5,\n   1.0", "   0.5,\n   0.5,\n   null", "haptic.spacing_mm"},
           {"\"number\": 3", "\"number\": 1", "haptic.shapes.skull.number"},
           {"\"number\": 3", "\"number\": 0", "haptic.shapes.skull.number"},
           {"\"number\": 3", "\"number\": 33", "haptic.shapes.skull.number"},
           {"     3001,\n     3555", "     1555,\n     3555", "haptic.shapes.skull.window"},
           {"     3001,\n     3555", "     3555,\n     3001", "haptic.shapes.skull.window"},
           {"     3001,\n     3555", "     3001,\n     40000", "haptic.shapes.skull.window"},
           {"\"name\": \"skin\"", "\"name\": \"skull\"", "haptic.shapes"},
           {"\"name\": \"skin\"", "\"name\": \"../skin\"", "haptic.shapes[0].name"},
           {"\"displayed\": \"haptic\"", "\"displayed\": \"surface\"", "haptic.shapes.skin.displayed"},
           {"\"displayed\": \"haptic\"", "\"displayed\": \"both\"", "haptic.shapes.skin.displayed"},
           {"\"cuttable\": true", "\"cuttable\": 1", "haptic.shapes.skin.cuttable"},
           {"\"stiffness_n_per_mm\": 0.5", "\"stiffness_n_per_mm\": -0.5",
            "haptic.shapes.skin.material.front.stiffness_n_per_mm"},
           {"\"static_friction_ratio\": 0.3", "\"static_friction_ratio\": 11",
            "haptic.shapes.skin.material.front.static_friction_ratio"},
           {"\"pop_through_n\": 2.5", "\"pop_thru\": 2", "haptic.shapes.skin.material.front.pop_through_n"},
           {"\"missed_ratio\": 0.001", "\"missed_ratio\": 1.001", "haptic.shapes.skull.mismatch.missed_ratio"},
           {"\"samples\": 70000", "\"samples\": -1", "haptic.shapes.skull.mismatch.samples"},
           {"    \"skull\",\n    \"skin\"", "    \"skull\",\n    \"dura\"", "burr_holes.kocher_right.cut"},
           {"\"diameter_mm\": 14.0", "\"diameter_mm\": 0", "burr_holes.kocher_right.diameter_mm"},
           {"    0.0,\n    0.0,\n    -1.0", "    0.0,\n    0.0,\n    -1.1", "burr_holes.kocher_right.direction"},
           {"\"confidence\": 0.9", "\"confidence\": 1.9", "landmarks.nasion.confidence"},
           {"\"opacity\": 1.0", "\"opacity\": 2", "anatomies.skull.opacity"}})
    EXPECT_EQ(field_of(from, to), field) << to;
}

TEST(CaseJson, WhatWouldTakeMuchMemoryOrTimeIsRefused) {
  const auto refused = [](const std::string& text) {
    EXPECT_THROW(cases::parse_case_json(edited("\"case\":", "\"more\": " + text + ",\n \"case\":")), Error);
  };
  refused(std::string(100000, '[') + std::string(100000, ']'));
  std::string keys = "{", values = "[";
  for (int i = 0; i < 100000; ++i) keys += "\"k" + std::to_string(i) + "\":0,";
  for (int i = 0; i < 1000000; ++i) values += "0,";
  refused(keys + "\"k\":0}");
  refused(values + "0]");
}

TEST(CaseJson, ContradictionsAreNotWritten) {
  cases::CaseManifest m = sample_manifest();
  m.anatomies[0].volume_ml = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(cases::to_json(m), Error);
  m = sample_manifest();
  m.anatomies[0].file = "meshes/none-0123456789abcdef.glb";
  EXPECT_THROW(cases::to_json(m), Error);
  m = sample_manifest();
  m.anatomies.push_back(m.anatomies[0]);
  EXPECT_THROW(cases::to_json(m), Error);
  m = sample_manifest();
  m.parameters.push_back(m.parameters[0]);
  EXPECT_THROW(cases::to_json(m), Error);
  m = sample_manifest();
  m.face_reason = "\xff\xfe";
  EXPECT_THROW(cases::to_json(m), Error);
}

TEST(CaseToken, OnlyWhatIsSafeAsAName) {
  for (const char* good :
       {"a", "0", "sample", "case-12_b", "a123456789012345678901234567890123456789012345678901234567890123"})
    EXPECT_NO_THROW(cases::validate_case_token(good, ExitCode::usage)) << good;
  for (const char* bad : {"", "-a", "_a", "A", "a.b", "a/b", "..", "a b", "\xc3\xa4",
                          "a1234567890123456789012345678901234567890123456789012345678901234"}) {
    try {
      cases::validate_case_token(bad, ExitCode::bad_config);
      ADD_FAILURE() << bad;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_config);
    }
  }
}

TEST(CaseHoles, ThatBreakIntoEachOtherAreTold) {
  std::vector<cases::CaseBurrHole> holes(3);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    holes[i].name = "burr_hole_" + std::to_string(i + 1);
    holes[i].position_mm = {std::array{0.0, 30.0, 36.9}[i], 0, 0};
    holes[i].diameter_mm = i == 2 ? 4 : 10;
  }
  const std::vector<std::string> lines = cases::overlapping_holes(holes);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].substr(0, 66), "burr_hole_2 and burr_hole_3 overlap: their entries lie 6.9 mm apar");
  holes[2].position_mm.x = 37.1;
  EXPECT_TRUE(cases::overlapping_holes(holes).empty());
}

}  // namespace
}  // namespace trephine
