// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/pi.h"
#include "picture/render.h"
#include "render/stage.h"
#include "render_scene.h"

namespace trephine::drawing {
namespace {

constexpr picture::Rgb key{0, 0, 1};  // of the background: no surface here is blue

std::vector<std::uint8_t> covered(const std::uint8_t* rgb) {
  std::vector<std::uint8_t> mask(std::size_t(width) * height);
  for (std::size_t n = 0; n < mask.size(); ++n)
    mask[n] = !(rgb[3 * n] < 8 && rgb[3 * n + 1] < 8 && rgb[3 * n + 2] > 247);
  return mask;
}

// Pixels of `a` that have no pixel of `b` within one pixel of them.
int outside(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  int count = 0;
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      if (!a[std::size_t(y * width + x)]) continue;
      bool near = false;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) near = near || b[std::size_t((y + dy) * width + x + dx)];
      count += !near;
    }
  return count;
}

std::size_t sum(const std::vector<std::uint8_t>& mask) {
  std::size_t n = 0;
  for (const std::uint8_t m : mask) n += m;
  return n;
}

struct Compared {
  std::size_t ours = 0, theirs = 0;
  int out_of_one = 0;
};

Compared compare(const surface::TriMesh& mesh, const picture::RenderParams& params) {
  scene::SceneData scene;
  scene.bounds = surface::bounds_of(mesh);
  scene.surfaces = {surface_of(mesh, "bone", {0.9, 0.8, 0.7})};
  render::RenderQuality quality;
  quality.samples = 1;
  render::Renderer renderer(scene, quality);
  renderer.set_background({0, 0, 1});
  scene::SceneState state;
  state.opacity = {1};
  if (params.clip) state.cut = scene::CutPlane{params.clip->point_mm, params.clip->normal};
  const std::vector<picture::SurfaceView> views = {{&mesh, {0.9, 0.8, 0.7}, 1}};
  const picture::Image image = picture::render_surfaces(views, params);
  const trephine::scene::Picture picture = drawn(renderer, eye_of(picture::detail::camera_for(views, params)), state);
  const auto a = covered(picture.rgb.data()), b = covered(image.rgb.data());
  return {sum(a), sum(b), outside(a, b) + outside(b, a)};
}

picture::RenderParams plain(picture::View view) {
  picture::RenderParams p;
  p.view = view;
  p.width = width;
  p.height = height;
  p.supersampling = 1;
  p.marks = p.occlusion = false;
  p.background_top = p.background_bottom = key;
  return p;
}

using RenderPicture = Picture;

// The same silhouettes as the toolchain's rasteriser draws, from every side, whole and cut.
TEST_F(RenderPicture, SilhouettesAreThoseOfTheToolchainWithinAPixel) {
  const surface::TriMesh mesh = case_samples::ball(60, 60);
  for (const picture::View view : {picture::View::front, picture::View::left, picture::View::top,
                                   picture::View::oblique_left, picture::View::oblique_right}) {
    picture::RenderParams params = plain(view);
    Compared c = compare(mesh, params);
    EXPECT_GT(c.theirs, 10000u);
    EXPECT_EQ(c.out_of_one, 0);
    EXPECT_LT(std::abs(double(c.ours) - double(c.theirs)), 0.005 * double(c.theirs));
    params.clip = picture::ClipPlane{{5, -10, 3}, {0.3, -0.8, 0.5}};
    c = compare(mesh, params);
    EXPECT_EQ(c.out_of_one, 0) << "cut";
    EXPECT_LT(std::abs(double(c.ours) - double(c.theirs)), 0.005 * double(c.theirs));
  }
}

// A point before, at and behind the plane of convergence, seen by two eyes.
TEST_F(RenderPicture, StereoHasTheDisparityOfTheDepth) {
  for (const double depth : {350.0, 500.0, 700.0}) {
    scene::OrbitCamera camera;
    camera.distance_mm = 500;
    const surface::Bounds bounds{{-200, -200, -200}, {200, 200, 200}};
    scene::SceneData scene;
    scene.bounds = bounds;
    render::Renderer renderer(scene, {1, false, 9, false});
    scene::SceneState state;
    scene::Marker marker;
    marker.position_mm = camera.eye_mm() - camera.toward * depth;
    marker.radius_mm = 4;
    state.markers = {marker};
    double middle[2];
    for (const int side : {-1, 1}) {
      const scene::EyeView eye = camera.eye(width, height, bounds, 32.0 * side, 500);
      const trephine::scene::Picture p = drawn(renderer, eye, state);
      double weight = 0, x = 0;
      for (int n = 0; n < width * height; ++n) {
        const bool lit = p.rgb[std::size_t(3 * n)] > 60;
        weight += lit;
        x += lit * (n % width + 0.5);
      }
      ASSERT_GT(weight, 20);
      middle[side > 0] = x / weight;
      EXPECT_NEAR(middle[side > 0], eye.project(marker.position_mm, width, height).x, 0.5);
    }
    const double px_per_tan = 0.5 * height / std::tan(0.5 * 25 * pi / 180);
    EXPECT_NEAR(middle[1] - middle[0], 64 * px_per_tan * (1 / 500.0 - 1 / depth), 0.5) << depth;
  }
}

// A green ball within a red one of 60 mm.
scene::SceneData ball_in_ball(double inner_mm) {
  scene::SceneData scene;
  const surface::TriMesh outer = case_samples::ball(60, 40), inner = case_samples::ball(inner_mm, 30);
  scene.bounds = surface::bounds_of(outer);
  scene.surfaces = {surface_of(outer, "outer", {1, 0, 0}), surface_of(inner, "inner", {0, 1, 0})};
  return scene;
}

scene::EyeView from_the_front(const scene::SceneData& scene) {
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  return camera.eye(width, height, scene.bounds);
}

// A ball before a plate: its shadow lies where the key light's ray through the ball's middle meets the plate, at any
// height, so the way between the two tells the height.
TEST_F(RenderPicture, TheToolsShadowLiesWhereTheLightGoes) {
  scene::SceneData scene;
  scene.bounds = {{-100, -100, -1}, {100, 100, 30}};
  scene::SceneSurface plate;
  plate.name = "plate";
  plate.colour_rgb = {0.8, 0.8, 0.8};
  for (const auto& [x, y] : {std::pair{-100.f, -100.f}, {100.f, -100.f}, {100.f, 100.f}, {-100.f, 100.f}})
    plate.vertices.push_back({{x, y, 0}, {0, 0, 127, 0}});
  plate.indices = {0, 1, 2, 0, 2, 3};
  scene.surfaces = {plate};
  render::RenderQuality quality;
  quality.samples = 1;
  quality.occlusion = false;
  render::Renderer renderer(scene, quality);
  renderer.set_tool(scene::ball_solid(2, {1, 1, 1}));
  scene::EyeView eye;
  eye.eye_mm = {0, 0, 300};
  scene::SceneState state;
  state.opacity = {1};
  const auto picture = [&](bool shown, int taps) {
    state.tool_shown = shown;
    quality.shadow_taps = taps;
    renderer.set_quality(quality);
    return drawn(renderer, eye, state);
  };
  const Vec3 light = normalized(Vec3{-0.45, 0.62, 0.64});
  for (const double above_mm : {3.0, 8.0, 16.0}) {
    SCOPED_TRACE(above_mm);
    state.tip_mm = {5, -4, above_mm};
    const trephine::scene::Picture without = picture(true, 0), with = picture(true, 5);
    double x = 0, y = 0;
    int count = 0;
    for (int n = 0; n < width * height; ++n)
      if (without.rgb[std::size_t(3 * n)] - with.rgb[std::size_t(3 * n)] > 30) {
        x += n % width + 0.5;
        y += n / width + 0.5;
        ++count;
      }
    // The shadow is an ellipse of 2 by 2 / light.z mm; of a low ball's, the ball hides a part.
    ASSERT_GT(count, 25);
    const Vec3 wanted = eye.project(state.tip_mm - light * (above_mm / light.z), width, height);
    const double room_px = above_mm < 8 ? 3 : 0.7;
    EXPECT_NEAR(x / count, wanted.x, room_px);
    EXPECT_NEAR(y / count, wanted.y, room_px);
    EXPECT_EQ(picture(false, 5).rgb, picture(false, 0).rgb) << "a tool that is not shown casts none";
  }
}

// The bottom of a hole is darker than what is around it, and a plane as bright as it would be.
TEST_F(RenderPicture, AHoleIsDarkenedAndAPlaneIsNot) {
  scene::SceneData scene;
  scene.bounds = {{-60, -60, -8}, {60, 60, 1}};
  scene::SceneSurface s;
  s.name = "plate";
  s.colour_rgb = {0.6, 0.6, 0.6};
  const auto quad = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Vec3 n = normalized(cross(b - a, c - a)) * 127;
    const auto first = std::uint32_t(s.vertices.size());
    for (const Vec3 p : {a, b, c, d})
      s.vertices.push_back(
          {{float(p.x), float(p.y), float(p.z)},
           {std::int8_t(std::lround(n.x)), std::int8_t(std::lround(n.y)), std::int8_t(std::lround(n.z)), 0}});
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) s.indices.push_back(first + k);
  };
  // A plate with a hole of 14 x 14 mm, 8 mm deep.
  const double r = 7, w = 60, deep = -8;
  const auto flat = [&](double x0, double y0, double x1, double y1, double z) {
    quad({x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z});
  };
  flat(-w, -w, w, -r, 0);
  flat(-w, r, w, w, 0);
  flat(-w, -r, -r, r, 0);
  flat(r, -r, w, r, 0);
  flat(-r, -r, r, r, deep);
  quad({-r, -r, 0}, {-r, -r, deep}, {-r, r, deep}, {-r, r, 0});
  quad({r, r, 0}, {r, r, deep}, {r, -r, deep}, {r, -r, 0});
  quad({r, -r, 0}, {r, -r, deep}, {-r, -r, deep}, {-r, -r, 0});
  quad({-r, r, 0}, {-r, r, deep}, {r, r, deep}, {r, r, 0});
  scene.surfaces = {s};
  render::RenderQuality quality;
  quality.samples = 1;
  quality.ask_hidden = false;
  scene::EyeView eye;
  eye.eye_mm = {0, 0, 300};
  scene::SceneState state;
  state.opacity = {1};
  const auto brightness = [&](bool occlusion, Vec3 at) {
    quality.occlusion = occlusion;
    render::Renderer renderer(scene, quality);
    const trephine::scene::Picture p = drawn(renderer, eye, state);
    const Vec3 px = eye.project(at, width, height);
    return int(p.rgb[3 * (std::size_t(px.y) * width + std::size_t(px.x))]);
  };
  const Vec3 bottom{0, 0, deep}, foot{-5.5, 0, deep}, plane{30, 20, 0};
  EXPECT_LT(brightness(true, bottom), 0.9 * brightness(false, bottom));
  EXPECT_LT(brightness(true, foot), 0.8 * brightness(false, foot));
  EXPECT_GT(brightness(true, bottom), 0.4 * brightness(false, bottom)) << "it can still be seen";
  EXPECT_NEAR(brightness(true, plane), brightness(false, plane), 1);
}

// A shell within a shell: what is seen through both is mixed in the order of depth.
TEST_F(RenderPicture, TransparentShellsAreMixedFromTheOutermostInwards) {
  const scene::SceneData scene = ball_in_ball(30);
  render::Renderer renderer(scene, {1, false, 9, false});
  scene::SceneState state;
  const scene::EyeView eye = from_the_front(scene);
  const auto middle = [&](double outer_opacity, double inner_opacity) {
    state.opacity = {outer_opacity, inner_opacity};
    const trephine::scene::Picture p = drawn(renderer, eye, state);
    const std::size_t at = std::size_t((height / 2) * width + width / 2) * 3;
    return std::array<int, 3>{p.rgb[at], p.rgb[at + 1], p.rgb[at + 2]};
  };
  const auto solid = middle(1, 1), through = middle(0.4, 1), both = middle(0.4, 0.4), hidden = middle(0, 1);
  EXPECT_GT(solid[0], 150);
  EXPECT_LT(solid[1], 100);
  EXPECT_GT(through[1], 100);  // green shows through
  EXPECT_GT(through[0], 60);
  EXPECT_GT(hidden[1], through[1]);
  EXPECT_LT(hidden[0], 100);
  EXPECT_LT(both[1], through[1]);  // the inner shell lets the red far side through
}

// The cap of a cut has the colour of what it cuts, and that of the inner solid where that is.
TEST_F(RenderPicture, CapsShowTheInnerSolidWithinTheOuter) {
  const scene::SceneData scene = ball_in_ball(25);
  render::Renderer renderer(scene, {1, false, 9, false});
  scene::SceneState state;
  state.opacity = {1, 1};
  state.cut = scene::CutPlane{{0, 0, 0}, {0, -1, 0}};
  const scene::EyeView eye = from_the_front(scene);
  const trephine::scene::Picture p = drawn(renderer, eye, state);
  const auto at = [&](Vec3 place) {
    const Vec3 px = eye.project(place, width, height);
    const std::size_t n = std::size_t(int(px.y) * width + int(px.x)) * 3;
    return std::array<int, 3>{p.rgb[n], p.rgb[n + 1], p.rgb[n + 2]};
  };
  for (const Vec3 place : {Vec3{0, 0, 0}, Vec3{20, 0, 0}, Vec3{0, 0, -20}}) EXPECT_GT(at(place)[1], 150) << place.x;
  for (const Vec3 place : {Vec3{32, 0, 0}, Vec3{0, 0, 40}, Vec3{-50, 0, 0}}) {
    EXPECT_GT(at(place)[0], 150) << place.x;
    EXPECT_LT(at(place)[1], 60) << place.x;
  }
}

// A CT whose left, posterior and superior eighth differs from the rest: on a cut, on a slice in the scene and in an
// inset.
class RenderCt : public Picture {
 protected:
  static grid::Grid<std::int16_t> ct() {
    grid::Lattice l;
    l.size = {40, 36, 20};
    l.spacing_mm = {1.5, 1.5, 3};
    l.origin_mm = {-29.25, -26.25, -28.5};
    grid::Grid<std::int16_t> g(l, std::int16_t(0));
    for (int k = 0; k < 20; ++k)
      for (int j = 0; j < 36; ++j)
        for (int i = 0; i < 40; ++i)
          if (i >= 20 && j >= 18 && k >= 10) g.at(i, j, k) = 1000;
    return g;
  }
  scene::SceneData scene_ = [] {
    scene::SceneData s;
    const surface::TriMesh outer = case_samples::ball(24, 40);
    s.bounds = surface::bounds_of(outer);
    s.surfaces = {surface_of(outer, "outer", {0.9, 0.8, 0.7})};
    return s;
  }();
  scene::SceneState state_ = [] {
    scene::SceneState s;
    s.opacity = {1};
    s.ct_low_hu = -100;
    s.ct_high_hu = 900;
    return s;
  }();
  static int grey(const trephine::scene::Picture& p, Vec3 px) {
    return p.rgb[std::size_t(int(px.y) * width + int(px.x)) * 3 + 1];
  }
};

TEST_F(RenderCt, ACutShowsTheCtWhereItIs) {
  render::Renderer renderer(scene_, {1, false, 9, false});
  renderer.set_ct(ct());
  const scene::EyeView eye = from_the_front(scene_);
  const auto at = [&](const trephine::scene::Picture& p, Vec3 place) {
    return grey(p, eye.project(place, width, height));
  };
  state_.cut = scene::CutPlane{{0, 4, 0}, {0, -1, 0}};  // behind the middle: the bright eighth is in it
  const trephine::scene::Picture cut = drawn(renderer, eye, state_);
  EXPECT_GT(at(cut, {8, 4, 8}), at(cut, {-8, 4, 8}) + 60);
  EXPECT_GT(at(cut, {8, 4, 8}), at(cut, {8, 4, -8}) + 60);
  state_.cut_shows_ct = false;
  const trephine::scene::Picture plain = drawn(renderer, eye, state_);
  EXPECT_EQ(at(plain, {8, 4, 8}), at(plain, {-8, 4, 8}));
  state_.cut.reset();
  state_.opacity = {0};
  state_.ct_planes = {{1, {0, 4, 0}}};
  const trephine::scene::Picture slice = drawn(renderer, eye, state_);
  EXPECT_GT(at(slice, {8, 4, 8}), 200);
  EXPECT_LT(at(slice, {-8, 4, 8}), 120);
}

TEST_F(RenderCt, InsetsHaveThePatientsLeftOnTheRight) {
  render::Renderer renderer(scene_, {1, false, 9, false});
  renderer.set_ct(ct());
  render::OffscreenPicture out(width, height);
  const auto inset = [&](int axis) {
    renderer.draw(scene::OrbitCamera().eye(width, height, scene_.bounds), state_, width, height);
    out.bind();
    renderer.present(0, 0, width, height);
    renderer.draw_inset({axis, {6, 6, 6}}, state_, 100, 20, 120, 20);
    return out.read();
  };
  // 3 px a mm, the cross at (160, 160) from the upper left corner; the bright eighth begins 6 mm before the point.
  const auto at = [&](const trephine::scene::Picture& p, int right_mm, int up_mm) {
    return grey(p, {160.0 + 3 * right_mm + 1, 160.0 - 3 * up_mm + 1, 0});
  };
  const trephine::scene::Picture axial = inset(2), coronal = inset(1), sagittal = inset(0);
  EXPECT_GT(at(axial, 4, 0), 240);    // left
  EXPECT_LT(at(axial, -10, 0), 120);  // right
  EXPECT_GT(at(axial, 0, -4), 240);   // back is down
  EXPECT_LT(at(axial, 0, 10), 120);
  EXPECT_GT(at(coronal, 4, 4), 240);
  EXPECT_LT(at(coronal, -10, 4), 120);
  EXPECT_LT(at(coronal, 4, -10), 120);
  EXPECT_GT(at(sagittal, -4, 4), 240);  // seen from the left: back is on the left
  EXPECT_LT(at(sagittal, 10, 4), 120);
  EXPECT_LT(at(sagittal, -4, -10), 120);
}

// Where the head goes, what lies in the window's plane stays, and what lies behind it moves with the head.
TEST(RenderHead, TheWindowsPlaneStands) {
  scene::OrbitCamera camera;
  camera.target_mm = {3, -5, 7};
  camera.distance_mm = 400;
  const surface::Bounds bounds{{-100, -100, -100}, {100, 100, 100}};
  const scene::EyeView still = camera.eye(width, height, bounds);
  const scene::EyeView moved = render::Stage::beside(still, camera.distance_mm, {60, -40, 90});
  for (const Vec3 in_plane : {Vec3{0, 0, 0}, Vec3{30, 0, 20}, Vec3{-50, 0, 35}}) {
    const Vec3 a = still.project(camera.target_mm + in_plane, width, height),
               b = moved.project(camera.target_mm + in_plane, width, height);
    EXPECT_NEAR(a.x, b.x, 1e-6);
    EXPECT_NEAR(a.y, b.y, 1e-6);
  }
  const Vec3 behind = camera.target_mm - camera.toward * 50;
  EXPECT_GT(moved.project(behind, width, height).x, still.project(behind, width, height).x + 2);
}

}  // namespace
}  // namespace trephine::drawing
