// SPDX-License-Identifier: GPL-3.0-or-later
// How far what is felt of a drilled hole is from what is seen of it, in parts of a voxel.
#include <gtest/gtest.h>

#include <algorithm>

#include "drill/live_surface.h"
#include "haptics/round_body.h"
#include "haptics_feed.h"
#include "surface/point_triangle.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

struct Triangle {
  Vec3 a, b, c;
  Vec3 middle() const { return (a + b + c) / 3; }
  Vec3 normal() const { return normalized(cross(b - a, c - a)); }
};

// What is shown of the hole: its rim, walls and floor.
std::vector<Triangle> shown(const Drilled& d, double radius_mm) {
  const drill::LiveSurface bone(d.volume, 1);
  const grid::Lattice& l = d.volume.voxels;
  std::vector<Triangle> out;
  for (std::size_t n = 0; n < bone.layout().count(); ++n) {
    const drill::BrickMesh& b = bone.brick(n);
    for (std::size_t t = 0; t + 2 < b.indices.size(); t += 3) {
      Vec3 p[3];
      for (std::size_t c = 0; c < 3; ++c) {
        const float* at = b.vertices[b.indices[t + c]].position_mm;
        p[c] = l.origin_mm + l.direction * Vec3{at[0], at[1], at[2]};
      }
      const Triangle is{p[0], p[1], p[2]};
      const Vec3 off = is.middle() - d.entry_mm;
      if (norm(off - d.axis * dot(off, d.axis)) < radius_mm + 2 * l.spacing_mm.x && dot(off, d.axis) < radius_mm)
        out.push_back(is);
    }
  }
  return out;
}

struct Off {
  std::vector<double> voxels;
  double at(double share) {
    std::sort(voxels.begin(), voxels.end());
    return voxels.empty() ? 99 : voxels[std::min(voxels.size() - 1, std::size_t(share * double(voxels.size())))];
  }
};

// From the middle of each triangle, to either side: the nearest place where a point enters or leaves bone.
Off off_of_a_point(const contact::ContactVolume& contact, const std::vector<Triangle>& all, double voxel_mm) {
  Off out;
  for (const Triangle& t : all) {
    double nearest = 2;
    for (const Vec3 way : {t.normal() * voxel_mm, t.normal() * -voxel_mm})
      if (const contact::Contact c = contact.intersect(t.middle(), t.middle() + way, {2, 2}); c.hit)
        nearest = std::min(nearest, c.along);
    out.voxels.push_back(nearest);
  }
  return out;
}

// A ball 0.8 as wide as the burr is led from the hole's axis towards each side until it touches; then its shown surface
// should touch the shown hole. Above 0: a gap is seen; below: it is seen within the wall.
Off off_of_the_ball(const contact::ContactVolume& contact, const std::vector<Triangle>& all, const Drilled& d,
                    double burr_mm, double depth_mm, double voxel_mm) {
  const double radius_mm = 0.8 * burr_mm;
  haptics::RoundBody body(contact, {{radius_mm, radius_mm, radius_mm}});
  std::mt19937_64 rng(5);
  Off out;
  for (int n = 0; n < 200; ++n) {
    const Vec3 begin = d.entry_mm - d.axis * (uniform(rng, 0, depth_mm) - radius_mm);
    const Vec3 way = normalized({uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1)});
    double felt = -1;
    body.begin_frame();
    for (double far = 0; far < radius_mm && felt < 0; far += 0.005)
      if (body.deepest(begin + way * far, d.axis, 0, {}).hit) felt = far;
    if (!(felt > 0)) continue;  // it touched where it began, or nothing
    const Vec3 middle = begin + way * felt;
    double nearest = 1e9;
    for (const Triangle& t : all)
      nearest = std::min(nearest, norm(middle - surface::closest_on_triangle(middle, t.a, t.b, t.c)));
    out.voxels.push_back((nearest - radius_mm) / voxel_mm);
  }
  return out;
}

struct Row {
  Off point, ball;
};
Row row_of(double diameter_mm, double voxel_mm) {
  FeedRun run;
  run.diameter_mm = diameter_mm;
  run.voxel_mm = voxel_mm;
  run.max_depth_mm = diameter_mm >= 14 ? 4 : std::min(8.0, 1.5 * diameter_mm);
  Drilled d;
  const double depth_mm = feed_of(run, &d).depth_mm, radius_mm = 0.5 * diameter_mm;
  const contact::ContactVolume contact(d.volume);
  const std::vector<Triangle> all = shown(d, radius_mm);
  Row row{off_of_a_point(contact, all, voxel_mm), off_of_the_ball(contact, all, d, radius_mm, depth_mm, voxel_mm)};
  std::printf("| %.0f mm | %.1f mm | %zu | %.3f | %.3f | %.3f | %zu | %.2f | %.2f | %.2f |\n", diameter_mm, voxel_mm,
              row.point.voxels.size(), row.point.at(0.5), row.point.at(0.98), row.point.at(0.99),
              row.ball.voxels.size(), row.ball.at(0.01), row.ball.at(0.5), row.ball.at(0.99));
  std::fflush(stdout);
  return row;
}

}  // namespace

TEST(HapticsSeen, ADrilledHoleIsFeltWhereItIsSeen) {
  Row row = row_of(5, 0.5);
  EXPECT_LT(row.point.at(0.98), 0.1);
  EXPECT_LT(row.point.at(0.99), 0.2);
  EXPECT_GT(row.ball.voxels.size(), 50u);
  EXPECT_LT(row.ball.at(0.5), 0.2);
  EXPECT_GT(row.ball.at(0.01), -0.1) << "it is seen within the wall";
}

// docs/validation/drilling.md has this table.
TEST(LongHapticsSeen, OfEveryBallAndVoxel) {
  for (const double diameter_mm : {2.0, 3.0, 5.0, 7.0, 14.0})
    for (const double voxel_mm : {0.3, 0.5, 0.8, 1.0}) {
      Row row = row_of(diameter_mm, voxel_mm);
      EXPECT_LT(row.point.at(0.5), 0.02);
      EXPECT_LT(row.point.at(0.99), 0.35);
      EXPECT_LT(row.ball.at(0.5), 0.2);
    }
}
