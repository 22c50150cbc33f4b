// SPDX-License-Identifier: GPL-3.0-or-later
// What part of the body a scan shows, before anything is made of it: refused where it is surely another one.
#include "look/body_part.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "phantom_heads.h"
#include "report_of.h"

namespace trephine {
namespace {

using Volume = grid::Grid<std::int16_t>;
using look::BodyPart;

/// Why it is refused; empty where it is not.
std::string refused(const Volume& v, BodyPart expected, Report* out = nullptr) {
  Report report;
  std::string why;
  try {
    value_of(report, look::judge_body_part(v, {expected}));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "expected");
    why = e.what();
  }
  if (out) *out = report;
  return why;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string said(const Report& r) { return std::get<std::string>(*r.find("is_expected")); }

Volume drawn(std::array<int, 3> size, double spacing_mm, const std::function<int(Vec3)>& hu) {
  Volume v(grid::Lattice{size,
                         {spacing_mm, spacing_mm, spacing_mm},
                         {-0.5 * size[0] * spacing_mm, -0.5 * size[1] * spacing_mm, -0.5 * size[2] * spacing_mm},
                         {}});
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        v.at(i, j, k) = std::int16_t(hu(v.to_world_mm({double(i), double(j), double(k)})));
  return v;
}

/// A skull of 1,600 ml, and that many mm of a neck below it.
Volume head(double neck_mm) {
  const int below = int(neck_mm / 2);
  Volume v = drawn({100, 110, 90 + below}, 2, [&](Vec3 p) {
    const double z = p.z - neck_mm / 2;
    const double r = std::sqrt(p.x * p.x / (66 * 66) + p.y * p.y / (84 * 84) + z * z / (70 * 70));
    if (r < 1) return 35;
    if (r < 1.09) return 900;
    if (r < 1.18) return 40;
    return z < -40 && std::hypot(p.x, p.y - 10) < 60 ? 40 : -1000;
  });
  return v;
}

Volume phantom_of(const phantom::Scan& scan) { return phantom::volume_of(scan); }

phantom::ScanParams coarse(int pixels, int slices) {
  phantom::ScanParams how;
  how.columns_count = how.rows_count = pixels;
  how.pixel_mm = how.slice_step_mm = how.slice_thickness_mm = 2;
  how.slices_count = slices;
  how.noise_hu = 10;
  return how;
}

TEST(BodyPart, AHeadIsOneAndNoSpineOrChestWhereItEndsBelowTheSkull) {
  Report report;
  EXPECT_EQ(refused(head(0), BodyPart::head, &report), "");
  EXPECT_EQ(said(report), "yes");
  EXPECT_TRUE(report.warnings.empty());
  for (const BodyPart trunk : {BodyPart::spine, BodyPart::chest}) {
    const std::string why = refused(head(0), trunk);
    EXPECT_TRUE(has(why, "a head is seen (a cranial cavity of 1")) << why;
    EXPECT_TRUE(has(why, "the scan ends")) << why;
    EXPECT_TRUE(has(why, "configs/ct_head.yaml makes a head")) << why;
    EXPECT_FALSE(has(why, "--no-refuse")) << "what is not in the scan is not made: " << why;
    EXPECT_FALSE(has(why, "clavicle")) << "a recipe may do without: " << why;
    Report passed;
    value_of(passed, look::judge_body_part(head(0), {trunk, false}));
    ASSERT_EQ(passed.warnings.size(), 1u);
    EXPECT_FALSE(has(passed.warnings[0], "configs/")) << "the remedy is done: " << passed.warnings[0];
  }
  EXPECT_EQ(refused(head(0), BodyPart::any), "");
}

TEST(BodyPart, AHeadWithWhatLiesBelowItIsLeftToTheSearch) {
  EXPECT_NE(refused(head(4), BodyPart::spine), "");
  EXPECT_NE(refused(head(20), BodyPart::spine), "") << "the atlas and half the axis";
  EXPECT_EQ(refused(head(60), BodyPart::spine), "");
  EXPECT_NE(refused(head(20), BodyPart::chest), "");
  EXPECT_EQ(refused(head(80), BodyPart::chest), "");
}

TEST(BodyPart, ThePhantomsHeadIsSeen) {
  phantom::ScanParams how = phantom_heads::scan_of(150, 100, 10, 200, 270);
  how.subvoxel_mm = 1.8;
  const Volume v = phantom_of(phantom::scan(phantom_heads::head_of(phantom::Level::hard, 7), how));
  Report report;
  EXPECT_EQ(refused(v, BodyPart::head, &report), "");
  EXPECT_EQ(std::get<std::string>(*report.find("shows_head")), "yes");
}

TEST(BodyPart, LungsAreNoHeadAndTheRecipeThatFitsIsNamed) {
  // A rib cage with its gaps about two lungs, in a trunk.
  const Volume chest = drawn({170, 130, 60}, 2, [](Vec3 p) {
    const double r = std::hypot(p.x / 120, p.y / 85);
    if (r > 1.25) return -1000;
    if (r > 1.0 && r < 1.06) return std::fmod(p.z + 1000, 24) < 10 ? 700 : 40;
    if (std::hypot(p.x, p.y - 70) < 18) return 700;
    return std::hypot((std::abs(p.x) - 60) / 45, p.y / 65) < 1 ? -850 : 40;
  });
  const std::string why = refused(chest, BodyPart::head);
  EXPECT_TRUE(has(why, "lungs are seen, and no head: ")) << why;
  EXPECT_TRUE(has(why, "configs/ct_chest.yaml")) << why;
  EXPECT_EQ(refused(chest, BodyPart::chest), "");
  EXPECT_EQ(refused(chest, BodyPart::spine), "");
  // The remedy makes it all the same, and does not call it good.
  EXPECT_TRUE(has(why, "--no-refuse")) << why;
  Report report;
  value_of(report, look::judge_body_part(chest, {BodyPart::head, false}));
  EXPECT_EQ(said(report), "unknown");
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_TRUE(has(report.warnings[0], "lungs are seen, and no head")) << report.warnings[0];
  EXPECT_FALSE(has(report.warnings[0], "refuse")) << "it is done: " << report.warnings[0];
}

TEST(BodyPart, ASkullFullOfGasIsNoChest) {
  // As after death: gas above, and tissue enough about it for a body with lungs.
  const Volume dead = drawn({110, 120, 110}, 2, [](Vec3 p) {
    const double r = std::sqrt(p.x * p.x / (66 * 66) + p.y * p.y / (84 * 84) + p.z * p.z / (70 * 70));
    if (r < 1) return p.z > -15 ? -900 : 35;
    if (r < 1.09) return 900;
    return r < 1.3 || (p.z < -20 && std::hypot(p.x, p.y - 10) < 90) ? 40 : -1000;
  });
  Report report;
  EXPECT_EQ(refused(dead, BodyPart::head, &report), "");
  EXPECT_GT(std::get<double>(*report.find("tissue_ml")), 2000);
  EXPECT_GT(std::get<double>(*report.find("enclosed_air_ratio")), 0.35);
}

TEST(BodyPart, ASpineAloneIsNoHead) {
  // Vertebrae with closed arches, in tissue, in a narrow field.
  const Volume spine = drawn({70, 70, 70}, 2, [](Vec3 p) {
    const double r = std::hypot(p.x, p.y - 15);
    if (r < 9) return 30;
    if (r < 15 || std::hypot(p.x, p.y + 15) < 21) return 400;
    return 50;
  });
  const std::string why = refused(spine, BodyPart::head);
  EXPECT_TRUE(has(why, "a spine is seen, and no head: ")) << why;
  EXPECT_TRUE(has(why, "configs/ct_spine_bone.yaml")) << why;
  EXPECT_EQ(refused(spine, BodyPart::spine), "");
  EXPECT_EQ(refused(spine, BodyPart::any), "");
}

TEST(BodyPart, WhatMayBeOfAHeadGoesOnAndIsTold) {
  // A jaw with teeth, a throat and a column behind it, as a dental scan shows them; an empty skull without any tissue.
  const Volume jaw = drawn({80, 80, 50}, 2, [](Vec3 p) {
    const double r = std::hypot(p.x, p.y);
    if (r > 76) return -1000;
    if (std::hypot(p.x, p.y - 50) < 8) return 30;
    if (std::hypot(p.x, p.y - 50) < 14) return 500;
    if (p.y < 5 && r > 42 && r < 54 && std::abs(p.z) < 20) return p.z > 5 ? 2200 : 900;
    return std::hypot(p.x, p.y - 12) < 12 ? -1000 : 40;
  });
  const Volume empty = drawn({100, 110, 90}, 2, [](Vec3 p) {
    const double r = std::sqrt(p.x * p.x / (66 * 66) + p.y * p.y / (84 * 84) + p.z * p.z / (70 * 70));
    return r > 1 && r < 1.09 ? 900 : -1000;
  });
  for (const Volume* v : {&jaw, &empty}) {
    Report report;
    EXPECT_EQ(refused(*v, BodyPart::head, &report), "");
    EXPECT_EQ(said(report), "unknown");
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_TRUE(has(report.warnings[0], "nothing says that a head was scanned")) << report.warnings[0];
  }
}

TEST(BodyPart, PhantomsOfSpineAndChestAreNotTakenForHeads) {
  phantom::BodyParams body;
  const Volume spine = phantom_of(phantom::scan(body.spine, coarse(120, 60), 1));
  const Volume chest = phantom_of(phantom::scan(body.chest, coarse(165, 90), 1));
  for (const Volume* v : {&spine, &chest}) {
    Report report;
    EXPECT_EQ(refused(*v, BodyPart::spine, &report), "");
    EXPECT_EQ(refused(*v, BodyPart::chest), "");
    EXPECT_EQ(std::get<std::string>(*report.find("shows_head")), "no");
  }
}

}  // namespace
}  // namespace trephine
