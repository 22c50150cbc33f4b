// SPDX-License-Identifier: GPL-3.0-or-later
// Coarser triangles: what they are, by how much they are off, and that all of them are drawn.
#include "render/coarse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render_scene.h"
#include "surface/point_triangle.h"

namespace trephine::drawing {
namespace {

Vec3 at(const scene::SceneVertex& v) { return {v.position_mm[0], v.position_mm[1], v.position_mm[2]}; }

// Of every vertex from every triangle.
double worst_of_all(const scene::SceneSurface& whole, const scene::SceneSurface& coarse) {
  double worst = 0;
  for (const scene::SceneVertex& v : whole.vertices) {
    double nearest = 1e300;
    for (std::size_t t = 0; t < coarse.indices.size(); t += 3)
      nearest = std::min(nearest, surface::nearest_on_triangle(at(v), at(coarse.vertices[coarse.indices[t]]),
                                                               at(coarse.vertices[coarse.indices[t + 1]]),
                                                               at(coarse.vertices[coarse.indices[t + 2]]))
                                      .squared_mm2);
    worst = std::max(worst, nearest);
  }
  return std::sqrt(worst);
}

// A closed needle of three sides, from the origin up to that height.
void add_needle(scene::SceneSurface& s, Vec3 foot, double height) {
  const auto first = std::uint32_t(s.vertices.size());
  const Vec3 corners[] = {{0.1, 0, 0}, {-0.1, 0.1, 0}, {-0.1, -0.1, 0}};
  for (const double z : {0.0, height})
    for (const Vec3 c : corners)
      s.vertices.push_back({{float(foot.x + c.x), float(foot.y + c.y), float(foot.z + z)}, {0, 0, 127, 0}});
  for (const int n : {0, 2, 1, 3, 4, 5, 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 2, 0, 3, 2, 3, 5})
    s.indices.push_back(first + std::uint32_t(n));
}

}  // namespace

TEST(RenderCoarse, VerticesStayWithinTheBoundAndWhatIsClosedStaysClosed) {
  const surface::TriMesh ball = case_samples::ball(40, 60);
  const scene::SceneSurface whole = surface_of(ball, "ball", {1, 1, 1});
  for (const double within_mm : {1.0, 3.0, 8.0}) {
    SCOPED_TRACE(within_mm);
    const render::CoarseTriangles coarse = render::coarse_triangles(whole.vertices, whole.indices, within_mm);
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
    const scene::SceneSurface less = render::coarse_surface(whole, within_mm);
    EXPECT_EQ(less.indices.size(), coarse.indices.size());
    EXPECT_LT(less.vertices.size(), whole.vertices.size());
  }
}

TEST(RenderCoarse, TheWorstPlaceIsTheWorstOfAll) {
  const scene::SceneSurface whole = surface_of(case_samples::ball(20, 24), "ball", {1, 1, 1});
  for (const double mm : {2.0, 5.0}) {
    const scene::SceneSurface coarse = render::coarse_surface(whole, mm);
    const render::CoarseFacts facts = render::coarse_facts(whole, coarse);
    EXPECT_EQ(facts.whole, whole.indices.size() / 3);
    EXPECT_EQ(facts.left, coarse.indices.size() / 3);
    EXPECT_LT(facts.left, facts.whole);
    EXPECT_EQ(facts.places, whole.vertices.size());
    EXPECT_GT(facts.worst_mm, 0.01);
    EXPECT_LE(facts.worst_mm, mm);
    EXPECT_NEAR(facts.worst_mm, worst_of_all(whole, coarse), 1e-9);
    const render::CoarseTriangles beside = render::coarse_triangles(whole.vertices, whole.indices, mm);
    const render::CoarseFacts same = render::coarse_facts(whole.vertices, facts.whole, beside.indices);
    EXPECT_EQ(same.worst_mm, facts.worst_mm) << "the same triangles, beside the whole ones";
    EXPECT_EQ(same.bytes, beside.indices.size() * 4);
  }
}

// A needle of 0.2 mm vanishes in cells of 2.5 mm: its tip is 40 mm off then, far more than the size of a cell.
TEST(RenderCoarse, AThinPartThatVanishesIsMeasuredToo) {
  scene::SceneSurface whole = surface_of(case_samples::ball(20, 24), "ball", {1, 1, 1});
  add_needle(whole, {0.3, 0.3, 20}, 40);
  const scene::SceneSurface coarse = render::coarse_surface(whole, 2.5);
  const render::CoarseFacts facts = render::coarse_facts(whole, coarse);
  EXPECT_NEAR(facts.worst_mm, 40, 1);
  EXPECT_EQ(facts.values("ball"),
            (std::vector<std::string>{"ball", std::to_string(facts.left), std::to_string(facts.whole),
                                      std::to_string(facts.places), std::to_string(facts.worst_mm).substr(0, 5)}));
}

TEST(RenderCoarse, WhatWouldVanishStaysWhole) {
  scene::SceneSurface needle;
  add_needle(needle, {5, 5, 5}, 1);
  EXPECT_EQ(render::coarse_surface(needle, 20).indices, needle.indices);
}

class RenderCoarsePicture : public Picture {};

// Coarser triangles reach beyond the chunks of those that they stand for. Whatever is left out because it is outside of
// the picture or hidden, the picture is that of the coarser triangles alone, in which nothing is left out wrongly:
// there, each chunk has its own.
TEST_F(RenderCoarsePicture, NoneOfThemIsLeftOutWrongly) {
  const double within_mm = 12;
  const scene::SceneSurface ball = surface_of(case_samples::ball(40, 40), "ball", {0.9, 0.8, 0.7});
  scene::SceneSurface front;  // hides the left half of the ball
  front.name = "front";
  for (const Vec3 p : {Vec3{-60, -60, -60}, Vec3{4, -60, -60}, Vec3{4, -60, 60}, Vec3{-60, -60, 60}})
    front.vertices.push_back({{float(p.x), float(p.y), float(p.z)}, {0, -127, 0, 0}});
  front.indices = {0, 1, 2, 0, 2, 3};
  scene::SceneData scene;
  scene.bounds = {{-60, -60, -60}, {60, 60, 60}};
  scene.surfaces = {front, ball};
  render::RenderQuality quality{1, false, 9, false, true, 0, {within_mm, 0}};
  render::Renderer beside(scene, quality);
  ASSERT_TRUE(make_coarse(beside, 1, within_mm));
  scene.surfaces[1] = render::coarse_surface(ball, within_mm);
  render::Renderer alone(scene, {1, false, 9, false, false, 0, {}});
  scene::SceneState state;
  state.opacity = {1, 1};
  int seen = 0;
  for (int n = 0; n < 24; ++n) {
    scene::OrbitCamera camera;
    camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
    if (n > 0) {  // from near, beside the hidden half, so that chunks lie across the picture's edges
      camera.zoom(0.2);
      camera.target_mm = {4.0 + 1.5 * n, 0, 25.0 - 2 * n};
      camera.distance_mm += 60;
    }
    const scene::EyeView eye = camera.eye(width, height, scene.bounds);
    const trephine::scene::Picture a = drawn(beside, eye, state), b = drawn(alone, eye, state);
    int other = 0;
    for (std::size_t p = 0; p < a.rgb.size(); p += 3) {
      other += !std::equal(&a.rgb[p], &a.rgb[p] + 3, &b.rgb[p]);
      seen += a.rgb[p] > 60;
    }
    EXPECT_EQ(other, 0) << n;
  }
  EXPECT_GT(seen, 8 * width * height);
}

// Where large triangles stay as many, they are not drawn coarser: that would be off and no quicker.
TEST_F(RenderCoarsePicture, WhatIsCoarseAlreadyStaysAsItIs) {
  scene::SceneData scene;
  scene.bounds = {{-40, -40, -40}, {40, 40, 40}};
  scene.surfaces = {surface_of(case_samples::ball(40, 80), "fine", {1, 1, 1}),
                    surface_of(case_samples::ball(30, 20), "coarse", {1, 1, 1})};
  render::Renderer renderer(scene, {1, false, 9, false, false, 0, {}});
  EXPECT_TRUE(make_coarse(renderer, 0, 5));
  EXPECT_FALSE(make_coarse(renderer, 1, 5));
}

// Where a smooth surface turns away from the viewer its normals lean over the edge first, on triangles that are still
// seen from outside: they must not have the darker and redder colour of an inner side, which made specks there.
TEST_F(RenderCoarsePicture, AnEdgeHasNoSpecksOfTheInnerSide) {
  scene::SceneData scene;
  scene.bounds = {{-40, -40, -40}, {40, 40, 40}};
  scene.surfaces = {surface_of(case_samples::ball(40, 12), "ball", {0.8, 0.8, 0.8})};
  render::Renderer renderer(scene, {1, false, 9, false, false, 0, {}});
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  const scene::EyeView eye = camera.eye(width, height, scene.bounds);
  scene::SceneState state;
  state.opacity = {1};
  const trephine::scene::Picture p = drawn(renderer, eye, state);
  int seen = 0, reddish = 0;
  for (std::size_t k = 0; k < p.rgb.size(); k += 3) {
    seen += p.rgb[k] > 60;
    reddish += p.rgb[k] > p.rgb[k + 2] + 6;
  }
  EXPECT_GT(seen, 1000);
  EXPECT_EQ(reddish, 0);
}

}  // namespace trephine::drawing
