// SPDX-License-Identifier: GPL-3.0-or-later
// Where the haptic surface lies, against analytic solids; what a path through several shapes reads.
#include <gtest/gtest.h>

#include <algorithm>

#include "report_of.h"
#include "voxel/cut.h"
#include "voxel/decode.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

using shapes::Offsets;
using shapes::offsets_of;
using shapes::Solid;
using shapes::uniform;

const std::vector<Vec3> spacings{{0.8, 0.8, 0.8}, {0.4, 0.4, 0.95}};

double smallest(Vec3 v) { return std::min({v.x, v.y, v.z}); }

grid::Lattice lattice_for(const Solid& solid, Vec3 spacing_mm, std::mt19937_64& rng) {
  const Vec3 anchor{uniform(rng, 0, 1), uniform(rng, 0, 1), uniform(rng, 0, 1)};
  return shapes::lattice_around(surface::bounds_of(solid.mesh), spacing_mm, shapes::turned(rng), anchor);
}

Offsets felt(const Solid& solid, const grid::Lattice& lattice) {
  Report report;
  const voxel::HapticVolume volume = value_of(report, voxel::voxelize(lattice, {{"a", &solid.mesh}}));
  const voxel::HapticDecoder decoder(volume);
  return offsets_of(solid.points, 2, [&](Vec3 p) { return decoder.trilinear(1, p); });
}

TEST(Accuracy, BallsAndEllipsoidsInAnyPose) {
  std::mt19937_64 rng(1);
  for (const Vec3 h : spacings)
    for (int n = 0; n < 4; ++n) {
      const Vec3 centre{uniform(rng, -50, 50), uniform(rng, -50, 50), uniform(rng, -50, 50)};
      const Solid solid = n % 2 == 0 ? shapes::ball(6 + 3 * n, centre, 1000, rng)
                                     : shapes::ellipsoid({5, 9, 14}, centre, shapes::turned(rng), 1000, rng);
      const Offsets o = felt(solid, lattice_for(solid, h, rng));
      EXPECT_EQ(o.missed, 0);
      EXPECT_LT(std::abs(o.bias), 0.03 * smallest(h)) << "solid " << n << " at " << h.x;
      EXPECT_LT(o.rms, 0.03 * smallest(h));
      EXPECT_LT(o.worst, 0.2 * smallest(h));
    }
}

TEST(Accuracy, PlanesOfEveryDirectionAreExact) {
  std::mt19937_64 rng(2);
  for (const Vec3 h : spacings)
    for (int n = 0; n < 6; ++n) {
      const Solid solid = shapes::block({6, 8, 10}, {}, shapes::turned(rng), 1.5, 1000, rng);
      const Offsets o = felt(solid, lattice_for(solid, h, rng));
      EXPECT_EQ(o.missed, 0);
      EXPECT_LT(std::abs(o.bias), 0.002 * smallest(h));
      EXPECT_LT(o.worst, 0.02 * smallest(h));  // the quantum: 2 ramps / 255
    }
}

// A sheet is felt from where it is as thick as a voxel is along its normal; below that, sampling cannot promise it.
TEST(Accuracy, ThinSheetsAreFelt) {
  std::mt19937_64 rng(3);
  for (const Vec3 h : spacings)
    for (const double voxels : {1.02, 1.25, 1.5})
      for (int n = 0; n < 6; ++n) {
        const Mat3 pose = shapes::turned(rng), axes = n < 3 ? pose : shapes::turned(rng);
        const Vec3 along = transpose_times(axes, pose.column[2]);
        const double side = norm({along.x * h.x, along.y * h.y, along.z * h.z}), thick = voxels * side;
        const Vec3 centre{uniform(rng, 0, 1), uniform(rng, 0, 1), uniform(rng, 0, 1)};
        const Solid solid = shapes::block({9, 9, thick / 2}, centre, pose, 3, 400, rng, 2);
        Report report;
        const voxel::HapticVolume volume = value_of(
            report,
            voxel::voxelize(shapes::lattice_around(surface::bounds_of(solid.mesh), h, axes), {{"a", &solid.mesh}}));
        const voxel::HapticDecoder decoder(volume);
        for (const auto& s : solid.points) {
          const Vec3 inner = s.point_mm - s.normal * (thick / 2);
          ASSERT_GT(decoder.trilinear(1, inner), 0.5) << voxels << " voxels, sheet " << n << " at " << h.x;
        }
        const Offsets o = offsets_of(solid.points, 2, [&](Vec3 p) { return decoder.trilinear(1, p); });
        EXPECT_EQ(o.missed, 0);
        EXPECT_LT(o.rms, (voxels >= 1.5 ? 0.1 : voxels >= 1.25 ? 0.25 : 0.6) * side) << voxels;
      }
}

TEST(Accuracy, Volumes) {
  std::mt19937_64 rng(4);
  for (const Vec3 h : spacings) {
    const Solid ball = shapes::ball(10, {3, 2, 1}, 0, rng);
    const Solid block = shapes::block({6, 8, 10}, {}, shapes::turned(rng), 0, 0, rng);
    Report report;
    const voxel::HapticVolume a = value_of(report, voxel::voxelize(lattice_for(ball, h, rng), {{"a", &ball.mesh}}));
    const voxel::HapticVolume b = value_of(report, voxel::voxelize(lattice_for(block, h, rng), {{"b", &block.mesh}}));
    EXPECT_NEAR(voxel::shape_volume_mm3(a, 1), 4.0 / 3 * M_PI * 1000, 0.006 * 4.0 / 3 * M_PI * 1000);
    EXPECT_NEAR(voxel::shape_volume_mm3(b, 1), 3840, 0.006 * 3840);
    EXPECT_EQ(voxel::shape_volume_mm3(b, 2), 0);
    EXPECT_EQ(std::get<double>(*report.find("b.volume_ml")), voxel::shape_volume_mm3(b, 1) / 1000);
  }
}

// Solids in the order of precedence: each shape is its solid less those before it.
struct Scene {
  std::vector<Solid> solids;
  voxel::HapticVolume volume;
  // Distance to the region of a shape (0 based): at most the true one, and of its sign.
  double region(std::size_t n, Vec3 p) const {
    double d = solids[n].distance(p);
    for (std::size_t e = 0; e < n; ++e) d = std::max(d, -solids[e].distance(p));
    return d;
  }
};

Scene make_scene(std::vector<Solid> solids, Vec3 h, std::mt19937_64& rng) {
  Scene scene;
  scene.solids = std::move(solids);
  std::vector<voxel::VoxelizeShape> list;
  for (std::size_t n = 0; n < scene.solids.size(); ++n)
    list.push_back({"shape_" + std::to_string(n + 1), &scene.solids[n].mesh});
  surface::Bounds all;
  for (const Solid& s : scene.solids) {
    const surface::Bounds b = surface::bounds_of(s.mesh);
    for (int a = 0; a < 3; ++a) {
      all.min_mm[a] = std::min(all.min_mm[a], b.min_mm[a]);
      all.max_mm[a] = std::max(all.max_mm[a], b.max_mm[a]);
    }
  }
  const Vec3 anchor{uniform(rng, 0, 1), uniform(rng, 0, 1), uniform(rng, 0, 1)};
  Report report;
  scene.volume = value_of(report, voxel::voxelize(shapes::lattice_around(all, h, shapes::turned(rng), anchor), list));
  return scene;
}

std::vector<Scene> scenes(Vec3 h, std::mt19937_64& rng) {
  const Mat3 pose = shapes::turned(rng);
  std::vector<Scene> all;
  // Nested: a ball in a ball; ventricle, brain, a skull whose inside is the brain, skin. The skull is 1.9 to 2.5 mm.
  all.push_back(make_scene({shapes::ball(7, {1, 0, 0}, 1000, rng), shapes::ball(13, {}, 1000, rng)}, h, rng));
  all.push_back(make_scene(
      {shapes::ball(5, {0, 2, 0}, 1000, rng), shapes::ellipsoid({9, 12, 10}, {}, pose, 1000, rng),
       shapes::ellipsoid({11, 14.5, 12}, {}, pose, 1000, rng), shapes::ellipsoid({14, 17, 15}, {}, pose, 1000, rng)},
      h, rng));
  // Touching: two blocks that share a face.
  all.push_back(make_scene({shapes::block({6, 7, 8}, {}, pose, 2, 1000, rng),
                            shapes::block({5, 7, 8}, pose * Vec3{11, 0, 0}, pose, 2, 1000, rng)},
                           h, rng));
  return all;
}

// A path reads a shape only where that shape is: never a third one between two, nor one from the air beside another.
TEST(NoThirdShape, OnRandomPaths) {
  std::mt19937_64 rng(5);
  for (const Vec3 h : spacings)
    for (const Scene& scene : scenes(h, rng)) {
      const voxel::HapticDecoder decoder(scene.volume);
      const grid::Lattice& l = scene.volume.voxels;
      const double half_diagonal = norm(h) / 2;
      for (int path = 0; path < 600; ++path) {
        Vec3 end[2];
        for (Vec3& e : end)
          e = l.to_world_mm({uniform(rng, 0, l.size[0]), uniform(rng, 0, l.size[1]), uniform(rng, 0, l.size[2])});
        for (int step = 0; step <= 100; ++step) {
          const Vec3 p = end[0] + (end[1] - end[0]) * (step / 100.0);
          double sum = 0;
          for (std::size_t n = 0; n < scene.solids.size(); ++n) {
            const double o = decoder.trilinear(int(n + 1), p), region = scene.region(n, p);
            sum += o;
            if (o > 0.5) {
              ASSERT_LT(region, 0.26 * norm(h)) << "shape " << n + 1 << " reads " << o;
            }
            if (decoder.nearest(int(n + 1), p) > 0.5) {
              ASSERT_LT(region, half_diagonal + 0.26 * norm(h));
            }
            if (o > 0) {
              ASSERT_LT(region, norm(h) + 2 * half_diagonal);
            }
          }
          ASSERT_LE(sum, 1 + 1e-9);
        }
      }
    }
}

TEST(NoThirdShape, InVoxels) {
  std::mt19937_64 rng(6);
  for (const Vec3 h : spacings)
    for (const Scene& scene : scenes(h, rng)) {
      const voxel::HapticDecoder decoder(scene.volume);
      const grid::Lattice& l = scene.volume.voxels;
      std::size_t of_two = 0;
      for (int k = 0; k < l.size[2]; ++k)
        for (int j = 0; j < l.size[1]; ++j)
          for (int i = 0; i < l.size[0]; ++i) {
            const Vec3 centre = l.to_world_mm({double(i), double(j), double(k)});
            int shapes_here = 0;
            for (std::size_t n = 0; n < scene.solids.size(); ++n) {
              const double o = decoder.occupancy(int(n + 1), i, j, k), region = scene.region(n, centre);
              shapes_here += o > 0;
              // A shape has a share only where its own surface is within the ramp, and more than half only inside
              // (a sliver of a gap apart).
              if (o > 0) {
                ASSERT_LT(region, norm(h));
              }
              if (o > 0.5) {
                ASSERT_LT(region, 0.26 * norm(h)) << o;
              }
              if (region < -2 * norm(h)) {
                ASSERT_EQ(o, 1);
              }
            }
            of_two += shapes_here == 2;
            ASSERT_LE(shapes_here, 2);
          }
      EXPECT_GT(of_two, 500u);
    }
}

TEST(TwoShapes, ShareTheirSurface) {
  std::mt19937_64 rng(7);
  for (const Vec3 h : spacings) {
    const std::vector<Scene> all = scenes(h, rng);
    for (std::size_t at = 0; at < all.size(); ++at) {
      const Scene& scene = all[at];
      const voxel::HapticDecoder decoder(scene.volume);
      for (std::size_t n = 0; n < scene.solids.size(); ++n) {
        const int number = int(n + 1);
        std::vector<shapes::SurfacePoint> shared, free;
        for (const auto& s : scene.solids[n].points) {
          // Whose surface is it on the far side?
          const bool other =
              at == 2 ? std::abs(scene.solids[1 - n].distance(s.point_mm)) < 1e-6 : n + 1 < scene.solids.size();
          (other ? shared : free).push_back(s);
        }
        const auto own = [&](Vec3 p) { return decoder.trilinear(number, p); };
        const Offsets outer = offsets_of(free, 1.5, own), inner = offsets_of(shared, 1.5, own);
        EXPECT_EQ(outer.missed + inner.missed, 0);
        EXPECT_LT(std::abs(outer.bias), 0.05 * smallest(h)) << at << " " << number;
        EXPECT_LT(std::abs(inner.bias), 0.05 * smallest(h)) << at << " " << number;
        EXPECT_LT(outer.rms, 0.1 * smallest(h)) << at << " " << number;
        EXPECT_LT(inner.rms, 0.1 * smallest(h)) << at << " " << number;
        const int beyond = at == 2 ? 3 - number : number + 1;
        for (const auto& s : shared) {
          // (The skull is thinner than two ramps: some of its voxels are three shapes'.)
          const double sum = own(s.point_mm) + decoder.trilinear(beyond, s.point_mm);
          ASSERT_NEAR(sum, 1, at == 1 ? 0.02 : 1e-9) << "shapes " << number << " and " << beyond;
        }
      }
    }
  }
}

}  // namespace
}  // namespace trephine
