// SPDX-License-Identifier: GPL-3.0-or-later
// Two cases against each other: against displacements that are known, and what is in one of them only.
#include "compare/compare_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/pi.h"
#include "case_samples.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

using case_samples::MemoryCase;

/// A sphere whose vertices lie on the radius: its facets lie up to radius * (1 - cos(pi / (2 * rings))) within.
surface::TriMesh sphere(double radius_mm, Vec3 middle_mm, int rings) {
  surface::TriMesh m = case_samples::ball(1, rings);
  for (Vec3& p : m.points_mm) p = normalized(p) * radius_mm + middle_mm;
  return m;
}

struct Shown {
  std::string name;
  surface::TriMesh mesh;  ///< about the case's centre
};

/// A case of these surfaces alone, with one landmark and one burr hole.
MemoryCase case_of(const std::vector<Shown>& shown) {
  MemoryCase c;
  cases::CaseManifest& m = c.manifest;
  m.case_token = "sample";
  m.center_mm = {10, -20, 30};
  m.program_version = "trephine 0.1.0";
  m.input_sha256 = sha256_of_bytes("input");
  m.parameters = {{"skin.smooth.pass_band_ratio", 0.1}, {"skin.decimate.keep_ratio", 0.5}};
  m.figures = {{"class", std::string("normal")}, {"evans_index_ratio", 0.26}};
  m.landmarks = {{"nasion", {1, -110, 300}, 0.9, "found"}};
  m.targets = {{"middle", {1, -20, 300}, 0.8, ""}};
  m.burr_holes = {{"entry", {1, -20, 390}, {0, 0, -1}, 14, {}, {{"bone_thickness_mm", 6.5}}}};
  for (const Shown& s : shown) {
    surface::TriMesh mesh = s.mesh;
    mesh.origin_mm = m.center_mm;
    cases::GlbParams params;
    params.center_mm = m.center_mm;
    params.name = s.name;
    const std::string bytes = cases::make_glb(mesh, params);
    m.files.push_back(cases::describe_case_file("meshes/" + s.name, ".glb", bytes));
    c.files[m.files.back().name] = bytes;
    cases::CaseAnatomy a;
    a.name = s.name;
    a.file = m.files.back().name;
    a.triangles = mesh.triangles.size();
    a.points = mesh.points_mm.size();
    a.volume_ml = surface::volume_mm3(mesh) / 1000;
    a.area_cm2 = surface::area_mm2(mesh) / 100;
    m.anatomies.push_back(a);
  }
  return c;
}

cases::LoadedCase load(MemoryCase c) {
  c.seal();
  return cases::load_case_through(c.reader());
}

const compare::ValueChange* find_change(const std::vector<compare::ValueChange>& all, const std::string& name) {
  for (const compare::ValueChange& v : all)
    if (v.name == name) return &v;
  return nullptr;
}

TEST(Compare, KnownDisplacementsAreMeasured) {
  constexpr int rings = 96;
  constexpr double radius = 40, facet = radius * (pi / (2 * rings)) * (pi / (2 * rings));
  const MemoryCase before =
      case_of({{"grown", sphere(radius, {}, rings)}, {"moved", sphere(radius, {}, rings)}, {"kept", sphere(9, {}, 8)}});
  const MemoryCase after = case_of({{"grown", sphere(radius + 0.5, {}, rings)},
                                    {"moved", sphere(radius, {1, 0, 0}, rings)},
                                    {"kept", sphere(9, {}, 8)}});
  const compare::CaseComparison c = compare::compare_cases(load(before), load(after));
  ASSERT_EQ(c.anatomies.size(), 3u);
  EXPECT_FALSE(c.identical);
  EXPECT_TRUE(c.same_input);

  // Half a millimetre everywhere, and the new surface lies outside.
  const metrics::DeviationStats& grown = c.anatomies[0].deviation->both;
  EXPECT_NEAR(grown.max_mm, 0.5, facet);
  EXPECT_NEAR(grown.rms_mm, 0.5, facet);
  EXPECT_NEAR(grown.bias_mm, 0.5, facet);
  EXPECT_NEAR(*c.anatomies[0].new_ml / *c.anatomies[0].old_ml, std::pow(40.5 / 40, 3), 1e-6);

  // Moved by 1 mm along x: the distance is |cos| of the angle to x, to within half of 1 mm^2 / radius.
  const metrics::DeviationStats& moved = c.anatomies[1].deviation->both;
  EXPECT_NEAR(moved.max_mm, 1, facet);
  EXPECT_NEAR(moved.rms_mm, 1 / std::sqrt(3.0), 0.015);
  EXPECT_NEAR(moved.bias_mm, 0, 0.015);
  EXPECT_NEAR(*c.anatomies[1].new_ml, *c.anatomies[1].old_ml, 1e-4);

  EXPECT_TRUE(c.anatomies[2].same_bytes);
  EXPECT_FALSE(c.anatomies[2].deviation);

  // The other way round the bias changes its sign and nothing else.
  const compare::CaseComparison back = compare::compare_cases(load(after), load(before));
  EXPECT_NEAR(back.anatomies[0].deviation->both.bias_mm, -grown.bias_mm, 1e-9);
  EXPECT_NEAR(back.anatomies[0].deviation->both.max_mm, grown.max_mm, 1e-9);
}

TEST(Compare, PointsFiguresAndParameters) {
  const MemoryCase before = case_of({{"skin", sphere(9, {}, 8)}});
  MemoryCase after = before;
  cases::CaseManifest& m = after.manifest;
  m.landmarks[0].position_mm = {1, -107, 304};
  m.landmarks.push_back({"inion", {0, 90, 300}, 1, "given"});
  m.targets.clear();
  m.burr_holes[0].direction = normalized(Vec3{0, std::tan(pi / 18), -1});
  m.burr_holes[0].diameter_mm = 12;
  m.figures[0].second = std::string("shifted");
  m.parameters[1].second = 0.25;
  m.parameters.emplace_back("skin.repair.close_mm", 1.5);
  const compare::CaseComparison c = compare::compare_cases(load(before), load(after));
  ASSERT_EQ(c.points.size(), 4u);
  EXPECT_EQ(c.points[0].name, "nasion");
  EXPECT_NEAR(*c.points[0].moved_mm, 5, 1e-12);
  EXPECT_EQ(c.points[1].in, compare::InCases::only_new);
  EXPECT_FALSE(c.points[1].moved_mm);
  EXPECT_EQ(c.points[2].in, compare::InCases::only_old);
  EXPECT_EQ(*c.points[3].moved_mm, 0);
  EXPECT_NEAR(*c.points[3].turned_deg, 10, 1e-9);
  ASSERT_EQ(c.figures.size(), 2u);
  EXPECT_EQ(to_text(*c.figures[0].new_value), "\"shifted\"");
  EXPECT_EQ(to_text(*find_change(c.figures, "entry.diameter_mm")->new_value), "12");
  ASSERT_EQ(c.parameters.size(), 2u);
  EXPECT_EQ(to_text(*c.parameters[0].old_value), "0.5");
  EXPECT_EQ(to_text(*c.parameters[0].new_value), "0.25");
  EXPECT_FALSE(c.parameters[1].old_value);

  // Every change is in the JSON and in the table.
  const auto json = nlohmann::json::parse(compare::comparison_json(c));
  EXPECT_EQ(json["points"][0]["moved_mm"], *c.points[0].moved_mm);
  EXPECT_EQ(json["figures"][0]["new"], "shifted");
  EXPECT_TRUE(json["parameters"][1]["old"].is_null());
  const std::string text = compare::comparison_text(c);
  for (const char* word : {"5.000", "shifted", "skin.repair.close_mm", "same bytes", "10.00"})
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

TEST(Compare, DifferentSetsOfAnatomies) {
  MemoryCase before = case_of({{"skin", sphere(9, {}, 8)}, {"skull", sphere(8, {}, 8)}});
  MemoryCase after = case_of({{"skull", sphere(8, {}, 8)}, {"brain", sphere(7, {}, 8)}});
  after.manifest.input_sha256 = sha256_of_bytes("another");
  const compare::CaseComparison c = compare::compare_cases(load(before), load(after));
  ASSERT_EQ(c.anatomies.size(), 3u);
  EXPECT_EQ(c.anatomies[0].in, compare::InCases::only_old);
  EXPECT_EQ(c.anatomies[1].in, compare::InCases::both);
  EXPECT_EQ(c.anatomies[2].in, compare::InCases::only_new);
  EXPECT_FALSE(c.anatomies[2].old_ml);
  ASSERT_EQ(c.warnings.size(), 1u);
  EXPECT_NE(c.warnings[0].find("different scans"), std::string::npos);
  EXPECT_FALSE(c.same_input);
}

TEST(Compare, LimitsRefuseWhatExceedsThemAndWhatCannotBeJudged) {
  MemoryCase before = case_of({{"skin", sphere(40, {}, 48)}, {"skull", sphere(8, {}, 8)}});
  MemoryCase after = case_of({{"skin", sphere(40.5, {}, 48)}});
  after.manifest.landmarks[0].position_mm.x += 0.75;
  const compare::CaseComparison c = compare::compare_cases(load(before), load(after));
  const auto beyond = [&](double deviation, double point, double volume) {
    compare::CompareParams p;
    p.max_deviation_mm = deviation;
    p.max_point_mm = point;
    p.max_volume_ratio = volume;
    return compare::beyond_limits(c, p);
  };
  EXPECT_TRUE(beyond(0, 0, 0).empty());
  EXPECT_EQ(beyond(0.4, 0, 0).size(), 2u);  // the skin, and the skull that is gone
  EXPECT_EQ(beyond(0.6, 0, 0).size(), 1u);
  EXPECT_EQ(beyond(0.6, 0, 0)[0], "skull is not in the new case");
  EXPECT_EQ(beyond(0, 0.8, 0).size(), 0u);
  EXPECT_EQ(beyond(0, 0.7, 0).size(), 1u);
  EXPECT_EQ(beyond(0, 0, 0.05).size(), 1u);  // 3.8 %: only the skull
  EXPECT_EQ(beyond(0, 0, 0.03).size(), 2u);
  const compare::CaseComparison same = compare::compare_cases(load(before), load(before));
  EXPECT_TRUE(same.identical);
  compare::CompareParams strict;
  strict.max_deviation_mm = strict.max_point_mm = strict.max_volume_ratio = 1e-6;
  EXPECT_TRUE(compare::beyond_limits(same, strict).empty());
}

TEST(Compare, WhatIsDisplayedFromTheHapticVolumeIsComparedByItsFeltSurface) {
  const MemoryCase seen = case_samples::drill_case();
  MemoryCase felt = seen;
  cases::CaseAnatomy& brain = felt.manifest.anatomies[1];
  ASSERT_EQ(brain.name, "brain");
  const std::string file = brain.file;
  brain.file.clear();
  brain.triangles = brain.points = 0;
  auto& files = felt.manifest.files;
  files.erase(std::find_if(files.begin(), files.end(), [&](const cases::CaseFile& f) { return f.name == file; }));
  felt.files.erase(file);
  felt.manifest.haptic.shapes[1].displayed = "haptic";
  felt.manifest.haptic.shapes[1].mismatch = {};
  const compare::CaseComparison c = compare::compare_cases(load(seen), load(felt));
  const compare::AnatomyChange& change = c.anatomies[1];
  ASSERT_TRUE(change.deviation) << change.not_measured;
  // Both cases hold the same haptic volume: what is felt is compared with what is felt.
  EXPECT_TRUE(change.old_is_felt);
  EXPECT_TRUE(change.new_is_felt);
  EXPECT_LT(change.deviation->both.max_mm, 1e-9);
  EXPECT_EQ(change.change_ml(), 0.0);
  // A case that has no haptic volume has its mesh alone, and volumes of two makings do not compare.
  const MemoryCase mesh_alone = case_of({{"brain", sphere(8, {-9, 0, 270}, 8)}});
  const compare::CaseComparison apart = compare::compare_cases(load(mesh_alone), load(felt));
  const compare::AnatomyChange& mixed = apart.anatomies[0];
  ASSERT_TRUE(mixed.deviation) << mixed.not_measured;
  EXPECT_FALSE(mixed.old_is_felt);
  EXPECT_TRUE(mixed.new_is_felt);
  EXPECT_LT(mixed.deviation->both.rms_mm, 0.64);  // a voxel; the surface is a ball of 8 rings
  EXPECT_GT(mixed.deviation->both.max_mm, 0);
  EXPECT_FALSE(mixed.change_ml());
  EXPECT_FALSE(apart.warnings.empty());
  EXPECT_TRUE(c.warnings.empty());
  EXPECT_NE(find_change(c.about, "haptic.brain.displayed"), nullptr);
}

}  // namespace
}  // namespace trephine
