// SPDX-License-Identifier: GPL-3.0-or-later
// What is displayed while a shape is drilled is what is felt ("What must be shown", 7).
#include <gtest/gtest.h>

#include "contact/contact.h"
#include "drill/live_surface.h"
#include "drill_scene.h"

using namespace trephine;
using namespace trephine::drilling;

TEST(ContactLiveSurface, TheDisplayedSurfaceIsTheFeltOne) {
  voxel::HapticVolume v = layers(60, 0.5);
  contact::ContactVolume contact(v);
  drill::DirtyBricks marks(v.voxels);
  drill::Drill drill(v, of_layers(), ball(1.6), {}, &marks);
  drill::LiveSurface bone(v, 2);
  std::mt19937_64 rng(5);
  std::vector<std::size_t> marked;
  Vec3 at = v.voxels.to_world_mm({30, 30, 38}), to = at;
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick % 150 == 0) to = v.voxels.to_world_mm({uniform(rng, 5, 55), uniform(rng, 5, 55), uniform(rng, 20, 40)});
    at += (to - at) * 0.02;
    const drill::Removal& r = cut(drill, centred(at, 1.6), 0.001);
    if (!r.changed.empty()) contact.loosen(r.changed);
  }
  marks.take(marked);
  bone.update(marked);
  // From each middle of a triangle, to either side: the nearest place where one enters or leaves bone.
  const contact::TouchableFaces faces{1u << 2, 1u << 2};
  std::vector<double> off, near_two;  // near_two: a voxel of another shape is within two voxels
  int missed = 0;
  for (std::size_t n = 0; n < bone.layout().count(); ++n) {
    const drill::BrickMesh& b = bone.brick(n);
    for (std::size_t t = 0; t + 2 < b.indices.size(); t += 3) {
      Vec3 p, normal;
      for (std::size_t c = 0; c < 3; ++c) {
        const drill::LiveVertex& vertex = b.vertices[b.indices[t + c]];
        p += Vec3{vertex.position_mm[0], vertex.position_mm[1], vertex.position_mm[2]} / 3;
        normal += Vec3{vertex.normal[0], vertex.normal[1], vertex.normal[2]};
      }
      const Vec3 i{p.x / 0.5, p.y / 0.5, p.z / 0.5};
      if (std::min({i.x, i.y, i.z}) < 1 || std::max({i.x, i.y, i.z}) > 58) continue;  // the cap, which nobody feels
      const Vec3 world = v.voxels.origin_mm + v.voxels.direction * p;
      const Vec3 out = v.voxels.direction * normalized(normal) * 0.5;
      double nearest = 2;
      for (const Vec3 way : {out, -out}) {
        const contact::Contact c = contact.intersect(world, world + way, faces);
        if (c.hit) nearest = std::min(nearest, c.along);
      }
      if (nearest > 1) {
        ++missed;
        continue;
      }
      bool two = false;
      for (int n3 = 0; n3 < 125; ++n3) {
        const int x = int(std::lround(i.x)) + n3 % 5 - 2, y = int(std::lround(i.y)) + n3 / 5 % 5 - 2,
                  z = int(std::lround(i.z)) + n3 / 25 - 2;
        if (!v.voxels.contains(x, y, z)) continue;
        const int number = voxel::detail::split(v.voxels.at(x, y, z)).number;
        two = two || (number != 0 && number != 2);
      }
      (two ? near_two : off).push_back(nearest);  // in voxels
    }
  }
  ASSERT_GT(off.size(), 5000u);
  ASSERT_GT(near_two.size(), 5000u);
  for (std::vector<double>* all : {&off, &near_two}) {
    std::sort(all->begin(), all->end());
    const auto p = [&](double share) { return (*all)[std::size_t(share * double(all->size()))]; };
    std::printf("  %s: %zu triangles, p50 %.3f, p90 %.3f, p98 %.3f, p99 %.3f voxels\n",
                all == &off ? "bone alone" : "beside skin or brain", all->size(), p(0.5), p(0.9), p(0.98), p(0.99));
    // Where a cut meets the border of two shapes, a point belongs to the larger share, and the triangles to half of
    // one; the ramp of a cut is a voxel wide on either side of it.
    EXPECT_LT(p(0.9), all == &off ? 0.06 : 0.12);
    if (all == &off) {
      EXPECT_LT(p(0.97), 0.1);
    }
    EXPECT_LT(p(0.98), all == &off ? 0.12 : 0.45);
  }
  EXPECT_LT(missed, int(off.size()) / 50);
}
