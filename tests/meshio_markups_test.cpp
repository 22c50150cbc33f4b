// SPDX-License-Identifier: GPL-3.0-or-later
// A case's points as markups of 3D Slicer, and back.
#include <gtest/gtest.h>

#include "cases/slicer_points.h"
#include "meshio/markups.h"

namespace trephine {
namespace {

cases::CaseManifest sample() {
  cases::CaseManifest m;
  m.landmarks = {{"nasion", {0.1, -110.30000000000001, 1e-7}, 0.875, "found"},
                 {"tragus_left", {70, 1. / 3, -5}, 1, "given"}};
  m.targets = {{"monro_right", {-3, -2, 60}, 0.5, "ventricles"}, {"monro_left", {40, -2, 60}, 0.5, "ventricles"}};
  // The axis passes the first target at 4 mm, 30 mm from the bone.
  m.burr_holes = {{"kocher", {-3, 2, 90}, {0, 0, -1}, 14, {}, {}}};
  return m;
}

TEST(Markups, ReadBackBitForBit) {
  const cases::CaseManifest m = sample();
  const auto all = meshio::markups_of_case(m);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].name, "landmarks");
  const auto back = cases::parse_slicer_markups(meshio::encode_slicer_markups(all[0]));
  ASSERT_EQ(back.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].name, m.landmarks[i].name);
    EXPECT_EQ(back[i].position_mm, m.landmarks[i].position_mm);
    EXPECT_EQ(back[i].source, "given");
  }
  EXPECT_EQ(cases::parse_slicer_markups(meshio::encode_slicer_markups(all[1]))[1].position_mm,
            m.targets[1].position_mm);
  EXPECT_EQ(meshio::encode_slicer_markups(all[0]), meshio::encode_slicer_markups(meshio::markups_of_case(m)[0]));
}

TEST(Markups, TrajectoriesEndAbreastOfTheirTarget) {
  cases::CaseManifest m = sample();
  const auto line = meshio::markups_of_case(m)[2];
  EXPECT_TRUE(line.line);
  EXPECT_EQ(line.name, "trajectory-kocher");
  EXPECT_EQ(line.points[0].position_mm, (Vec3{-3, 2, 90}));
  EXPECT_EQ(line.points[1].position_mm, (Vec3{-3, 2, 60}));
  EXPECT_NE(line.points[1].description.find("passes monro_right at 4 mm, 30 mm from the bone"), std::string::npos)
      << line.points[1].description;
  const std::string text = meshio::encode_slicer_markups(line);
  EXPECT_NE(text.find("\"type\": \"Line\""), std::string::npos);
  EXPECT_EQ(cases::parse_slicer_markups(text)[1].name, "kocher_end");

  meshio::MarkupsParams params;
  params.trajectory_mm = 45;
  EXPECT_EQ(meshio::markups_of_case(m, params)[2].points[1].position_mm, (Vec3{-3, 2, 45}));
  // Without a target ahead near the axis: 60 mm.
  m.targets = {{"beside", {30, 2, 60}, 1, ""}, {"behind", {-3, 2, 120}, 1, ""}};
  EXPECT_EQ(meshio::markups_of_case(m)[2].points[1].position_mm, (Vec3{-3, 2, 30}));
}

TEST(Markups, NothingIsNoFile) { EXPECT_TRUE(meshio::markups_of_case(cases::CaseManifest{}).empty()); }

}  // namespace
}  // namespace trephine
