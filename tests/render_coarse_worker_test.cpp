// SPDX-License-Identifier: GPL-3.0-or-later
// Coarser triangles that come from a thread of their own, while what they were made of changes.
#include "render/coarse_worker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render_scene.h"

namespace trephine::drawing {
namespace {

constexpr std::size_t any_bytes = std::size_t{1} << 40;

std::shared_ptr<const render::SurfaceParts> shared(const scene::SceneSurface& s) {
  return std::make_shared<const render::SurfaceParts>(render::parts_of(s));
}

std::vector<render::CoarseMade> all_of(render::CoarseWorker& worker) {
  std::vector<render::CoarseMade> out;
  while (worker.busy()) {
    worker.wait();
    if (auto made = worker.take()) out.push_back(std::move(*made));
  }
  return out;
}

class RenderCoarseMeanwhile : public PlayCase {
 protected:
  static constexpr double coarse_mm = 5;
  // Changes voxels of the skull, and lets the stage follow.
  template <class Change>
  void change(render::Stage& stage, const Change& change_voxel) {
    voxel::HapticVolume& v = loaded_.haptic;
    drill::DirtyBricks marks(v.voxels);
    for (int k = 0; k < v.voxels.size[2]; ++k)
      for (int j = 0; j < v.voxels.size[1]; ++j)
        for (int i = 0; i < v.voxels.size[0]; ++i)
          if (change_voxel(v.voxels.to_world_mm({double(i), double(j), double(k)}), v.voxels.at(i, j, k)))
            marks.mark_voxel(i, j, k);
    EXPECT_GT(stage.follow(marks), 0u);
  }
  void drill(render::Stage& stage) {
    const surface::Bounds& b = stage.scene().bounds;
    const Vec3 at{(b.min_mm.x + b.max_mm.x) / 2, (b.min_mm.y + b.max_mm.y) / 2 - 35, (b.min_mm.z + b.max_mm.z) / 2};
    const voxel::HapticShape& skull = *loaded_.haptic.find_shape("skull");
    change(stage, [&](Vec3 p, std::int16_t& value) {
      if (norm(p - at) > 8 || value < skull.window_low || value > skull.window_high) return false;
      value = voxel::haptic_empty;
      return true;
    });
  }
  // The skull as something quite different, of many more triangles than its buffers have room for.
  void make_noise(render::Stage& stage) {
    const voxel::HapticShape& skull = *loaded_.haptic.find_shape("skull");
    const surface::Bounds& b = stage.scene().bounds;
    std::mt19937 random(7);
    change(stage, [&](Vec3 p, std::int16_t& value) {
      if (norm(p - (b.min_mm + b.max_mm) / 2) > 36) return false;  // the scalp is larger
      value = random() & 1 ? std::int16_t(skull.window_high) : voxel::haptic_empty;
      return true;
    });
  }
  scene::OrbitCamera camera(const render::Stage& stage) const {
    scene::OrbitCamera c;
    c.look(scene::ViewPreset::front, stage.scene().bounds, {}, {});
    return c;
  }
  static void show_skull(render::Stage& stage) {
    for (const char* other : {"scalp", "brain"}) stage.state.opacity[std::size_t(stage.scene().find(other))] = 0;
  }
};

}  // namespace

// What comes from the thread is what is made here, in its order; together it keeps to the bytes.
TEST(RenderCoarseWorker, ItMakesWhatItIsAskedFor) {
  const scene::SceneSurface fine = surface_of(case_samples::ball(40, 80), "fine", {1, 1, 1}),
                            few = surface_of(case_samples::ball(40, 6), "few", {1, 1, 1});
  const double mm = 5;
  const auto whole = shared(fine);
  const std::optional<render::CoarseParts> here = render::coarse_parts(*whole, mm, any_bytes);
  ASSERT_TRUE(here);
  render::CoarseWorker worker;
  EXPECT_FALSE(worker.busy());
  EXPECT_FALSE(worker.take());
  const std::vector<render::CoarseAsk> asks{
      {4, whole, nullptr}, {1, shared(few), nullptr}, {3, whole, &fine}, {2, nullptr, &fine}};
  for (const std::size_t max_bytes : {any_bytes, here->facts.bytes, here->facts.bytes - 1}) {
    SCOPED_TRACE(max_bytes);
    worker.begin(mm, max_bytes, asks);
    EXPECT_TRUE(worker.busy());
    const std::vector<render::CoarseMade> made = all_of(worker);
    ASSERT_EQ(made.size(), 4u);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_EQ(made[n].surface, asks[n].surface);
    ASSERT_EQ(bool(made[0].beside), max_bytes >= here->facts.bytes);
    EXPECT_EQ(made[0].whole, whole);
    if (made[0].beside) {
      EXPECT_EQ(made[0].beside->indices, here->indices);
      EXPECT_EQ(made[0].facts.values(""), here->facts.values(""));
    }
    EXPECT_FALSE(made[1].beside || made[1].instead) << "there is no less of it";
    EXPECT_EQ(bool(made[2].beside), max_bytes == any_bytes) << "the first took the bytes";
    EXPECT_NE(bool(made[2].beside), bool(made[2].instead));
    ASSERT_TRUE(made[3].instead);
    EXPECT_EQ(made[3].instead->indices, render::parts_of(render::coarse_surface(fine, mm)).indices);
    EXPECT_EQ(made[3].facts.values(""), here->facts.values(""));
  }
}

// Another order is answered by its own results alone; an order that nobody waits for ends with its worker.
TEST(RenderCoarseWorker, AnOrderThatIsDroppedSaysNothingMore) {
  const scene::SceneSurface fine = surface_of(case_samples::ball(40, 300), "fine", {1, 1, 1});
  const auto whole = shared(fine);
  render::CoarseWorker worker;
  for (int n = 0; n < 20; ++n) {
    worker.begin(2, any_bytes, {{7, whole, nullptr}, {8, whole, nullptr}});
    if (n % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(n));
    worker.begin(2 + n, any_bytes, {{n, whole, nullptr}});
    const std::vector<render::CoarseMade> made = all_of(worker);
    ASSERT_EQ(made.size(), 1u);
    EXPECT_EQ(made[0].surface, n);
  }
  worker.begin(2, any_bytes, {{7, whole, nullptr}});
  worker.cancel();
  EXPECT_FALSE(worker.busy());
  EXPECT_FALSE(worker.take());
  worker.wait();
  worker.begin(2, any_bytes, std::vector<render::CoarseAsk>(10000, {7, whole, nullptr}));
  while (!worker.take()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

// Bone that is drilled while its coarser triangles are made is seen as bone that is drilled when they are there.
TEST_F(RenderCoarseMeanwhile, WhatIsDrilledMeanwhileIsNotOfAnOldState) {
  trephine::scene::Picture pictures[2];
  for (const bool meanwhile : {false, true}) {
    SCOPED_TRACE(meanwhile);
    loaded_ = cases::load_case(folder_ / "case");
    render::Stage stage(loaded_, view_);
    show_skull(stage);
    stage.set_quality(view_, 1, {coarse_mm, 10});
    EXPECT_TRUE(stage.coarse_comes());
    if (!meanwhile) stage.wait_for_coarse();
    const trephine::scene::Picture before = shot(stage, camera(stage));
    drill(stage);
    stage.wait_for_coarse();
    EXPECT_FALSE(stage.coarse_comes());
    pictures[meanwhile] = shot(stage, camera(stage));
    EXPECT_FALSE(pictures[meanwhile].rgb == before.rgb);
    EXPECT_GT(stage.renderer().coarse_bytes(), 0u);
  }
  EXPECT_TRUE(pictures[0].rgb == pictures[1].rgb);
}

// A surface whose buffers were too small is made anew. Its coarser triangles are then made of what it is now.
TEST_F(RenderCoarseMeanwhile, ASurfaceThatIsMadeAnewHasItsOwn) {
  for (const bool meanwhile : {false, true}) {
    SCOPED_TRACE(meanwhile);
    loaded_ = cases::load_case(folder_ / "case");
    render::Stage stage(loaded_, view_);
    show_skull(stage);
    stage.set_quality(view_, 1, {coarse_mm, 10});
    if (!meanwhile) stage.wait_for_coarse();
    const int skull = stage.scene().find("skull");
    const auto whole = stage.renderer().parts(skull);
    make_noise(stage);
    ASSERT_NE(stage.renderer().parts(skull), whole);
    stage.follow_coarse();
    EXPECT_TRUE(stage.coarse_comes());
    stage.wait_for_coarse();
    const scene::OrbitCamera same = camera(stage);
    const trephine::scene::Picture after = shot(stage, same);
    render::Stage anew(loaded_, view_);
    show_skull(anew);
    anew.set_quality(view_, 1, {coarse_mm, 10});
    const trephine::scene::Picture fine = shot(anew, same);
    anew.wait_for_coarse();
    EXPECT_TRUE(after.rgb == shot(anew, same).rgb);
    EXPECT_FALSE(after.rgb == fine.rgb);
  }
}

// Until they are there, and while another size is made, pictures are those of what there is; a window may end then.
TEST_F(RenderCoarseMeanwhile, PicturesGoOnMeanwhile) {
  render::Stage stage(loaded_, view_);
  show_skull(stage);
  const trephine::scene::Picture whole = shot(stage, camera(stage));
  stage.set_quality(view_, 1, {coarse_mm, 10});
  EXPECT_TRUE(shot(stage, camera(stage)).rgb == whole.rgb);
  EXPECT_TRUE(stage.notes().empty());
  stage.wait_for_coarse();
  const std::vector<texts::Note> notes = stage.notes();
  EXPECT_FALSE(notes.empty());
  const trephine::scene::Picture coarse = shot(stage, camera(stage));
  EXPECT_FALSE(coarse.rgb == whole.rgb);
  stage.set_quality(view_, 1, {2 * coarse_mm, 10});
  EXPECT_TRUE(shot(stage, camera(stage)).rgb == coarse.rgb);
  stage.set_quality(view_, 1, {coarse_mm, 10});
  stage.wait_for_coarse();
  EXPECT_TRUE(shot(stage, camera(stage)).rgb == coarse.rgb);
  EXPECT_EQ(stage.notes(), notes) << "nothing new is to be told";
  stage.set_quality(view_, 1, {2 * coarse_mm, 10});
  stage.set_quality(view_, 1);
  EXPECT_FALSE(stage.coarse_comes());
  EXPECT_EQ(stage.renderer().coarse_bytes(), 0u);
  EXPECT_TRUE(shot(stage, camera(stage)).rgb == whole.rgb);
  stage.set_quality(view_, 1, {coarse_mm, 10});
}

// An upload in slices of any size gives the same picture as one at once.
TEST_F(RenderCoarseMeanwhile, SlicesAreAsGoodAsOnePiece) {
  scene::SceneData scene;
  const surface::TriMesh ball = case_samples::ball(40, 60);
  scene.bounds = {{-40, -40, -40}, {40, 40, 40}};
  scene.surfaces = {surface_of(ball, "ball", {0.9, 0.8, 0.7}), surface_of(ball, "same", {0.9, 0.8, 0.7})};
  scene::SceneState state;
  state.opacity = {1, 1};
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  const scene::EyeView eye = camera.eye(width, height, scene.bounds);
  trephine::scene::Picture one;
  for (const std::size_t slice : {any_bytes, std::size_t{4096}, std::size_t{10}}) {
    render::Renderer renderer(scene, {1, false, 9, false, false, 0, {6, 0}});
    const trephine::scene::Picture whole = drawn(renderer, eye, state);
    std::size_t bytes = 0;
    for (int n = 0; n < 2; ++n) {
      std::optional<render::CoarseParts> made = render::coarse_parts(*renderer.parts(n), 6, any_bytes);
      ASSERT_TRUE(made);
      bytes += made->facts.bytes;
      renderer.set_coarse(n, std::move(made));
    }
    EXPECT_EQ(renderer.coarse_bytes(), bytes);
    std::size_t slices = 1;
    while (renderer.upload_coarse(slice)) ++slices;
    EXPECT_EQ(slices, (bytes + slice - 1) / slice) << "each is as long as it may be";
    const trephine::scene::Picture coarse = drawn(renderer, eye, state);
    EXPECT_FALSE(coarse.rgb == whole.rgb);
    if (slice == any_bytes) one = coarse;
    EXPECT_TRUE(coarse.rgb == one.rgb);
  }
}

}  // namespace trephine::drawing
