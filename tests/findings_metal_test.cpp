// SPDX-License-Identifier: GPL-3.0-or-later
// Metal in the head, and what looks like it.
#include <gtest/gtest.h>

#include "findings_scene.h"

namespace trephine {
namespace {

/// Sets the voxels about a point to `hu`.
void plate(Scene& scene, Vec3 at_mm, int half, int hu) {
  auto& grid = std::get<grid::Grid<std::int16_t>>(scene.volume);
  const Vec3 p = grid.to_index(at_mm);
  for (int k = -1; k <= 1; ++k)
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i)
        grid.at(int(std::lround(p.x)) + i, int(std::lround(p.y)) + j, int(std::lround(p.z)) + k) = std::int16_t(hu);
}

// A scan that shows the skull as dense as 2300 HU shows the bone about the inner ear at 2750.
TEST(Findings, MetalIsDenserThanTheBoneOfItsScanAndInTheHead) {
  const Vec3 ear{40, 8, 22}, left{45, -30, 95}, right{-45, -30, 95}, clamp{-105, 40, 70};
  const auto of_scan = [](int bone_hu, const std::vector<std::pair<Vec3, int>>& plates) {
    const Scene s({}, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head&) {
      auto& grid = std::get<grid::Grid<std::int16_t>>(scene.volume);
      for (std::size_t v = 0; v < grid.voxels.size(); ++v)
        if (scene.skull.voxels[v] > 1) grid.voxels[v] = std::int16_t(bone_hu);
      for (const auto& [at, hu] : plates) plate(scene, at, 3, hu);
    });
    return s.of(FindingKind::metal);
  };
  const auto usual = of_scan(1500, {{ear, 2750}, {clamp, 3050}});
  ASSERT_EQ(usual.size(), 1u);
  EXPECT_EQ(Scene::figure(usual[0], "pieces_count"), 1) << "the clamp beside the head is none of the head's";
  EXPECT_GT(usual[0].confidence, findings::sure_confidence);

  const auto dense = of_scan(2300, {{left, 3050}, {right, 2750}, {ear, 2850}});
  ASSERT_EQ(dense.size(), 2u);
  EXPECT_EQ(Scene::figure(dense[0], "pieces_count"), 1);
  EXPECT_EQ(Scene::figure(dense[0], "mean_hu"), 3050);
  EXPECT_GT(dense[0].confidence, findings::sure_confidence);
  EXPECT_EQ(Scene::figure(dense[1], "pieces_count"), 2) << "told, though as doubtful";
  EXPECT_LT(dense[1].confidence, findings::sure_confidence);
}

// A large implant is not what metal is compared with, and a frame around the head is none of the head's.
TEST(Findings, ALargeImplantIsMetalAndAFrameAroundTheHeadIsNone) {
  const auto of_scan = [](const std::function<bool(Vec3, bool bone)>& is_metal) {
    const Scene s({}, phantom::Variant::normal, 2, 5, [&](Scene& scene, const phantom::Head&) {
      auto& grid = std::get<grid::Grid<std::int16_t>>(scene.volume);
      for (int k = 0; k < grid.size[2]; ++k)
        for (int j = 0; j < grid.size[1]; ++j)
          for (int i = 0; i < grid.size[0]; ++i) {
            const bool bone = scene.skull.at(i, j, k) > 1;
            if (bone) grid.at(i, j, k) = 1500;
            if (is_metal(grid.to_world_mm({double(i), double(j), double(k)}), bone)) grid.at(i, j, k) = 3050;
          }
    });
    return s.of(FindingKind::metal);
  };
  const auto implant = of_scan([](Vec3 p, bool bone) { return bone && p.x > 20 && p.z > 70; });
  ASSERT_EQ(implant.size(), 1u);
  EXPECT_GT(Scene::figure(implant[0], "volume_ml"), 10);
  EXPECT_GT(implant[0].confidence, findings::sure_confidence);
  // A bow from ear to ear over the back: the middle of its box lies in the brain.
  const auto frame = of_scan([](Vec3 p, bool) {
    const double from_middle_mm = std::hypot(p.x, p.y);
    return std::abs(p.z - 80) < 5 && from_middle_mm > 108 && from_middle_mm < 113 && p.y > -60;
  });
  for (const Finding& f : frame) ADD_FAILURE() << f.text << f.position_mm.x << " " << f.position_mm.y;
}

TEST(Findings, MetalLiesWhereItIsSaidToLie) {
  const auto hu_at = [](const Scene& s, Vec3 lps) {
    const auto& grid = std::get<grid::Grid<std::int16_t>>(s.volume);
    const Vec3 p = grid.to_index(lps);
    return grid.at(int(std::lround(p.x)), int(std::lround(p.y)), int(std::lround(p.z)));
  };
  // Two plates: between them, where their middle is, no metal lies.
  const Scene s({}, phantom::Variant::normal, 2, 5, [](Scene& scene, const phantom::Head&) {
    for (const double side : {-1.0, 1.0}) plate(scene, {45 * side, -30, 95}, 3, 3050);
  });
  const auto metal = s.of(FindingKind::metal);
  ASSERT_EQ(metal.size(), 1u);
  EXPECT_EQ(Scene::figure(metal[0], "pieces_count"), 2);
  EXPECT_EQ(hu_at(s, metal[0].position_mm), 3050);
}

}  // namespace
}  // namespace trephine
