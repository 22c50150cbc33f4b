// SPDX-License-Identifier: GPL-3.0-or-later
// Cases of every older format are read: what they hold, and the defaults of what they do not know.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "cases/load_case.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

const fs::path old = fs::path(TREPHINE_SOURCE_DIR) / "tests/data/old";

std::string case_json(int minor) {
  const std::vector<char> bytes = read_file(old / ("case-1." + std::to_string(minor)) / "case.json", 1 << 20);
  return {bytes.begin(), bytes.end()};
}

cases::LoadedCase load(const std::string& json) {
  return cases::load_case_through([&](const std::string& name, std::uint64_t most) {
    return name == "case.json" ? std::vector<char>(json.begin(), json.end()) : read_file(old / "case-1.4" / name, most);
  });
}

TEST(CasesOld, EveryFormatIsRead) {
  for (int minor = 0; minor <= 6; ++minor) {
    SCOPED_TRACE(minor);
    const cases::LoadedCase c = load(case_json(minor));
    const cases::CaseManifest& m = c.manifest;
    EXPECT_EQ(m.version_minor, minor);
    ASSERT_EQ(m.anatomies.size(), 2u);
    EXPECT_EQ(c.surfaces[0].triangles.size(), m.anatomies[0].triangles);
    EXPECT_EQ(m.anatomies[0].budget_asked_mm, 0.3);
    EXPECT_EQ(m.anatomies[0].figures[2].second, ParameterValue(std::string("target")));
    EXPECT_EQ(m.parameters[0].second, ParameterValue(0.2));
    EXPECT_EQ(m.burr_holes[0].position_mm, (Vec3{1, -20, 320}));
    EXPECT_EQ(m.burr_holes[0].cut.size(), minor >= 1 ? 1u : 0u);
    EXPECT_EQ(c.has_haptic(), minor >= 1);
    EXPECT_EQ(m.figures.size(), minor >= 2 ? 3u : 0u);
    EXPECT_EQ(m.ct.file.empty(), minor < 3);
    EXPECT_EQ(m.missing.size(), minor >= 4 ? 1u : 0u);
    EXPECT_EQ(m.stand_ins.size(), minor >= 5 ? 1u : 0u);
    EXPECT_EQ(m.findings.size(), minor >= 6 ? 1u : 0u);
    if (minor == 0) continue;
    const cases::CaseShape& bone = m.haptic.shapes[0];
    EXPECT_EQ(bone.material.name, "bone");
    EXPECT_TRUE(bone.cuttable);
    EXPECT_EQ(bone.material.front.static_friction_ratio, 0.4);
    EXPECT_EQ(bone.material.removal_energy_j_per_mm3, 0.01);
    EXPECT_EQ(bone.material.front.across_grain_ratio, 1);
    EXPECT_EQ(bone.mismatch.samples, 50000u);
    EXPECT_EQ(cases::to_json(m), case_json(minor)) << "written again, the same bytes";
  }
}

// What a format has, a case of it must hold; what came later, it may be without.
TEST(CasesOld, AKeyOfItsOwnFormatMayNotBeMissing) {
  const auto without = [](int minor, const std::string& from) {
    std::string json = case_json(minor);
    const std::size_t at = json.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    json.erase(at, from.size());
    json.resize(json.rfind(",\n \"checksum\""));
    json += ",\n \"checksum\": \"" + sha256_of_bytes(json) + "\"\n}\n";
    try {
      load(json);
    } catch (const Error& e) {
      return e.field();
    }
    return std::string("loaded");
  };
  const std::string cut = "   \"cut\": [\n    \"outer\"\n   ],\n", drag = "     \"drag_n_s_per_mm\": 0.01,\n";
  EXPECT_EQ(without(1, cut), "burr_holes.entry.cut");
  EXPECT_EQ(without(4, cut), "burr_holes.entry.cut");
  EXPECT_EQ(without(1, drag), "haptic.shapes.outer.material.drag_n_s_per_mm");
}

}  // namespace
}  // namespace trephine
