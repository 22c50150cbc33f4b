// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that the graphics card makes is the one that the processor makes, triangle for triangle.
#include <gtest/gtest.h>

#include <cmath>

#include "drill_scene.h"
#include "render/surface_maker.h"
#include "render_scene.h"

namespace trephine::drawing {
namespace {

using namespace trephine::drilling;

struct Difference {
  std::size_t bricks = 0;  // with another number of triangles
  std::size_t triangles = 0;
  double most_mm = 0;    // between corners of the same triangle
  int max_normal = 0;    // in steps of 1/127
  int unequal_bits = 0;  // corners whose positions are not the same to the bit
};

Difference compare(const render::SurfaceMaker& a, const render::SurfaceMaker& b) {
  Difference d;
  for (std::size_t n = 0; n < a.shadow().layout().count(); ++n) {
    const render::DrawnBrick x = a.read(n), y = b.read(n);
    if (x.indices.size() != y.indices.size()) {
      ++d.bricks;
      continue;
    }
    d.triangles += x.indices.size() / 3;
    for (std::size_t i = 0; i < x.indices.size(); ++i) {
      const scene::SceneVertex &p = x.vertices[x.indices[i]], &q = y.vertices[y.indices[i]];
      double far = 0;
      for (int c = 0; c < 3; ++c) {
        far = std::max(far, std::abs(double(p.position_mm[c]) - double(q.position_mm[c])));
        d.max_normal = std::max(d.max_normal, std::abs(int(p.normal[c]) - int(q.normal[c])));
      }
      d.unequal_bits += far > 0;
      d.most_mm = std::max(d.most_mm, far);
    }
  }
  return d;
}

void expect_same(const render::SurfaceMaker& a, const render::SurfaceMaker& b, const char* when) {
  const Difference d = compare(a, b);
  EXPECT_EQ(d.bricks, 0u) << when;
  EXPECT_LT(d.most_mm, 1e-5) << when;  // of some 30 mm in floats
  EXPECT_LE(d.max_normal, 1) << when;
}

class RenderCompute : public Picture {};

// Every set of corners, at borders and within, in voxels that are no cubes, in both handednesses.
TEST_F(RenderCompute, RandomVoxelsGiveTheSameTriangles) {
  std::mt19937_64 rng(7);
  for (int n = 0; n < 8; ++n) {
    voxel::HapticVolume v;
    grid::Lattice l = lattice(9 + 5 * n, 0.7);
    l.size = {9 + 5 * n, 30 - 3 * n, 17};
    l.spacing_mm = {0.7, 1.1, 0.4};
    if (n % 2 == 1) l.direction.column[0] = l.direction.column[0] * -1;
    v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
    v.shapes = {voxel::occupancy_shape("bone", 1), voxel::occupancy_shape("brain", 2)};
    for (std::int16_t& raw : v.voxels.voxels)
      if (rng() % 100 < std::uint64_t(15 + 10 * n))
        raw = voxel::detail::join(1 + int(rng() % 5 == 0), 1 + int(rng() % 255), rng() % 3 > 0);
    const auto a = render::processor_maker(v, 1, {1, 2, 3}), b = render::compute_maker(v, 1, {1, 2, 3});
    expect_same(*a, *b, "random");
    EXPECT_GT(compare(*a, *b).triangles, 1000u);
    EXPECT_EQ(a->placed().mirrored, n % 2 == 1);
    // One voxel more is seen: the comparison can fail.
    voxel::HapticVolume other = v;
    const bool solid = voxel::detail::share_of(v.voxels, 1, 4, 4, 8) > 127;
    other.voxels.at(4, 4, 8) = solid ? voxel::haptic_empty : std::int16_t(1255);
    const Difference d = compare(*render::processor_maker(other, 1, {1, 2, 3}), *b);
    EXPECT_TRUE(d.bricks > 0 || d.most_mm > 0.01);
  }
}

// While a shape is drilled, with room for much and with so little that the surface is made anew again and again.
TEST_F(RenderCompute, FollowsADrillAsTheProcessorDoes) {
  for (const render::ComputeRoom room : {render::ComputeRoom{}, render::ComputeRoom{12, 3}}) {
    voxel::HapticVolume v = layers(52, 0.5);
    drill::DirtyBricks marks(v.voxels);
    drill::Drill drill(v, of_layers(), ball(1.6), {}, &marks);
    const auto a = render::processor_maker(v, 2, {}), b = render::compute_maker(v, 2, {}, room);
    std::mt19937_64 rng(5);
    std::vector<std::size_t> marked;
    std::size_t made = 0;
    Vec3 at = v.voxels.to_world_mm({26, 26, 33}), to = at;
    for (int tick = 0; tick < 1500; ++tick) {
      if (tick % 150 == 0)
        to = v.voxels.to_world_mm({uniform(rng, -1, 53), uniform(rng, -1, 53), uniform(rng, 17, 35)});
      at += (to - at) * 0.02;
      cut(drill, centred(at, 1.6), 0.001);
      if (tick % 17 != 0 && tick != 1499) continue;
      marked.clear();
      marks.take(marked);
      const std::size_t here = a->update(marked);
      EXPECT_EQ(b->update(marked), here);
      made += here;
      if (tick % 340 == 0) expect_same(*a, *b, "on the way");
    }
    expect_same(*a, *b, "at the end");
    EXPECT_GT(made, 200u);
    expect_same(*render::compute_maker(v, 2, {}), *b, "made anew");
  }
}

// A brick that was wholly solid gets a surface, and one that loses its surface draws nothing.
TEST_F(RenderCompute, BricksComeAndGo) {
  voxel::HapticVolume v = full(40, 0.5);
  drill::DirtyBricks marks(v.voxels);
  drill::Drill drill(v, only(1, 0.1), ball(3), {}, &marks);
  const auto a = render::processor_maker(v, 1, {}), b = render::compute_maker(v, 1, {});
  const drill::BrickLayout& layout = a->shadow().layout();
  const std::size_t inner = layout.index(2, 2, 2);
  EXPECT_TRUE(b->read(inner).indices.empty());
  bool had = false;
  for (int n = 0; n < 4000; ++n) {
    const double turn = 0.02 * n;
    cut(drill, centred(v.voxels.to_world_mm({19.5 + 4 * std::cos(turn), 19.5 + 4 * std::sin(turn), 19.5}), 3), 0.002);
    if (n % 100 != 0) continue;
    std::vector<std::size_t> marked;
    marks.take(marked);
    a->update(marked);
    b->update(marked);
    had = had || !b->read(inner).indices.empty();
  }
  EXPECT_TRUE(had);
  expect_same(*a, *b, "hollow");
}

// The measurement gives a maker that works, and the processor wherever it draws as well.
TEST_F(RenderCompute, TheFasterMakerIsTaken) {
  const voxel::HapticVolume v = layers(30, 0.5);
  render::MakerChoice choice;
  const auto here = render::wanted_maker(scene::ViewParams::SurfaceBy::measured, true, v, 2, {}, choice);
  EXPECT_FALSE(choice.graphics);
  EXPECT_EQ(choice.text(), "the processor");
  const auto measured = render::wanted_maker(scene::ViewParams::SurfaceBy::measured, false, v, 2, {}, choice);
  EXPECT_GT(choice.processor_ms, 0);
  EXPECT_GT(choice.graphics_ms, 0);
  EXPECT_EQ(choice.graphics, choice.graphics_ms < choice.processor_ms);
  expect_same(*here, *measured, "measured");
  const auto wanted = render::wanted_maker(scene::ViewParams::SurfaceBy::graphics, true, v, 2, {}, choice);
  EXPECT_TRUE(choice.graphics);
  expect_same(*here, *wanted, "wanted");
}

}  // namespace
}  // namespace trephine::drawing
