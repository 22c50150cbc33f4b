// SPDX-License-Identifier: GPL-3.0-or-later
// What is said to be clear of everything, against walks.
#include <gtest/gtest.h>

#include "haptics/tool.h"
#include "touch/clear_points.h"
#include "touch_meshes.h"

namespace trephine::touched {
namespace {

using haptic_scenes::empty;
using haptic_scenes::fill;
using walls::uniform;
using walls::unit_vector;

// Two shapes with air within, which reach the lattice's end on two sides.
voxel::HapticVolume hollow(bool hu) {
  voxel::HapticVolume v = empty(61, {0.5, 0.4, 0.7});
  if (!hu) {
    fill(v, 1, [](Vec3 p) { return std::min(-p.z, norm(p) - 4); });
    fill(v, 2, [](Vec3 p) { return std::min({p.z, 6 - p.x, norm(p) - 7}); });
    return v;
  }
  v.encoding = voxel::HapticEncoding::hu;
  v.shapes = {{"bone", 1, 300, 3000}};
  for (int k = 0; k < 61; ++k)
    for (int j = 0; j < 61; ++j)
      for (int i = 0; i < 61; ++i) {
        const Vec3 p = v.voxels.to_world_mm({double(i), double(j), double(k)});
        v.voxels.at(i, j, k) = std::int16_t(p.z < 0 && norm(p) > 4 ? 900 : -1000);
      }
  return v;
}

// A box is cut out of it, as a drill does.
void cut(voxel::HapticVolume& v, contact::ContactVolume& contact, std::mt19937_64& rng, Vec3 about) {
  grid::Box box;
  const Vec3 middle = v.voxels.to_index(about);
  for (int a = 0; a < 3; ++a) {
    box.begin[std::size_t(a)] = int(std::clamp(middle[a] + uniform(rng, -8, 4), 0.0, 55.0));
    box.end[std::size_t(a)] = box.begin[std::size_t(a)] + int(uniform(rng, 1, 6));
  }
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        v.voxels.at(i, j, k) = v.encoding == voxel::HapticEncoding::hu ? std::int16_t(-1024) : voxel::haptic_empty;
  contact.loosen(box);
  contact.settle(grid::grown(box, 2, v.voxels));
}

TEST(TouchClear, NothingChangesWithinWhatIsSaidToBeClear) {
  using Surface = contact::ContactParams::Surface;
  for (const bool hu : {false, true})
    for (const Surface surface : {Surface::subvoxel, Surface::nearest}) {
      voxel::HapticVolume v = hollow(hu);
      contact::ContactVolume contact(v, {contact::ContactParams::Walk::exact, surface, 1});
      std::mt19937_64 rng(3);
      double most[2] = {0, 0};
      int said = 0, beside = 0;
      for (int n = 0; n < 4000; ++n) {
        const Vec3 at{uniform(rng, -22, 22), uniform(rng, -20, 20), uniform(rng, -28, 28)};
        if (n > 1000 && n % 100 == 0) cut(v, contact, rng, at);
        const int shape = contact.shape_at(at);
        std::vector<double> clear(1);
        contact.clear_mm(at, {}, {Vec3{}}, {std::uint8_t(shape)}, clear);
        const double close = contact.clear_beside_mm(at, shape);
        most[shape != 0] = std::max(most[shape != 0], clear[0]);
        said += clear[0] > 0;
        beside += close > clear[0];
        for (int way = 0; way < 6; ++way) {
          const Vec3 to = at + unit_vector(rng) * std::max(clear[0], close);
          const contact::Contact c = contact.cross(at, to, shape);
          ASSERT_FALSE(c.hit || c.passed) << n << ": " << clear[0] << ", " << close;
          ASSERT_EQ(c.into, shape);
        }
        // Of another shape than is there nothing is said.
        contact.clear_mm(at, {}, {Vec3{}}, {std::uint8_t(shape == 1 ? 2 : 1)}, clear);
        ASSERT_EQ(clear[0], 0);
      }
      EXPECT_GT(said, 2000);
      EXPECT_GT(most[0], 3);
      EXPECT_GT(most[1], 2);
      EXPECT_EQ(beside > 200, surface == Surface::subvoxel) << beside;
    }
}

// A tool that is moved and turned at random, a little or far, also where something was cut.
TEST(TouchClear, PointsThatAreClearOnTheirWaysMeetNothing) {
  voxel::HapticVolume v = hollow(false);
  contact::ContactVolume contact(v);
  const touch::MeshSurfaces meshes({{round_mesh(24, [](Vec3 unit) { return 0.2 * organ_mm(unit); }), mesh}}, 1e-4);
  const touch::FeltSpace space(contact, {&meshes});
  haptics::ToolParams params;
  params.tool = "burr";
  const std::vector<Vec3> points = haptics::make_tool(params).points_mm;
  std::vector<std::uint8_t> shapes(points.size());
  touch::ClearPoints clear(space, points, shapes);
  touch::LongestWay longest(points);
  std::mt19937_64 rng(5);
  const contact::TouchableFaces faces;
  Vec3 tip{0, 0, 9}, axis{0, 0, 1};
  const auto place = [&](Vec3 at, const Mat3& frame) {
    for (std::size_t n = 0; n < points.size(); ++n) shapes[n] = std::uint8_t(contact.shape_at(at + frame * points[n]));
    clear.forget();
  };
  place(tip, haptics::frame_along(axis));
  int said = 0, walked = 0, all = 0;
  for (int n = 0; n < 3000; ++n) {
    clear.begin_frame();
    if (n % 50 == 0) {
      tip = {uniform(rng, -9, 9), uniform(rng, -9, 9), uniform(rng, -9, 40)};
      place(tip, haptics::frame_along(axis));
    }
    const double far = n % 5 == 0 ? 2 : n % 2 == 0 ? 0.1 : 0.01;
    const Vec3 to = tip + unit_vector(rng) * far, to_axis = normalized(axis + unit_vector(rng) * (0.1 * far));
    const Mat3 begin = haptics::frame_along(axis), end = haptics::frame_along(n % 3 == 0 ? axis : to_axis);
    const touch::ClearPoints::Way way = clear.way(tip, begin, to, end);
    all += clear.all_are(way.until(1));
    double most = 0;
    bool free = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 from = tip + begin * points[i], whole = to + end * points[i];
      most = std::max(most, dot(whole - from, whole - from));
      const double share = uniform(rng, 0, 1);
      const contact::Contact c = space.cross(from, whole, shapes[i], faces);
      free = free && !c.hit && !c.passed;
      const bool is = clear.is(i, way.until(1)) || clear.is(i, from, whole);
      said += is;
      walked += !is;
      if (is || clear.all_are(way.until(1))) {
        ASSERT_FALSE(c.hit || c.passed) << n << ", point " << i;
        ASSERT_EQ(c.into, shapes[i]);
      }
      if (clear.is(i, way.until(share))) {
        ASSERT_FALSE(space.cross(from, from + (whole - from) * share, shapes[i], faces).hit) << n << ", point " << i;
      }
    }
    ASSERT_EQ(longest.of(tip, begin, to, end), std::sqrt(most)) << n << ": to the last bit";
    if (n % 10 == 9) cut(v, contact, rng, tip);
    if (!free) continue;
    tip = to;
    if (n % 3 != 0) axis = to_axis;
  }
  std::printf("  %d ways were clear, %d walked; in %d of 3000 frames none\n", said, walked, all);
  EXPECT_GT(said, walked);
  EXPECT_GT(all, 100);
}

}  // namespace
}  // namespace trephine::touched
