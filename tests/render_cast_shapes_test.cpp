// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes of a haptic volume in the renderer's pictures are those of the reference ray caster, and follow cuts.
#include "cast_shapes.h"
#include "render_cast_scene.h"

namespace trephine::drawing {
namespace {

class RenderCastShapes : public Picture {};

scene::SceneData scene_of(const grid::Lattice& l) {
  scene::SceneData s;
  s.centre_mm = casting::middle_of(l);
  s.bounds = {s.centre_mm - Vec3{30, 30, 30}, s.centre_mm + Vec3{30, 30, 30}};
  return s;
}

TEST_F(RenderCastShapes, AreThePictureOfTheReference) {
  const casting::Nested n = casting::nested(44);
  const grid::Lattice& l = n.volume.voxels;
  render::RenderQuality quality;
  quality.samples = 1;
  quality.occlusion = quality.grain = false;
  cast::CastShapes shapes(n.volume, n.haptic);
  for (const std::array<double, 3> opacity : {std::array<double, 3>{1, 1, 1}, {0.1, 0.3, 1}, {0, 0.05, 0.4}})
    for (const bool cut : {false, true}) {
      for (int s = 1; s <= 3; ++s) shapes.set_opacity(s, opacity[std::size_t(s - 1)]);
      render::Renderer renderer(scene_of(l), quality);
      const scene::EyeView eye = eye_of_picture(l, {0.3, -0.5, 0.8});
      scene::SceneState state;
      const trephine::scene::Picture behind = drawn(renderer, eye, state);
      cast::CastParams params;
      if (cut) params.cut = state.cut = scene::CutPlane{casting::middle_of(l), {0.2, -0.3, 1}};
      renderer.rays().show(shapes);
      const Difference d =
          compare(drawn(renderer, eye, state),
                  cast::cast_rays(shapes, cast::CastBricks(shapes), eye, width, height, params), behind);
      EXPECT_GT(d.covered, 8000);
      EXPECT_LE(d.median, median_most);
      EXPECT_LE(d.p95, p95_most);
    }
}

// The case of a window's tests, whose haptic volume holds shapes.
class RenderShapesStage : public PlayCase {
 protected:
  void SetUp() override {
    PlayCase::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    view_.occlusion = view_.grain = false;
    view_.view = scene::ViewPreset::front;
    view_.cast = scene::ViewParams::Cast::haptic;
  }
};

int changed(const trephine::scene::Picture& a, const trephine::scene::Picture& b) {
  int n = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) n += !std::equal(&a.rgb[i], &a.rgb[i] + 3, &b.rgb[i]);
  return n;
}

TEST_F(RenderShapesStage, WhatIsCutIsGoneAndComesBack) {
  const grid::Grid<std::int16_t> uncut = loaded_.haptic.voxels;
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture before = shot(stage, camera);
  drill::DirtyBricks marks(loaded_.haptic.voxels);
  const auto cut = [&](bool empty) {
    for (int k = 30; k < 44; ++k)
      for (int j = 0; j < 30; ++j)
        for (int i = 28; i < 46; ++i) {
          loaded_.haptic.voxels.at(i, j, k) = empty ? voxel::haptic_empty : uncut.at(i, j, k);
          marks.mark_voxel(i, j, k);
        }
    stage.follow(marks);
  };
  cut(true);
  const trephine::scene::Picture after = shot(stage, camera);
  EXPECT_GT(changed(before, after), 200);
  render::Stage later(loaded_, view_, &uncut);
  EXPECT_EQ(shot(later, camera).rgb, after.rgb);
  cut(false);
  EXPECT_EQ(shot(stage, camera).rgb, before.rgb);
}

// A shape is as opaque as its surface would be; what is hidden shows what lies within.
TEST_F(RenderShapesStage, AShapeIsAsOpaqueAsTheWindowSays) {
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const trephine::scene::Picture whole = shot(stage, camera);
  for (std::size_t n = 0; n < stage.scene().surfaces.size(); ++n)
    EXPECT_EQ(stage.state.opacity[n], stage.scene().surfaces[n].shape != 0 ? 1 : 0);
  stage.state.opacity[0] = 0;
  const trephine::scene::Picture within = shot(stage, camera);
  EXPECT_GT(changed(whole, within), 500);
  view_.opacity = stage.scene().surfaces[0].name + "=0";
  render::Stage named(loaded_, view_);
  EXPECT_EQ(shot(named, camera).rgb, within.rgb);
  stage.state.opacity[0] = 1;
  EXPECT_EQ(shot(stage, camera).rgb, whole.rgb);
  // And without rays the surfaces are drawn again.
  stage.cast(scene::ViewParams::Cast::none, "");
  view_.cast = scene::ViewParams::Cast::none;
  view_.opacity = "";
  render::Stage surfaces(loaded_, view_);
  EXPECT_EQ(shot(stage, camera).rgb, shot(surfaces, camera).rgb);
}

}  // namespace
}  // namespace trephine::drawing
