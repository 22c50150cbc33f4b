// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness that follows the HU of a raw CT.
#include <gtest/gtest.h>

#include "touch_meshes.h"

namespace trephine::touched {
namespace {

// HU rise from 340 at x = -14 mm to 1,460 at x = 14 mm below a plane, with air above.
double hu_at(double x_mm) { return 900 + 40 * x_mm; }

struct RampScene {
  voxel::HapticVolume volume;
  cases::CaseHaptic haptic;
  std::unique_ptr<contact::ContactVolume> contact;
  haptics::Feels feels;
  std::unique_ptr<touch::StiffnessRamps> ramps;

  explicit RampScene(Vec3 normal, std::vector<voxel::TransferPoint> points, Vec3 spacing_mm = {0.5, 0.5, 0.5}) {
    volume = haptic_scenes::empty(56, spacing_mm);
    volume.encoding = voxel::HapticEncoding::hu;
    volume.shapes = {{"bone", 1, 200, 3000}};
    const double ramp = 0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) * spacing_mm.x;
    for (int k = 0; k < 56; ++k)
      for (int j = 0; j < 56; ++j)
        for (int i = 0; i < 56; ++i) {
          const Vec3 p = volume.voxels.to_world_mm({double(i), double(j), double(k)});
          const double share = std::clamp(0.5 - dot(normal, p) / (2 * ramp), 0.0, 1.0);  // as a scanner blurs an edge
          volume.voxels.at(i, j, k) = std::int16_t(std::lround(share * hu_at(p.x) - 1000 * (1 - share)));
        }
    cases::CaseShape shape;
    shape.name = "bone";
    shape.window_low = 200;
    shape.window_high = 3000;
    shape.material.front = face(0.9);
    shape.material.back = face(0.9);
    if (!points.empty()) shape.transfer.emplace().points = std::move(points);
    haptic.encoding = "hu";
    haptic.shapes = {shape};
    contact = std::make_unique<contact::ContactVolume>(volume);
    feels = haptics::feels_of(haptic);
    ramps = std::make_unique<touch::StiffnessRamps>(haptic);
  }
  touch::FeltSpace space() const { return {*contact, {nullptr, ramps->any() ? ramps.get() : nullptr}}; }

  // The stiffness that is felt where the tool is pressed 0.5 mm deep above x, as it slides there, and where it touches.
  std::pair<double, double> felt_at(haptics::Proxy& proxy, Vec3 normal, double x_mm, double radius_mm = 0) const {
    const Vec3 along = normalized(Vec3{1, 0, 0} - normal * normal.x);
    const Vec3 at = along * (x_mm / along.x) - normal * 0.5;
    for (int n = 0; n < 30; ++n) proxy.update(pose(at - along * (0.01 * (29 - n)), normal));
    const haptics::HapticState& s = proxy.state();
    const double touches_mm = (s.proxy_mm + (normal - s.normal) * radius_mm).x;
    return {dot(s.force_n, s.normal) / dot(s.proxy_mm - at, s.normal), touches_mm};
  }
};

const std::vector<voxel::TransferPoint> ramp = {
    {200, 0, {1, 1, 1}, 0.5}, {600, 0.6, {1, 1, 1}, 0.7}, {1000, 0.9, {1, 1, 1}, 1.2}, {1600, 1, {1, 1, 1}, 2.0}};

TEST(Touch, StiffnessFollowsTheRampOfHu) {
  for (const Vec3 normal : {Vec3{0, 0, 1}, normalized(Vec3{0, 0.4, 0.9}), normalized(Vec3{0, -0.7, 0.7})})
    for (const auto& [name, params] : {std::pair{"point", haptics::ToolParams{}}, {"ball", params_of("ball", 3)}}) {
      const RampScene scene(normal, ramp);
      const voxel::TransferFunction& f = *scene.haptic.shapes[0].transfer;
      haptics::Proxy proxy(scene.space(), scene.feels, plain(), {}, haptics::make_tool(params));
      for (double z = 2; z > -0.5; z -= 0.01) proxy.update(pose(normal * z + Vec3{-12, 0, 0}, normal));
      for (double x = -12; x <= 12; x += 0.75) {
        const auto [felt, at] = scene.felt_at(proxy, normal, x, 0.5 * params.tool_diameter_mm);
        const double expected = voxel::at_hu(f, hu_at(at)).stiffness_n_per_mm;
        EXPECT_NEAR(felt, expected, 0.02 * expected) << name << " at " << at;
      }
    }
}

TEST(Touch, AShapeWithoutARampIsAsStiffAsItsMaterial) {
  const Vec3 normal{0, 0, 1};
  auto plain_points = ramp;
  for (voxel::TransferPoint& p : plain_points) p.stiffness_n_per_mm = 0;
  for (const auto& points : {std::vector<voxel::TransferPoint>{}, plain_points}) {
    const RampScene scene(normal, points);
    EXPECT_FALSE(scene.ramps->any());
    EXPECT_EQ(scene.feels[1].front.stiffness_n_per_mm, 0.9);
    haptics::Proxy proxy(scene.space(), scene.feels, plain());
    for (double z = 2; z > -0.5; z -= 0.01) proxy.update(pose({-12, 0, z}, normal));
    EXPECT_NEAR(scene.felt_at(proxy, normal, 3).first, 0.9, 0.01);
  }
}

// What bounds walls, behind a delay and against jumps, knows the largest stiffness that the ramp gives.
TEST(Touch, AShapeWithARampIsBoundedByItsStiffestPlace) {
  const RampScene scene({0, 0, 1}, ramp);
  EXPECT_EQ(scene.feels[1].front.stiffness_n_per_mm, 2.0);
  EXPECT_EQ(scene.feels[1].back.stiffness_n_per_mm, 2.0);
}

}  // namespace
}  // namespace trephine::touched
