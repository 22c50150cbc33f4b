// SPDX-License-Identifier: GPL-3.0-or-later
// The tool beside what is cut away.
#include <gtest/gtest.h>

#include "render/stage.h"
#include "render_scene.h"

namespace trephine::drawing {

class RenderTool : public Picture {};

// What is cut away is the patient: the tool stays whole, also where the plane goes through its tip.
TEST_F(RenderTool, ACutLeavesTheToolWhole) {
  scene::SceneData scene;
  scene.bounds = {{-60, -60, -60}, {60, 60, 60}};
  scene.surfaces = {surface_of(case_samples::ball(20, 24), "ball", {0.9, 0.8, 0.7})};
  render::Renderer renderer(scene, {1, false, 9, false, false, 0, {}});
  haptics::ToolParams burr;
  burr.tool = "burr";
  renderer.set_tool(scene::solid_of(haptics::own_tool(burr)));
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  const scene::EyeView eye = camera.eye(width, height, scene.bounds);
  scene::SceneState state;
  state.opacity = {1};
  state.tool_shown = true;
  state.tip_mm = {0, -30, 25};
  state.axis = normalized(Vec3{0.3, 0.1, 1});
  const trephine::scene::Picture whole = drawn(renderer, eye, state);
  for (const Vec3 normal : {Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}}) {
    state.cut = scene::CutPlane{state.tip_mm, normal};
    const trephine::scene::Picture cut = drawn(renderer, eye, state);
    int seen = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t n = 3 * std::size_t(y * width + x);
        if (eye.project({0, 0, 20.5}, width, height).y < y) continue;  // beside the ball
        seen += whole.rgb[n] > 40;
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(cut.rgb[n + c], whole.rgb[n + c]) << x << " " << y;
      }
    EXPECT_GT(seen, 100);
  }
}

}  // namespace trephine::drawing
