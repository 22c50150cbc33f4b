// SPDX-License-Identifier: GPL-3.0-or-later
// What is left out where there is little graphics memory.
#include "render/memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/stage.h"
#include "render_scene.h"

namespace trephine::drawing {
namespace {

class RenderMemory : public PlayCase {
 protected:
  // 24 MB of CT.
  void add_ct() {
    static_cast<grid::Lattice&>(loaded_.ct) = loaded_.haptic.voxels;
    loaded_.ct.size = {240, 240, 208};
    for (int a = 0; a < 3; ++a)
      loaded_.ct.spacing_mm[a] *= double(loaded_.haptic.voxels.size[std::size_t(a)]) / loaded_.ct.size[std::size_t(a)];
    loaded_.ct.voxels.assign(loaded_.ct.count(), 100);
  }
  // The scalp with so many triangles that it is most of the case.
  void make_scalp_fine() {
    for (std::size_t n = 0; n < loaded_.surfaces.size(); ++n)
      if (loaded_.manifest.anatomies[n].name == "scalp") {
        const Vec3 middle =
            (surface::bounds_of(loaded_.surfaces[n]).min_mm + surface::bounds_of(loaded_.surfaces[n]).max_mm) / 2;
        loaded_.surfaces[n] = case_samples::ball(40, 150);
        loaded_.surfaces[n].origin_mm = middle;
      }
  }
  // All of the case with a screen's picture.
  std::size_t needed() {
    view_.graphics_budget_mb = 0;
    return render::Stage(loaded_, view_).renderer().scene_bytes() + render::picture_bytes(1920, 1080, 1);
  }
  static std::string all_notes(const render::Stage& stage) {
    std::string all;
    for (const texts::Note& note : stage.notes()) all += texts::text_of(note, texts::Language::english) + "; ";
    return all;
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  }
  // Pixels that are clearly other ones.
  static int other(const trephine::scene::Picture& a, const trephine::scene::Picture& b) {
    int n = 0;
    for (std::size_t p = 0; p < a.rgb.size(); p += 3)
      n += std::abs(a.rgb[p] - b.rgb[p]) + std::abs(a.rgb[p + 1] - b.rgb[p + 1]) +
               std::abs(a.rgb[p + 2] - b.rgb[p + 2]) >
           90;
    return n;
  }
};

}  // namespace

TEST(RenderHalved, AHalvedCtLiesWhereItLay) {
  grid::Grid<std::int16_t> ct;
  ct.size = {7, 6, 5};
  ct.spacing_mm = {0.5, 1, 2};
  ct.origin_mm = {-3, 8, 100};
  ct.voxels.resize(ct.count());
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 7; ++i) {
        const Vec3 p = ct.to_world_mm({double(i), double(j), double(k)});
        ct.at(i, j, k) = std::int16_t(std::lround(8 * (p.x + 2 * p.y - p.z)));
      }
  const grid::Grid<std::int16_t> half = render::halved(ct);
  EXPECT_EQ(half.size, (std::array<int, 3>{4, 3, 3}));
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = half.to_world_mm({double(i), double(j), double(k)});
        EXPECT_NEAR(half.at(i, j, k), 8 * (p.x + 2 * p.y - p.z), 0.51) << i << " " << j << " " << k;
      }
}

TEST_F(RenderMemory, TooLittleMemoryIsToldAndKeptTo) {
  add_ct();
  const auto notes = [&](double mb) {
    view_.samples = 4;
    view_.graphics_budget_mb = mb;
    render::Stage stage(loaded_, view_);
    shot(stage, scene::camera_of(view_, loaded_.manifest, stage.scene()));
    EXPECT_LE(double(stage.renderer().graphics_bytes()), mb * 1e6);
    std::string all;
    for (const texts::Note& note : stage.notes()) all += texts::text_of(note, texts::Language::english) + "; ";
    return all;
  };
  // A screen's picture takes 83 MB with four samples, 17 with one; the CT 24, 3 in voxels of twice the side.
  EXPECT_EQ(notes(200), "");
  EXPECT_EQ(notes(95), "graphics memory: rough edges; ");
  EXPECT_EQ(notes(60), "graphics memory: rough edges; ") << "with rough edges it fits";
  EXPECT_NE(notes(26).find("graphics memory: the CT in voxels of"), std::string::npos);
  view_.graphics_budget_mb = 18;
  try {
    render::Stage stage(loaded_, view_);
    FAIL() << "it needs more than that";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::io);
    EXPECT_EQ(e.field(), "graphics_budget_mb");
  }
}

// The live skull is counted though it cannot be coarser; the largest of the others is, by no more than it must.
TEST_F(RenderMemory, SurfacesBecomeAsCoarseAsTheyMust) {
  make_scalp_fine();
  const std::size_t all = needed();
  view_.graphics_budget_mb = 1e-6 * double(all);
  render::Stage whole(loaded_, view_);
  EXPECT_EQ(all_notes(whole), "");
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, whole.scene());
  const trephine::scene::Picture before = shot(whole, camera);
  const std::size_t scalp = render::bytes_of(whole.scene().surfaces[std::size_t(whole.scene().find("scalp"))]);
  ASSERT_GT(scalp, std::size_t{1} << 20);
  double was_mm = 0;
  for (const double share : {0.05, 0.3, 0.6}) {
    SCOPED_TRACE(share);
    view_.graphics_budget_mb = 1e-6 * (double(all) - share * double(scalp));
    render::Stage stage(loaded_, view_);
    const trephine::scene::Picture after = shot(stage, camera);
    EXPECT_LE(double(stage.renderer().scene_bytes() + render::picture_bytes(1920, 1080, 1)),
              view_.graphics_budget_mb * 1e6);
    const std::string notes = all_notes(stage);
    EXPECT_EQ(notes.find("graphics memory: scalp shown coarse: "), 0u) << notes;
    EXPECT_EQ(notes.find("skull"), std::string::npos) << notes;
    const std::size_t at = notes.find("the worst ");
    ASSERT_NE(at, std::string::npos);
    const double worst_mm = std::stod(notes.substr(at + 10));
    EXPECT_GE(worst_mm, was_mm);
    EXPECT_LE(worst_mm, 2.5);
    was_mm = worst_mm;
    EXPECT_LT(other(after, before), width * height / 50);
  }
  EXPECT_GT(was_mm, 0.02);
  // A size that is given is the only one.
  view_.graphics_budget_mb = 1e-6 * (double(all) - 0.05 * double(scalp));
  view_.coarse_mm = 4;
  render::Stage given(loaded_, view_);
  const scene::SceneSurface less =
      render::coarse_surface(whole.scene().surfaces[std::size_t(whole.scene().find("scalp"))], 4);
  EXPECT_EQ(whole.renderer().scene_bytes() - given.renderer().scene_bytes(), scalp - render::bytes_of(less));
  // The skull alone is too much.
  view_.graphics_budget_mb = 1e-6 * double(render::picture_bytes(1920, 1080, 1)) + 1;
  EXPECT_THROW(render::Stage(loaded_, view_), Error);
}

// Coarser triangles for the sake of time take memory as well: where there is none they stand in place of the whole
// ones.
TEST_F(RenderMemory, CoarserTrianglesKeepToTheBudget) {
  make_scalp_fine();
  const std::size_t all = needed();
  view_.graphics_budget_mb = 1e-6 * double(all + (std::size_t{8} << 20));
  render::Stage roomy(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, roomy.scene());
  const trephine::scene::Picture whole = shot(roomy, camera);
  roomy.set_quality(view_, 1, {1.5, 10});
  roomy.wait_for_coarse();
  EXPECT_GT(roomy.renderer().scene_bytes(), all - render::picture_bytes(1920, 1080, 1));
  EXPECT_EQ(all_notes(roomy).find("beyond 10 mm of the tool scalp is shown coarse: "), 0u) << all_notes(roomy);
  view_.graphics_budget_mb = 1e-6 * double(all);
  render::Stage tight(loaded_, view_);
  tight.set_quality(view_, 1, {1.5, 10});
  tight.wait_for_coarse();
  EXPECT_LE(double(tight.renderer().scene_bytes() + render::picture_bytes(1920, 1080, 1)),
            view_.graphics_budget_mb * 1e6);
  EXPECT_EQ(all_notes(tight).find("scalp is shown coarse: "), 0u) << all_notes(tight);
  EXPECT_NE(shot(tight, camera).rgb, whole.rgb);
  tight.set_quality(view_, 1, {0, 10});
  EXPECT_EQ(shot(tight, camera).rgb, whole.rgb) << "nothing needs to be coarse any more";
}

// The newest incision is open, however little there is: older ones go.
TEST_F(RenderMemory, TheNewestIncisionStaysOpen) {
  const std::size_t all = needed();
  const std::vector<session::IncisionMark> marks{
      {0, {1, -20, 340.5}, 10}, {1, {20, -5, 338}, 10}, {2, {-22, -2, 336}, 10}};
  view_.graphics_budget_mb = 0;
  render::Stage free(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, free.scene());
  const trephine::scene::Picture closed = shot(free, camera);
  free.show_incisions(marks, 1);
  const std::size_t wall = free.renderer().scene_bytes() + render::picture_bytes(1920, 1080, 1) - all;
  ASSERT_GT(wall, 1000u);
  free.show_incisions(marks, 3);
  EXPECT_EQ(free.renderer().incisions(), 3u);
  view_.graphics_budget_mb = 1e-6 * (double(all) + 1.5 * double(wall));
  render::Stage little(loaded_, view_);
  little.show_incisions(marks, 1);
  EXPECT_EQ(little.notes().size(), 0u);
  EXPECT_GT(other(shot(little, camera), closed), 100);
  little.show_incisions(marks, 3);
  EXPECT_EQ(little.renderer().incisions(), 1u);
  EXPECT_EQ(all_notes(little), "graphics memory: the oldest incisions look closed, and are not; ");
  render::Stage newest(loaded_, view_);
  newest.show_incisions({marks[2]}, 1);
  EXPECT_EQ(shot(little, camera).rgb, shot(newest, camera).rgb);
  view_.graphics_budget_mb = 1e-6 * double(all);
  render::Stage none(loaded_, view_);
  none.show_incisions(marks, 1);
  EXPECT_EQ(none.renderer().incisions(), 1u) << "open, and told";
  EXPECT_NE(all_notes(none).find("the newest incision takes 0.0"), std::string::npos) << all_notes(none);
}

// A window that is larger than the screen that was reckoned with has fewer pixels, and all incisions.
TEST_F(RenderMemory, ALargeWindowHasFewerPixels) {
  const std::size_t all = needed();
  view_.graphics_budget_mb = 1e-6 * double(all) + 0.5;
  render::Stage stage(loaded_, view_);
  const scene::OrbitCamera camera = scene::camera_of(view_, loaded_.manifest, stage.scene());
  const int w = 2560, h = 1600;
  const trephine::scene::Picture large = shot(stage, camera, w, h);
  EXPECT_EQ(large.width, w);
  EXPECT_LE(double(stage.renderer().graphics_bytes()), view_.graphics_budget_mb * 1e6);
  stage.show_incisions({{0, {1, -20, 340.5}, 10}, {1, {20, -5, 338}, 10}}, 2);
  EXPECT_EQ(stage.renderer().incisions(), 2u);
  shot(stage, camera, w, h);
  EXPECT_EQ(count(all_notes(stage), "graphics memory: pictures of"), 1u) << "told once";
  EXPECT_NE(all_notes(stage).find(" pixels in place of 2560 x 1600"), std::string::npos) << all_notes(stage);
  EXPECT_LE(double(stage.renderer().graphics_bytes()), view_.graphics_budget_mb * 1e6);
}

}  // namespace trephine::drawing
