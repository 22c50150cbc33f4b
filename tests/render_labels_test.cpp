// SPDX-License-Identifier: GPL-3.0-or-later
#include "render_scene.h"

using namespace trephine;
using namespace trephine::drawing;

namespace {

scene::SceneData two_balls() {
  scene::SceneData s;
  s.surfaces = {surface_of(case_samples::ball(40, 40), "outer", {0.9, 0.5, 0.4}),
                surface_of(case_samples::ball(20, 40), "inner", {0.3, 0.5, 0.9})};
  s.bounds = {{-45, -45, -45}, {45, 45, 45}};
  return s;
}

scene::EyeView from_above() {
  scene::OrbitCamera camera;
  camera.toward = {0, 0, 1};
  camera.up = {0, -1, 0};
  camera.distance_mm = 300;
  return camera.eye(width, height, two_balls().bounds);
}

std::size_t at(int x, int y) { return std::size_t(y) * width + std::size_t(x); }

}  // namespace

// What is opaque has a label and a distance in each pixel's middle; what is seen through has none.
TEST_F(Picture, LabelsAndDepth) {
  render::Renderer renderer(two_balls(), {});
  scene::SceneState state;
  state.opacity = {1, 1};
  const render::LabelPicture outer = render::draw_labels(renderer, from_above(), state, width, height);
  const double top_mm = 40 * case_samples::bump({0, 0, 1});
  EXPECT_EQ(1, outer.label[at(width / 2, height / 2)]);
  EXPECT_NEAR(300 - top_mm, outer.depth_mm[at(width / 2, height / 2)], 0.03);
  EXPECT_EQ(0, outer.label[0]);
  EXPECT_EQ(0, outer.depth_mm[0]);

  state.opacity = {0.5, 1};
  const render::LabelPicture inner = render::draw_labels(renderer, from_above(), state, width, height);
  EXPECT_EQ(2, inner.label[at(width / 2, height / 2)]);
  EXPECT_NEAR(300 - top_mm / 2, inner.depth_mm[at(width / 2, height / 2)], 0.03);

  // The tool hides what is behind it, and a picture before does not change what is seen.
  renderer.set_tool(scene::ball_solid(3, {1, 1, 1}, 24));
  state.tool_shown = true;
  state.tip_mm = {0, 0, 60};
  drawn(renderer, from_above(), state);
  const render::LabelPicture tool = render::draw_labels(renderer, from_above(), state, width, height);
  EXPECT_EQ(3, tool.label[at(width / 2, height / 2)]);
  EXPECT_NEAR(300 - 63, tool.depth_mm[at(width / 2, height / 2)], 0.03);
  EXPECT_EQ(inner.label[at(width / 2 + 20, height / 2)], tool.label[at(width / 2 + 20, height / 2)]);
  for (std::size_t n = 0; n < tool.label.size(); ++n) ASSERT_EQ(tool.label[n] > 0, tool.depth_mm[n] > 0);
}

// Rows are counted from the top, as a picture's.
TEST_F(Picture, LabelsAreTheRightWayUp) {
  render::Renderer renderer(two_balls(), {});
  renderer.set_tool(scene::ball_solid(5, {1, 1, 1}, 12));
  scene::SceneState state;
  state.opacity = {0, 0};
  state.tool_shown = true;
  state.tip_mm = {20, -30, 0};
  const scene::EyeView eye = from_above();
  const Vec3 where = eye.project(state.tip_mm, width, height);
  const render::LabelPicture seen = render::draw_labels(renderer, eye, state, width, height);
  EXPECT_EQ(3, seen.label[at(int(where.x), int(where.y))]);
  EXPECT_EQ(0, seen.label[at(int(where.x), height - 1 - int(where.y))]);
  EXPECT_EQ(0, seen.label[at(width - 1 - int(where.x), int(where.y))]);
}
