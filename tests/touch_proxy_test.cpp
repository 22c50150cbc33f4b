// SPDX-License-Identifier: GPL-3.0-or-later
// Tools on surfaces beside a haptic volume: nothing goes through, the force is the spring's, and corners hold.
#include <gtest/gtest.h>

#include "peers/slab.h"
#include "surface/inside_query.h"
#include "touch_meshes.h"

namespace trephine::touched {
namespace {

using walls::uniform;
using walls::unit_vector;

constexpr double mm_a_tick[] = {0.05, 0.1, 0.2, 0.4};  // 50 to 400 mm/s

std::vector<std::pair<const char*, haptics::ToolParams>> tools_of_all_kinds() {
  return {{"point", {}},
          {"ball", params_of("ball", 3)},
          {"rod", params_of("rod", 2.5, 20)},
          {"round_burr", params_of("round_burr", 4, 20)},
          {"catheter", params_of("catheter", 2.5, 12, 1)}};
}

haptics::Feels metal(double stiffness_n_per_mm = 0.5, double friction = 0) {
  haptics::Feels f = untouchable();
  f[mesh].front = f[mesh].back = face(stiffness_n_per_mm, friction, 0.8 * friction);
  return f;
}

// The comparison's pokes, at a proxy beside an empty volume.
class Poked : public peers::ContactAlgorithm {
 public:
  Poked(const Scene& scene, const haptics::Tool& tool) : proxy_(scene.space(), metal(), plain(), {}, tool) {}
  const haptics::HapticState& update(const haptics::HapticInput& in) override { return proxy_.update(in); }
  void reset() override { proxy_.reset(); }

 private:
  haptics::Proxy proxy_;
};

TEST(Touch, NoPokeComesThroughThePlateThatABareGodObjectFallsThrough) {
  const auto slab = peers::make_slab(0.5, 0.25);
  const Scene scene({{slab->mesh->mesh(), mesh}});
  for (const auto& [name, tool] : tools_of_all_kinds()) {
    Poked poked(scene, haptics::make_tool(tool));
    peers::PokeParams params;
    params.farthest_mm = 20;
    const int pokes = std::string(name) == "point" ? 300 : 20;
    for (const double mm : mm_a_tick) EXPECT_EQ(peers::count_falls(poked, *slab, mm, pokes, params), 0) << name << mm;
  }
  Poked poked(scene, {});
  for (const double mm : {1.0, 10.0, 100.0}) EXPECT_EQ(peers::count_falls(poked, *slab, mm, 300), 0) << mm;
}

// From random directions at hills and valleys, until the device is 3 mm deep.
TEST(Touch, NoPokeComesThroughASurfaceAsOfAnOrgan) {
  surface::TriMesh organ = round_mesh(70, organ_mm);  // 19,320 triangles
  const surface::InsideQuery query(organ);
  const Scene scene({{organ, mesh}});
  std::mt19937_64 rng(13);
  for (const auto& [name, params] : tools_of_all_kinds()) {
    const haptics::Tool tool = haptics::make_tool(params);
    haptics::Proxy proxy(scene.space(), metal(0.5, 0.3), plain(), {}, tool);
    const int pokes = tool.length_mm > 0 ? 24 : 300;
    int felt = 0;
    for (int n = 0; n < pokes; ++n) {
      const Vec3 out = unit_vector(rng), end = out * (organ_mm(out) - 3),
                 way = normalized(unit_vector(rng) - out * 2.0);
      const Vec3 axis = normalized(out + unit_vector(rng) * 0.3);
      const double step = mm_a_tick[n % 4];
      proxy.reset();
      haptics::HapticInput in = pose(end - way * 12, axis);
      for (double gone = 0; gone < 12.5; gone += step) {
        in.tip_mm = end + way * std::min(0.0, gone - 12);
        proxy.update(in);
        ASSERT_FALSE(query.inside(proxy.state().proxy_mm)) << name << " poke " << n << " at " << gone;
      }
      felt += proxy.state().touched == mesh && proxy.state().force_n != Vec3{};
      EXPECT_EQ(proxy.state().faults, 0u);
    }
    EXPECT_GT(felt, pokes * 3 / 4) << name;
  }
}

TEST(Touch, ThePressIsTheSpringsOnAPlaneFromBothSides) {
  const Vec3 normal = normalized(Vec3{0.3, -0.5, 0.8}), along = normalized(cross(normal, Vec3{1, 0, 0}));
  const Scene scene({{sheet({5, 6, 7}, along, cross(normal, along), 40, 30), mesh}});
  for (const double side : {1.0, -1.0})
    for (const auto& [name, params] : tools_of_all_kinds()) {
      const haptics::Tool tool = haptics::make_tool(params);
      haptics::Proxy proxy(scene.space(), metal(0.8), plain(), {}, tool);
      const Vec3 up = normal * side, at = Vec3{5, 6, 7} + along * 1.7 + cross(normal, along) * 0.3;
      for (double depth = -3; depth <= 2; depth += 0.02) proxy.update(pose(at - up * depth, up));
      for (int n = 0; n < 20; ++n) proxy.update(pose(at - up * 2.0, up));
      const haptics::HapticState& s = proxy.state();
      EXPECT_EQ(s.touched, mesh) << name;
      EXPECT_EQ(s.face, side > 0 ? 1 : 2) << name;
      EXPECT_NEAR(dot(s.force_n, up), 1.6, 0.02 * 1.6) << name << side;
      EXPECT_LT(norm(s.force_n - up * dot(s.force_n, up)), 0.02 * 1.6) << name << side;
      EXPECT_NEAR(dot(s.proxy_mm - Vec3{5, 6, 7}, up), 0, 0.005) << name << side;
    }
}

TEST(Touch, ThePressIsTheSpringsOnASphere) {
  const double radius = 12;
  const Scene scene({{round_mesh(70, [&](Vec3) { return radius; }), mesh}});
  std::mt19937_64 rng(17);
  for (const auto& [name, params] : tools_of_all_kinds()) {
    const haptics::Tool tool = haptics::make_tool(params);
    haptics::Proxy proxy(scene.space(), metal(1), plain(), {}, tool);
    for (int n = 0; n < 12; ++n) {
      const Vec3 out = unit_vector(rng);
      proxy.reset();
      for (double depth = -2; depth <= 1.5; depth += 0.05) proxy.update(pose(out * (radius - depth), out));
      for (int k = 0; k < 40; ++k) proxy.update(pose(out * (radius - 1.5), out));
      EXPECT_NEAR(norm(proxy.state().force_n), 1.5, 0.02 * 1.5) << name;
      EXPECT_GT(dot(normalized(proxy.state().force_n), out), 0.995) << name;
    }
  }
}

// Bone below, a plate that stands on it: in the corner both press, each with its own spring.
TEST(Touch, ACornerBetweenVolumeAndSurfaceHolds) {
  voxel::HapticVolume bone = haptic_scenes::empty(48, {0.5, 0.5, 0.5});
  fill(bone, 1, [](Vec3 p) { return -p.z; });
  const Scene scene({{sheet({4, 0, 0}, {0, 1, 0}, {0, 0, 1}, 16, 20), mesh}}, std::move(bone));
  haptics::Feels feels = metal(0.6);
  feels[1].front = feels[1].back = face(1);
  for (const auto& [name, params] : tools_of_all_kinds()) {
    const haptics::Tool tool = haptics::make_tool(params);
    const double radius =
        tool.round.empty() ? tool.length_mm > 0 ? 0.5 * params.tool_diameter_mm : 0 : tool.round[0].radius_mm;
    haptics::Proxy proxy(scene.space(), feels, plain(), {}, tool);
    // The hand goes down to the bone, and along it against the plate.
    for (double t = 0; t <= 1; t += 0.002) proxy.update(pose({-1, 0.3, 3 - 4 * t}, {0, 0, 1}));
    for (double t = 0; t <= 1; t += 0.002) proxy.update(pose({-1 + t * (7 - radius), 0.3, -1}, {0, 0, 1}));
    for (int n = 0; n < 50; ++n) proxy.update(pose({6 - radius, 0.3, -1}, {0, 0, 1}));
    const haptics::HapticState& s = proxy.state();
    EXPECT_GE(s.held_by, 2) << name;
    EXPECT_NEAR(s.force_n.x, -0.6 * 2, 0.02 * 1.2) << name;
    EXPECT_NEAR(s.force_n.z, 1, 0.02) << name;
    EXPECT_NEAR(s.proxy_mm.x, 4 - radius, 0.01) << name;
    EXPECT_NEAR(s.proxy_mm.z, 0, 0.02) << name;
  }
}

// A surface that is out of reach changes no bit of what is felt of the volume.
TEST(Touch, AFarSurfaceChangesNoBit) {
  const auto bone = [] {
    voxel::HapticVolume v = haptic_scenes::empty(48, {0.5, 0.5, 0.5});
    fill(v, 1, [](Vec3 p) { return 8 - norm(p); });
    return v;
  };
  const Scene scene({{sheet({0, 0, 40}, {1, 0, 0}, {0, 1, 0}, 20, 10), mesh}}, bone());
  haptics::Feels feels = metal();
  feels[1].front = feels[1].back = face(1, 0.35, 0.3);
  for (const auto& [name, params] : tools_of_all_kinds()) {
    const haptics::Tool tool = haptics::make_tool(params);
    haptics::Proxy beside(scene.space(), feels, plain(), {}, tool), alone(*scene.contact, feels, plain(), {}, tool);
    for (int n = 0; n < 2000; ++n) {
      const double a = 0.003 * n;
      const haptics::HapticInput in = pose(
          Vec3{std::sin(a), std::cos(a), 0.5 * std::sin(2 * a)} * (9 - 2.5 * std::sin(a / 2)), {0.3, std::sin(a), 1});
      const haptics::HapticState x = beside.update(in), y = alone.update(in);
      ASSERT_EQ(x.force_n, y.force_n) << name << n;
      ASSERT_EQ(x.proxy_mm, y.proxy_mm) << name << n;
    }
  }
}

// A tool that begins in a closed surface is brought out of it.
TEST(Touch, AToolThatBeginsWithinASurfaceComesOut) {
  const surface::TriMesh organ = round_mesh(30, organ_mm);
  const surface::InsideQuery query(organ);
  const Scene scene({{organ, mesh}});
  for (const auto& [name, params] : tools_of_all_kinds()) {
    haptics::Proxy proxy(scene.space(), metal(), plain(), {}, haptics::make_tool(params));
    for (int n = 0; n < 200; ++n) proxy.update(pose({16, 1, 2}, {1, 0, 0}));
    EXPECT_FALSE(query.inside(proxy.state().proxy_mm)) << name;
    EXPECT_GT(norm(proxy.state().force_n), 0.5) << name;
  }
}

TEST(Touch, FrictionOnASurfaceIsItsRatio) {
  const Scene scene({{sheet({}, {1, 0, 0}, {0, 1, 0}, 60, 40), mesh}});
  haptics::Feels feels = metal(1);
  feels[mesh].front = feels[mesh].back = face(1, 0.35, 0.3);
  for (const auto& [name, params] : {std::pair{"point", haptics::ToolParams{}}, {"ball", params_of("ball", 3)}}) {
    haptics::Proxy proxy(scene.space(), feels, plain(), {}, haptics::make_tool(params));
    for (double z = 1; z > -1; z -= 0.01) proxy.update(pose({-10, 0, z}, {0, 0, 1}));
    for (double x = -10; x < 5; x += 0.05) proxy.update(pose({x, 0, -1}, {0, 0, 1}));
    EXPECT_NEAR(-proxy.state().force_n.x, 0.3, 0.01) << name;
    EXPECT_NEAR(proxy.state().force_n.z, 1, 0.02) << name;
  }
}

}  // namespace
}  // namespace trephine::touched
