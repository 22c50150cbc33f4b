// SPDX-License-Identifier: GPL-3.0-or-later
// What is spared where pictures take too long: triangles that are far from the tool, and have not been cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render_scene.h"

namespace trephine::drawing {
class RenderSpare : public PlayCase {};

// Far from the tool triangles are fewer, next to it every pixel is as it was, and nothing shows through a gap.
TEST_F(RenderSpare, NextToTheToolSurfacesStayWhole) {
  scene::SceneData scene;
  const surface::TriMesh ball = case_samples::ball(100, 150);
  scene.bounds = surface::bounds_of(ball);
  scene.surfaces = {surface_of(ball, "ball", {0.9, 0.8, 0.7})};
  render::RenderQuality quality{1, false, 9, false, false, 0, {}};
  render::Renderer renderer(scene, quality);
  renderer.set_background({0, 0, 1});
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  const scene::EyeView eye = camera.eye(width, height, scene.bounds);
  scene::SceneState state;
  state.opacity = {1};
  state.tip_mm = {0, -100, 0};
  state.tool_shown = true;
  const trephine::scene::Picture whole = drawn(renderer, eye, state);
  const std::size_t all = renderer.drawn_triangles();
  quality.coarse = {6, 15};
  renderer.set_quality(quality);
  ASSERT_TRUE(make_coarse(renderer, 0, 6));
  const trephine::scene::Picture coarse = drawn(renderer, eye, state);
  EXPECT_LT(renderer.drawn_triangles(), all * 2 / 3);
  EXPECT_NE(coarse.rgb, whole.rgb);
  const Vec3 tip = eye.project(state.tip_mm, width, height);
  int near = 0, gaps = 0;
  const auto blue = [](const trephine::scene::Picture& p, std::size_t n) {
    return p.rgb[n + 2] > 200 && p.rgb[n] < 60;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t n = 3 * std::size_t(y * width + x);
      const double away_mm = std::hypot(x + 0.5 - tip.x, y + 0.5 - tip.y) * camera.mm_per_px(height);
      if (away_mm < 12) {
        ++near;
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(coarse.rgb[n + c], whole.rgb[n + c]) << x << " " << y;
      }
      // The background is blue: at the silhouette it may come in by the bound, elsewhere it would be a gap.
      gaps += away_mm < 80 && blue(coarse, n) && !blue(whole, n);
    }
  EXPECT_GT(near, 100);
  EXPECT_EQ(gaps, 0);
  // Through a cut everything is whole, as it is when nothing is to be spared.
  state.cut = scene::CutPlane{{0, -50, 0}, {0, -1, 0}};
  const trephine::scene::Picture cut = drawn(renderer, eye, state);
  quality.coarse = {};
  renderer.set_quality(quality);
  EXPECT_EQ(drawn(renderer, eye, state).rgb, cut.rgb);
  state.cut.reset();
  EXPECT_EQ(drawn(renderer, eye, state).rgb, whole.rgb);
}

// What is cut is whole, wherever the tool is: a hole looks as it does without coarse triangles.
TEST_F(RenderSpare, WhatIsCutIsNotCoarse) {
  render::Stage stage(loaded_, view_);
  for (const char* other : {"scalp", "brain"}) stage.state.opacity[std::size_t(stage.scene().find(other))] = 0;
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, stage.scene().bounds, {}, {});
  stage.set_quality(view_, 1, {5, 10});
  stage.wait_for_coarse();
  const trephine::scene::Picture before = shot(stage, camera);
  const std::size_t coarse = stage.renderer().drawn_triangles();
  stage.set_quality(view_, 1);
  shot(stage, camera);
  EXPECT_LT(coarse, stage.renderer().drawn_triangles() / 2);
  // A hole of 8 mm in the skull's front, while it is coarse.
  stage.set_quality(view_, 1, {5, 10});
  stage.wait_for_coarse();
  voxel::HapticVolume& v = loaded_.haptic;
  const surface::Bounds& b = stage.scene().bounds;
  const Vec3 at{(b.min_mm.x + b.max_mm.x) / 2, (b.min_mm.y + b.max_mm.y) / 2 - 35, (b.min_mm.z + b.max_mm.z) / 2};
  drill::DirtyBricks marks(v.voxels);
  std::size_t cleared = 0;
  const voxel::HapticShape& skull = *v.find_shape("skull");
  for (int k = 0; k < v.voxels.size[2]; ++k)
    for (int j = 0; j < v.voxels.size[1]; ++j)
      for (int i = 0; i < v.voxels.size[0]; ++i) {
        std::int16_t& value = v.voxels.at(i, j, k);
        const Vec3 p = v.voxels.to_world_mm({double(i), double(j), double(k)});
        if (norm(p - at) > 8 || value < skull.window_low || value > skull.window_high) continue;
        value = voxel::haptic_empty;
        marks.mark_voxel(i, j, k);
        ++cleared;
      }
  ASSERT_GT(cleared, 50u);
  EXPECT_GT(stage.follow(marks), 0u);
  const trephine::scene::Picture hole = shot(stage, camera);
  render::Stage anew(loaded_, view_);
  anew.state.opacity = stage.state.opacity;
  const trephine::scene::Picture whole = shot(anew, camera);
  const Vec3 seen = camera.eye(width, height, b).project(at, width, height);
  int there = 0, changed = 0, other = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (std::hypot(x + 0.5 - seen.x, y + 0.5 - seen.y) * camera.mm_per_px(height) > 8) continue;
      const std::size_t n = 3 * std::size_t(y * width + x);
      ++there;
      changed += std::abs(before.rgb[n] - hole.rgb[n]) > 20;
      other += std::abs(hole.rgb[n] - whole.rgb[n]) > 12;
    }
  EXPECT_GT(there, 200);
  EXPECT_GT(changed, there / 4) << "the hole is seen";
  EXPECT_LT(other, there / 50) << "beside what is seen through it, which is coarse";
}

// Where a window has a buffer for each eye, each has what it has in a half of a picture side by side.
TEST_F(RenderSpare, ABufferForEachEyeHasItsHalf) {
  view_.stereo = scene::ViewParams::Stereo::quad_buffer;
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  render::OffscreenPicture left(width, height), right(width, height);
  std::vector<render::Eye> asked;
  stage.draw(camera, width, height, [&](render::Eye eye) {
    asked.push_back(eye);
    (eye == render::Eye::right ? right : left).bind();
  });
  EXPECT_EQ(asked, (std::vector<render::Eye>{render::Eye::left, render::Eye::right, render::Eye::both}))
      << "panels are drawn for both";
  view_.stereo = scene::ViewParams::Stereo::side_by_side;
  stage.set_view(view_);
  const trephine::scene::Picture both = shot(stage, camera, 2 * width, height), l = left.read(), r = right.read();
  EXPECT_NE(l.rgb, r.rgb);
  for (int y = 0; y < height; ++y) {
    const auto* row = both.rgb.data() + std::size_t(6 * y * width);
    ASSERT_TRUE(std::equal(row, row + 3 * width, l.rgb.data() + std::size_t(3 * y * width))) << y;
    ASSERT_TRUE(std::equal(row + 3 * width, row + 6 * width, r.rgb.data() + std::size_t(3 * y * width))) << y;
  }
}

}  // namespace trephine::drawing
