// SPDX-License-Identifier: GPL-3.0-or-later
// Bone dust in a picture: it is seen where it lies, and nothing else is drawn otherwise for it.
#include <cmath>

#include "render_scene.h"
#include "scene/bone_dust.h"

namespace trephine::drawing {
namespace {

class RenderDust : public Picture {};

// A plate of many chunks, and dust about its middle.
TEST_F(RenderDust, IsSeenWhereItLiesAndCostsNoTriangle) {
  scene::SceneSurface plate;
  plate.name = "plate";
  plate.colour_rgb = {0.5, 0.4, 0.3};
  constexpr int side = 160;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i)
      plate.vertices.push_back({{float(200.0 * i / side - 100), float(200.0 * j / side - 100), 0}, {0, 0, 127, 0}});
  for (std::uint32_t j = 0; j < side; ++j)
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t a = i + j * (side + 1), b = a + side + 1;
      for (const std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b}) plate.indices.push_back(corner);
    }
  scene::SceneData scene;
  scene.bounds = {{-100, -100, -1}, {100, 100, 30}};
  scene.surfaces = {plate};
  render::RenderQuality quality;
  quality.samples = 1;
  quality.occlusion = false;
  render::Renderer renderer(scene, quality);
  scene::EyeView eye;
  eye.eye_mm = {0, 0, 300};
  scene::SceneState state;
  state.opacity = {1};
  const trephine::scene::Picture without = drawn(renderer, eye, state);
  const std::size_t triangles = renderer.drawn_triangles();
  ASSERT_GT(triangles, 1000u);
  const auto dust = std::make_shared<scene::BoneDust>();
  scene::BoneDust::Tick tick;
  tick.runs = tick.cuts = true;
  for (int n = 0; n < 4000; ++n) {
    tick.tip_mm = {2 * std::cos(0.01 * n), 2 * std::sin(0.01 * n), 0};
    dust->add(tick);
  }
  ASSERT_TRUE(dust->any());
  state.dust = dust;
  const trephine::scene::Picture with = drawn(renderer, eye, state);
  EXPECT_EQ(renderer.drawn_triangles(), triangles);
  const double half = 0.5 * scene::BoneDust::side * scene::BoneDust::cell_mm;
  const Vec3 low = eye.project({-half - 1, half + 1, 0}, width, height),
             high = eye.project({half + 1, -half - 1, 0}, width, height);
  int paler = 0, elsewhere = 0;
  for (int n = 0; n < width * height; ++n) {
    const int more = int(with.rgb[std::size_t(3 * n)]) - int(without.rgb[std::size_t(3 * n)]);
    if (more == 0) continue;
    const double x = n % width + 0.5, y = n / width + 0.5;
    const bool inside = x > std::min(low.x, high.x) && x < std::max(low.x, high.x) && y > std::min(low.y, high.y) &&
                        y < std::max(low.y, high.y);
    (inside ? paler : elsewhere) += inside ? more > 20 : 1;
  }
  EXPECT_GT(paler, 20) << "it is seen";
  EXPECT_EQ(elsewhere, 0);
  state.dust = nullptr;
  EXPECT_EQ(drawn(renderer, eye, state).rgb, without.rgb);
}

}  // namespace
}  // namespace trephine::drawing
