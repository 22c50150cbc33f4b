// SPDX-License-Identifier: GPL-3.0-or-later
// Horns in noise: a thin curved tube of CSF that goes on from a ventricle in a ball of tissue.
#include <gtest/gtest.h>

#include <cmath>

#include "head/horns.h"

namespace trephine::segmentation {
namespace {

struct Scene {
  grid::Grid<float> hu;
  mask::BitMask known, others, shape;
};

/// The tube's middle line: 30 mm forwards and down from the ventricle's end.
Vec3 course(double t) { return {30, 12 - 30 * t, -8 - 14 * t * t}; }

Scene scene(double tube_radius_mm) {
  grid::Lattice l;
  l.size = {110, 120, 90};
  l.origin_mm = {-54.5, -59.5, -44.5};
  Scene s{grid::Grid<float>(l), mask::BitMask(l), mask::BitMask(l), mask::BitMask(l)};
  unsigned state = 7;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        double off = 1e9;
        for (int n = 0; n <= 60 && tube_radius_mm > 0; ++n) off = std::min(off, norm(p - course(n / 60.0)));
        const bool ventricle = norm(p - Vec3{30, 20, -6}) < 8;
        if (ventricle) s.shape.set(i, j, k);
        s.known.set(i, j, k);
        double noise = 0;  // of unit variance
        for (int n = 0; n < 12; ++n) {
          state = state * 1664525u + 1013904223u;
          noise += (state >> 8) / double(1u << 24) - 0.5;
        }
        s.hu.at(i, j, k) = float((ventricle || off < tube_radius_mm ? 8 : 30) + 25 * noise);
      }
  return s;
}

TEST(Horns, ThinTubeInNoiseIsFollowedToItsEnd) {
  const Scene s = scene(1.9);
  int count = 0;
  const grid::Grid<float> d = head::find_horns(s.hu, s.known, s.known, s.others, s.shape, {0, 0, 0}, {}, 25, count);
  EXPECT_EQ(count, 1);
  const auto value = [&](Vec3 p) {
    const Vec3 q = d.to_index(p);
    return d.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z)));
  };
  int inside = 0;
  for (int n = 10; n <= 28; ++n) inside += value(course(n / 30.0)) > 0;
  EXPECT_GE(inside, 17);  // of 19
  // Nothing far from it, and about as thick as it is.
  std::size_t far = 0;
  for (int k = 0; k < d.size[2]; ++k)
    for (int j = 0; j < d.size[1]; ++j)
      for (int i = 0; i < d.size[0]; ++i) {
        if (!(d.at(i, j, k) > 0) || s.shape.get(i, j, k)) continue;
        const Vec3 p = d.to_world_mm({double(i), double(j), double(k)});
        double off = 1e9;
        for (int n = 0; n <= 60; ++n) off = std::min(off, norm(p - course(n / 60.0)));
        far += off > 4;
      }
  EXPECT_LE(far, 20u);
}

TEST(Horns, NoneIsFoundInNoiseAlone) {
  const Scene s = scene(0);
  int count = -1;
  const grid::Grid<float> d = head::find_horns(s.hu, s.known, s.known, s.others, s.shape, {0, 0, 0}, {}, 25, count);
  EXPECT_EQ(count, 0);
  for (const float v : d.voxels) ASSERT_LT(v, 0);
}

}  // namespace
}  // namespace trephine::segmentation
