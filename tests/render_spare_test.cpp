// SPDX-License-Identifier: GPL-3.0-or-later
// What is spared: triangles where pictures take too long, and graphics memory where there is little.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "render/coarse.h"
#include "render/memory.h"
#include "render/stage.h"
#include "render_scene.h"

namespace trephine::drawing {
namespace {

class RenderSpare : public Picture {
 protected:
  void SetUp() override {
    Picture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    folder_ = std::filesystem::temp_directory_path() / ("trephine-spare-" + std::to_string(::getpid()));
    case_samples::play_case().write(folder_ / "case");
    loaded_ = load_case(folder_ / "case");
    view_.samples = 1;
    view_.places = false;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  // 24 MB of CT.
  void add_ct() {
    static_cast<Lattice&>(loaded_.ct) = loaded_.haptic.voxels;
    loaded_.ct.size = {240, 240, 208};
    for (int a = 0; a < 3; ++a)
      loaded_.ct.spacing_mm[a] *= double(loaded_.haptic.voxels.size[std::size_t(a)]) / loaded_.ct.size[std::size_t(a)];
    loaded_.ct.voxels.assign(loaded_.ct.count(), 100);
  }
  std::filesystem::path folder_;
  LoadedCase loaded_;
  ViewParams view_;
};

trephine::Picture shot(Stage& stage, const OrbitCamera& camera, int w = width, int h = height) {
  OffscreenPicture out(w, h);
  stage.draw(camera, w, h, [&](Eye) { out.bind(); });
  return out.read();
}

}  // namespace

TEST(RenderCoarse, VerticesStayWithinTheBoundAndWhatIsClosedStaysClosed) {
  const TriMesh ball = case_samples::ball(40, 60);
  const SceneSurface whole = surface_of(ball, "ball", {1, 1, 1});
  for (const double within_mm : {1.0, 3.0, 8.0}) {
    SCOPED_TRACE(within_mm);
    const CoarseTriangles coarse = coarse_triangles(whole.vertices, whole.indices, within_mm);
    ASSERT_EQ(coarse.indices.size(), 3 * coarse.from.size());
    EXPECT_GT(coarse.from.size(), 20u);
    EXPECT_LT(coarse.from.size(), whole.indices.size() / 3);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    double volume = 0;
    for (std::size_t t = 0; t < coarse.from.size(); ++t) {
      Vec3 corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = [&](std::uint32_t v) {
          const float* p = whole.vertices[v].position_mm;
          return Vec3{p[0], p[1], p[2]};
        };
        const std::uint32_t v = coarse.indices[3 * t + k], next = coarse.indices[3 * t + (k + 1) % 3];
        corner[k] = at(v);
        ASSERT_LE(norm(corner[k] - at(whole.indices[3 * coarse.from[t] + k])), within_mm + 1e-4);
        ++edges[{v, next}];
        --edges[{next, v}];
      }
      volume += dot(corner[0], cross(corner[1], corner[2])) / 6;
    }
    for (const auto& [edge, count] : edges) ASSERT_EQ(count, 0) << "an open edge";
    EXPECT_NEAR(volume, 4.0 / 3 * M_PI * 40 * 40 * 40, 4 * M_PI * 40 * 40 * within_mm);
    const SceneSurface less = coarse_surface(whole, within_mm);
    EXPECT_EQ(less.indices.size(), coarse.indices.size());
    EXPECT_LT(less.vertices.size(), whole.vertices.size());
  }
}

TEST(RenderCoarse, AHalvedCtLiesWhereItLay) {
  Grid<std::int16_t> ct;
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
  const Grid<std::int16_t> half = halved(ct);
  EXPECT_EQ(half.size, (std::array<int, 3>{4, 3, 3}));
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const Vec3 p = half.to_world_mm({double(i), double(j), double(k)});
        EXPECT_NEAR(half.at(i, j, k), 8 * (p.x + 2 * p.y - p.z), 0.51) << i << " " << j << " " << k;
      }
}

// Far from the tool triangles are fewer, next to it every pixel is as it was, and nothing shows through a gap.
TEST_F(RenderSpare, NextToTheToolSurfacesStayWhole) {
  SceneData scene;
  const TriMesh ball = case_samples::ball(100, 150);
  scene.bounds = bounds_of(ball);
  scene.surfaces = {surface_of(ball, "ball", {0.9, 0.8, 0.7})};
  RenderQuality quality{1, false, 9, false, false, 0, {}};
  Renderer renderer(scene, quality);
  renderer.set_background({0, 0, 1});
  OrbitCamera camera;
  camera.look(ViewPreset::front, scene.bounds, {}, {});
  const EyeView eye = camera.eye(width, height, scene.bounds);
  SceneState state;
  state.opacity = {1};
  state.tip_mm = {0, -100, 0};
  state.tool_shown = true;
  const trephine::Picture whole = drawn(renderer, eye, state);
  const std::size_t all = renderer.drawn_triangles();
  quality.coarse = {6, 15};
  renderer.set_quality(quality);
  const trephine::Picture coarse = drawn(renderer, eye, state);
  EXPECT_LT(renderer.drawn_triangles(), all * 2 / 3);
  EXPECT_NE(coarse.rgb, whole.rgb);
  const Vec3 tip = eye.project(state.tip_mm, width, height);
  int near = 0, gaps = 0;
  const auto blue = [](const trephine::Picture& p, std::size_t n) { return p.rgb[n + 2] > 200 && p.rgb[n] < 60; };
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
  state.cut = CutPlane{{0, -50, 0}, {0, -1, 0}};
  const trephine::Picture cut = drawn(renderer, eye, state);
  quality.coarse = {};
  renderer.set_quality(quality);
  EXPECT_EQ(drawn(renderer, eye, state).rgb, cut.rgb);
  state.cut.reset();
  EXPECT_EQ(drawn(renderer, eye, state).rgb, whole.rgb);
}

// What is cut is whole, wherever the tool is: a hole looks as it does without coarse triangles.
TEST_F(RenderSpare, WhatIsCutIsNotCoarse) {
  Stage stage(loaded_, view_);
  for (const char* other : {"scalp", "brain"}) stage.state.opacity[std::size_t(stage.scene().find(other))] = 0;
  OrbitCamera camera;
  camera.look(ViewPreset::front, stage.scene().bounds, {}, {});
  stage.set_quality(view_, 1, {5, 10});
  const trephine::Picture before = shot(stage, camera);
  const std::size_t coarse = stage.renderer().drawn_triangles();
  stage.set_quality(view_, 1);
  shot(stage, camera);
  EXPECT_LT(coarse, stage.renderer().drawn_triangles() / 2);
  // A hole of 8 mm in the skull's front, while it is coarse.
  stage.set_quality(view_, 1, {5, 10});
  HapticVolume& v = loaded_.haptic;
  const Bounds& b = stage.scene().bounds;
  const Vec3 at{(b.min_mm.x + b.max_mm.x) / 2, (b.min_mm.y + b.max_mm.y) / 2 - 35, (b.min_mm.z + b.max_mm.z) / 2};
  DirtyBricks marks(v.voxels);
  std::size_t cleared = 0;
  const HapticShape& skull = *v.find_shape("skull");
  for (int k = 0; k < v.voxels.size[2]; ++k)
    for (int j = 0; j < v.voxels.size[1]; ++j)
      for (int i = 0; i < v.voxels.size[0]; ++i) {
        std::int16_t& value = v.voxels.at(i, j, k);
        const Vec3 p = v.voxels.to_world_mm({double(i), double(j), double(k)});
        if (norm(p - at) > 8 || value < skull.window_low || value > skull.window_high) continue;
        value = haptic_empty;
        marks.mark_voxel(i, j, k);
        ++cleared;
      }
  ASSERT_GT(cleared, 50u);
  EXPECT_GT(stage.follow(marks), 0u);
  const trephine::Picture hole = shot(stage, camera);
  Stage anew(loaded_, view_);
  anew.state.opacity = stage.state.opacity;
  const trephine::Picture whole = shot(anew, camera);
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

TEST_F(RenderSpare, TooLittleMemoryIsToldAndKeptTo) {
  add_ct();
  const auto notes = [&](double mb) {
    view_.samples = 4;
    view_.graphics_budget_mb = mb;
    Stage stage(loaded_, view_);
    shot(stage, camera_of(view_, loaded_.manifest, stage.scene()));
    EXPECT_LE(double(stage.renderer().graphics_bytes()), mb * 1e6);
    std::string all;
    for (const std::string& note : stage.notes()) all += note + "; ";
    return all;
  };
  // A screen's picture takes 83 MB with four samples, 17 with one; the CT 24, 3 in voxels of twice the side.
  EXPECT_EQ(notes(200), "");
  EXPECT_NE(notes(95).find("graphics memory: the CT in voxels of"), std::string::npos);
  EXPECT_NE(notes(60).find("graphics memory: rough edges"), std::string::npos);
  EXPECT_EQ(notes(60).find("the CT"), std::string::npos) << "with rough edges it fits";
  EXPECT_NE(notes(26).find("the CT in voxels"), std::string::npos);
  view_.graphics_budget_mb = 18;
  try {
    Stage stage(loaded_, view_);
    FAIL() << "it needs more than that";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::io);
    EXPECT_EQ(e.field(), "graphics_budget_mb");
  }
}

// Where a window has a buffer for each eye, each has what it has in a half of a picture side by side.
TEST_F(RenderSpare, ABufferForEachEyeHasItsHalf) {
  view_.stereo = ViewParams::Stereo::quad_buffer;
  Stage stage(loaded_, view_);
  const OrbitCamera camera = camera_of(view_, loaded_.manifest, stage.scene());
  OffscreenPicture left(width, height), right(width, height);
  std::vector<Eye> asked;
  stage.draw(camera, width, height, [&](Eye eye) {
    asked.push_back(eye);
    (eye == Eye::right ? right : left).bind();
  });
  EXPECT_EQ(asked, (std::vector<Eye>{Eye::left, Eye::right, Eye::both})) << "panels are drawn for both";
  view_.stereo = ViewParams::Stereo::side_by_side;
  stage.set_view(view_);
  const trephine::Picture both = shot(stage, camera, 2 * width, height), l = left.read(), r = right.read();
  EXPECT_NE(l.rgb, r.rgb);
  for (int y = 0; y < height; ++y) {
    const auto* row = both.rgb.data() + std::size_t(6 * y * width);
    ASSERT_TRUE(std::equal(row, row + 3 * width, l.rgb.data() + std::size_t(3 * y * width))) << y;
    ASSERT_TRUE(std::equal(row + 3 * width, row + 6 * width, r.rgb.data() + std::size_t(3 * y * width))) << y;
  }
}

}  // namespace trephine::drawing
