// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact.h"

#include <gtest/gtest.h>

#include <limits>

#include "contact_walls.h"
#include "voxel/decode.h"

using namespace trephine;
using namespace trephine::walls;
using Walk = contact::ContactParams::Walk;
using Surface = contact::ContactParams::Surface;

namespace {

// At 1 kHz, 0.001 to 100 m/s are 0.001 to 100 mm a frame.
double random_length(std::mt19937_64& rng) { return std::pow(10.0, uniform(rng, -3, 2)); }

// Segments against each box of the wall. Returns how many of them met it.
int compare_boxes(Wall& w, int segments, std::mt19937_64& rng) {
  const contact::ContactVolume contact(w.volume, {Walk::exact, Surface::nearest, 1});
  int met = 0;
  for (int n = 0; n < segments; ++n) {
    const Way way = random_way(w, random_length(rng), rng);
    if (contact.shape_at(way.start_mm) != 0) continue;
    const Truth truth = brute_force(w, way.start_mm, way.end_mm);
    const contact::Contact c = contact.intersect(way.start_mm, way.end_mm);
    if (truth.hit && truth.depth > 1e-9) {
      ++met;
      EXPECT_TRUE(c.hit) << w.name;
    }
    if (!truth.hit) {
      EXPECT_FALSE(c.hit) << w.name;
    }
    if (c.hit && truth.depth > 1e-9) {
      EXPECT_NEAR(c.along, truth.along, 1e-9) << w.name;
      EXPECT_EQ(c.shape, 3);
      EXPECT_EQ(c.face, contact::ContactFace::front);
      EXPECT_NEAR(norm(c.normal), 1, 1e-12);
      EXPECT_LT(dot(c.normal, way.end_mm - way.start_mm), 0);
    }
    if (::testing::Test::HasFailure()) return met;
  }
  return met;
}

// Share of the segments from one side of the wall to the other that do not stop.
double fall_through(Wall& w, const contact::ContactParams& params, int segments, std::mt19937_64& rng) {
  const contact::ContactVolume contact(w.volume, params);
  int through = 0, crossing = 0;
  while (crossing < segments) {
    const Way way = random_way(w, std::pow(10.0, uniform(rng, -1, 2)), rng);
    const int from = side_of(w, way.start_mm), to = side_of(w, way.end_mm);
    if (from == 0 || to == 0 || from == to || contact.shape_at(way.start_mm) != 0) continue;
    ++crossing;
    if (!contact.intersect(way.start_mm, way.end_mm).hit) ++through;
  }
  return double(through) / segments;
}

// Goes in small steps from one side to the other, carrying the shape along; true where it got through unseen.
bool creeps_through(const Wall& w, const contact::ContactVolume& contact, double step_mm, std::mt19937_64& rng) {
  while (true) {
    const Way way = random_way(w, 6, rng);
    if (side_of(w, way.start_mm) * side_of(w, way.end_mm) != 2 || contact.shape_at(way.start_mm) != 0) continue;
    const int steps = int(std::ceil(6 / step_mm));
    Vec3 at = way.start_mm;
    int shape = 0;
    for (int n = 1; n <= steps; ++n) {
      const Vec3 next = way.start_mm + (way.end_mm - way.start_mm) * (double(n) / steps);
      const contact::Contact c = contact.intersect(at, next, shape);
      if (c.hit) return false;
      at = next;
      shape = c.into;
    }
    return true;
  }
}

const Vec3 anisotropic{0.4, 0.4, 0.95};

}  // namespace

TEST(Contact, EachBoxOfAWallIsMetWhereItBegins) {
  std::mt19937_64 rng(1);
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (Wall& w : all_walls(lattice(24, anisotropic), encoding)) EXPECT_GT(compare_boxes(w, 2000, rng), 200) << w.name;
}

TEST(LongContact, AMillionSegmentsAgainstEachBox) {
  std::mt19937_64 rng(2);
  int met = 0;
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (Wall& w : all_walls(lattice(32, anisotropic), encoding)) met += compare_boxes(w, 72000, rng);
  std::printf("1,008,000 segments, of which %d meet the wall: 0 missed\n", met);
}

TEST(Contact, NothingFallsThroughAWallOfOneVoxel) {
  std::mt19937_64 rng(3);
  for (const Vec3 spacing : {Vec3{0.5, 0.5, 0.5}, anisotropic})
    for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
      for (Wall& w : all_walls(lattice(24, spacing), encoding))
        for (const Surface surface : {Surface::subvoxel, Surface::nearest})
          EXPECT_EQ(fall_through(w, {Walk::exact, surface, 1}, 4000, rng), 0) << w.name;
}

TEST(LongContact, NothingFallsThroughAMillionTimes) {
  std::mt19937_64 rng(4);
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (Wall& w : all_walls(lattice(32, anisotropic), encoding))
      for (const Surface surface : {Surface::subvoxel, Surface::nearest})
        EXPECT_EQ(fall_through(w, {Walk::exact, surface, 1}, 36000, rng), 0) << w.name;
}

TEST(Contact, NothingCreepsThroughInSmallSteps) {
  std::mt19937_64 rng(5);
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (Wall& w : all_walls(lattice(24, anisotropic), encoding))
      for (const Surface surface : {Surface::subvoxel, Surface::nearest}) {
        const contact::ContactVolume contact(w.volume, {Walk::exact, surface, 1});
        for (const double step : {0.001, 0.02, 0.3})
          for (int n = 0; n < (step < 0.01 ? 3 : 60); ++n)
            EXPECT_FALSE(creeps_through(w, contact, step, rng)) << w.name;
      }
}

// What the dissertation's walk misses is what the exact one is for.
TEST(Contact, TheSteppedWalkMissesLessTheSmallerItsStep) {
  std::mt19937_64 rng(6);
  std::printf("| encoding, surface | wall | missed, %%: k = 1 | 0.5 | 0.25 | 0.1 |\n");
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (const Surface surface : {Surface::nearest, Surface::subvoxel})
      for (Wall& w : all_walls(lattice(24, anisotropic), encoding)) {
        std::printf("| %s, %s | %s |", encoding == voxel::HapticEncoding::hu ? "HU" : "occupancy",
                    surface == Surface::nearest ? "nearest" : "subvoxel", w.name.c_str());
        double before = 1;
        for (const double k : {1.0, 0.5, 0.25, 0.1}) {
          const double share = fall_through(w, {Walk::stepped, surface, k}, 2000, rng);
          std::printf(" %.1f |", 100 * share);
          EXPECT_LE(share, before + 0.01) << w.name << " " << k;
          if (w.name == "flat" && surface == Surface::nearest) {
            EXPECT_LT(share, 1e-9) << k;
          }
          before = share;
        }
        std::printf("\n");
        EXPECT_LT(before, 0.04) << w.name;
      }
}

namespace {

// A bumpy ball of partly filled voxels around (11.5, 11.5, 11.5), beside a second shape in its lower half.
voxel::HapticVolume two_shapes(const grid::Lattice& l, bool bare) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("bone", 2), voxel::occupancy_shape("brain", 5)};
  const auto level = [](Vec3 p) { return 7.3 + 0.8 * std::sin(p.x) - norm(p - Vec3{11.5, 11.5, 11.5}); };
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const int o = int(std::lround(255 * std::clamp(0.5 + level({double(i), double(j), double(k)}), 0.0, 1.0)));
        if (o == 0) continue;
        const int number = k < 12 ? 2 : 5;
        const bool seam = k == 11 || k == 12;
        v.voxels.at(i, j, k) = std::int16_t(1000 * number + o + (bare || (seam && o < 255) ? 300 : 0));
      }
  return v;
}

}  // namespace

TEST(Contact, TheSurfaceIsWhereTheDecoderSays) {
  std::mt19937_64 rng(7);
  for (const bool bare : {true, false}) {
    voxel::HapticVolume v = two_shapes(lattice(24, anisotropic), bare);
    const voxel::HapticVolume before = v;
    const voxel::HapticDecoder decoder(before);
    const contact::ContactVolume contact(v);
    for (int n = 0; n < int(v.voxels.voxels.size()); ++n)  // settling changes no meaning
      if (v.voxels.voxels[std::size_t(n)] != before.voxels.voxels[std::size_t(n)]) {
        EXPECT_FALSE(bare);
      }
    const auto filled = [&](Vec3 p) { return decoder.trilinear(2, p) + decoder.trilinear(5, p); };
    int hits = 0, shapes[6] = {};
    for (int n = 0; n < 8000; ++n) {
      const Vec3 start = v.voxels.to_world_mm({uniform(rng, -2, 25), uniform(rng, -2, 25), uniform(rng, -2, 25)});
      const Vec3 end = start + unit_vector(rng) * std::pow(10.0, uniform(rng, -1, 1));
      if (filled(start) > 0.499) continue;
      const contact::Contact c = contact.intersect(start, end);
      // Before the contact nothing is half full, at it something is.
      const double until = c.hit ? c.along : 1;
      for (int s = 0; s <= 200; ++s) {
        const Vec3 p = start + (end - start) * (until * s / 200);
        ASSERT_LT(filled(p), 0.5 + 1e-6) << n;
      }
      if (!c.hit) continue;
      ++hits;
      ++shapes[c.shape];
      EXPECT_NEAR(filled(c.point_mm), 0.5, 1e-6);
      EXPECT_GE(decoder.trilinear(c.shape, c.point_mm), decoder.trilinear(7 - c.shape, c.point_mm) - 1e-6);
      EXPECT_EQ(c.from, 0);
      EXPECT_EQ(c.into, c.shape);
    }
    EXPECT_GT(shapes[2], 100);
    EXPECT_GT(shapes[5], 100);
  }
}

TEST(Contact, WhereTwoShapesMeetThereIsOneSurface) {
  voxel::HapticVolume v = two_shapes(lattice(24, {0.5, 0.5, 0.5}), false);
  const contact::ContactVolume contact(v);
  // From bone into brain, along k: at k = 11.5.
  const Vec3 start = v.voxels.to_world_mm({11.3, 11.2, 8}), end = v.voxels.to_world_mm({11.3, 11.2, 15});
  contact::Contact c = contact.intersect(start, end);
  ASSERT_TRUE(c.hit);
  EXPECT_EQ(c.face, contact::ContactFace::front);
  EXPECT_EQ(c.shape, 5);
  EXPECT_EQ(c.from, 2);
  EXPECT_NEAR(v.voxels.to_index(c.point_mm).z, 11.5, 1e-9);
  EXPECT_LT(norm(c.normal + v.voxels.direction.column[2]), 1e-9);
  contact::TouchableFaces faces;
  faces.front = 0;
  c = contact.intersect(start, end, faces);  // the back of bone is in the same place
  ASSERT_TRUE(c.hit);
  EXPECT_EQ(c.face, contact::ContactFace::back);
  EXPECT_EQ(c.shape, 2);
  EXPECT_NEAR(v.voxels.to_index(c.point_mm).z, 11.5, 1e-9);
  faces.back = 1u << 5;  // only where brain is left again
  const Vec3 out = v.voxels.to_world_mm({11.3, 11.2, 23});
  c = contact.intersect(start, out, faces);
  ASSERT_TRUE(c.hit);
  EXPECT_EQ(c.shape, 5);
  EXPECT_EQ(c.into, 0);
  EXPECT_GT(v.voxels.to_index(c.point_mm).z, 15);
  EXPECT_LT(dot(c.normal, v.voxels.direction.column[2]), -0.5);
  faces.back = 0;
  c = contact.intersect(start, out, faces);
  EXPECT_FALSE(c.hit);
  EXPECT_EQ(c.into, 0);
  EXPECT_EQ(contact.intersect(start, end, faces).into, 5);
}

TEST(Contact, NormalsOfABall) {
  grid::Lattice l = lattice(40, {0.5, 0.5, 0.5});
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("ball", 1)};
  const double r = 14;
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) {
        const double d = r - norm(Vec3{double(i), double(j), double(k)} - Vec3{19.5, 19.5, 19.5});
        const int o = int(std::lround(255 * std::clamp(0.5 + d, 0.0, 1.0)));
        if (o > 0) v.voxels.at(i, j, k) = std::int16_t(1000 + o);
      }
  const contact::ContactVolume contact(v);
  const Vec3 centre = l.to_world_mm({19.5, 19.5, 19.5});
  std::mt19937_64 rng(8);
  double sum = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 u = unit_vector(rng);
    const contact::Contact c = contact.intersect(centre + u * 12, centre);
    ASSERT_TRUE(c.hit);
    EXPECT_NEAR(norm(c.point_mm - centre), 0.5 * r, 0.05);
    const double angle = std::acos(std::min(1.0, dot(c.normal, u))) * 180 / M_PI;
    EXPECT_LT(angle, 6);
    sum += angle;
  }
  EXPECT_LT(sum / 2000, 2);
}

TEST(Contact, WhatIsNotFiniteIsRefused) {
  Wall w = std::move(all_walls(lattice(24, anisotropic), voxel::HapticEncoding::occupancy)[1]);
  const contact::ContactVolume contact(w.volume);
  const Vec3 good = w.volume.voxels.to_world_mm({12, 12, 2});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(), 1e300, -1e10})
    for (int a = 0; a < 3; ++a) {
      Vec3 p = good;
      p[a] = bad;
      for (const contact::Contact& c :
           {contact.intersect(p, good), contact.intersect(good, p), contact.intersect(p, p)}) {
        EXPECT_TRUE(c.refused);
        EXPECT_FALSE(c.hit);
      }
      EXPECT_EQ(contact.shape_at(p), 0);
      EXPECT_EQ(contact.normal_at(p, 0, 3), Vec3{});
    }
  EXPECT_FALSE(contact.intersect(good, good).hit);
  EXPECT_FALSE(contact.intersect(good, good).refused);
}

TEST(Contact, FromFarAwayAndAtFarCoordinates) {
  std::mt19937_64 rng(9);
  // A way that begins up to 1 km off.
  Wall w = std::move(all_walls(lattice(24, anisotropic), voxel::HapticEncoding::occupancy)[3]);
  const contact::ContactVolume contact(w.volume);
  int hits = 0;
  for (int n = 0; n < 2000; ++n) {
    Way way = random_way(w, 2e6, rng);
    const Truth truth = brute_force(w, way.start_mm, way.end_mm);
    const contact::ContactVolume nearest(w.volume, {Walk::exact, Surface::nearest, 1});
    const contact::Contact c = nearest.intersect(way.start_mm, way.end_mm);
    if (truth.hit && truth.depth > 1e-12) {
      EXPECT_TRUE(c.hit);
      EXPECT_NEAR(c.along, truth.along, 1e-12);
      ++hits;
    }
  }
  EXPECT_GT(hits, 500);
  // The whole scene 1 km from the origin.
  Wall far = std::move(all_walls(lattice(24, anisotropic, {1e6, -1e6, 1e6}), voxel::HapticEncoding::occupancy)[3]);
  for (const Surface surface : {Surface::subvoxel, Surface::nearest}) {
    EXPECT_EQ(fall_through(far, {Walk::exact, surface, 1}, 4000, rng), 0);
    const contact::ContactVolume there(far.volume, {Walk::exact, surface, 1});
    for (int n = 0; n < 20; ++n) EXPECT_FALSE(creeps_through(far, there, 0.02, rng));
  }
}

// Who lowers voxels loosens their blocks first; settling takes in what was done.
TEST(Contact, SeesWhatWasCutMeanwhile) {
  for (const voxel::HapticEncoding encoding : {voxel::HapticEncoding::occupancy, voxel::HapticEncoding::hu})
    for (const Surface surface : {Surface::subvoxel, Surface::nearest}) {
      const bool hu = encoding == voxel::HapticEncoding::hu;
      voxel::HapticVolume v;
      v.encoding = encoding;
      v.voxels = grid::Grid<std::int16_t>(lattice(24, {1, 1, 1}), std::int16_t(hu ? 700 : 2255));
      v.shapes = {hu ? voxel::HapticShape{"block", 2, 300, 900} : voxel::occupancy_shape("block", 2)};
      contact::ContactVolume contact(v, {Walk::exact, surface, 1});
      const Vec3 start = v.voxels.to_world_mm({11, 11, -5}), end = v.voxels.to_world_mm({11, 11, 30});
      EXPECT_NEAR(v.voxels.to_index(contact.intersect(start, end).point_mm).z, -0.5, hu ? 0.3 : 1e-6);
      const grid::Box hole{{8, 8, 0}, {15, 15, 14}};
      contact.loosen(hole);
      for (int k = 0; k < 14; ++k)
        for (int j = 8; j < 15; ++j)
          for (int i = 8; i < 15; ++i)
            v.voxels.at(i, j, k) = hu ? std::int16_t(voxel::haptic_beyond_hu) : voxel::haptic_empty;
      for (int pass = 0; pass < 2; ++pass) {
        const contact::Contact c = contact.intersect(start, end);
        ASSERT_TRUE(c.hit);
        EXPECT_NEAR(v.voxels.to_index(c.point_mm).z, 13.5, hu ? 0.3 : 1e-6) << pass;
        EXPECT_EQ(contact.shape_at(v.voxels.to_world_mm({11, 11, 9})), 0);
        EXPECT_EQ(contact.shape_at(v.voxels.to_world_mm({11, 11, 16})), 2);
        EXPECT_EQ(contact.shape_at(v.voxels.to_world_mm({3, 11, 9})), 2);
        contact.settle(grid::grown(hole, 2, v.voxels));
      }
    }
}

TEST(Contact, BeyondTheLatticeIsNothing) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(8, {1, 1, 1}), std::int16_t(1255));
  v.shapes = {voxel::occupancy_shape("block", 1)};
  for (const Surface surface : {Surface::subvoxel, Surface::nearest})
    for (const Walk walk : {Walk::exact, Walk::stepped}) {
      const contact::ContactVolume contact(v, {walk, surface, 1});
      const auto at = [&](double x) { return v.voxels.to_world_mm({x, 3.2, 4.1}); };
      const contact::Contact in = contact.intersect(at(-50), at(50)), out = contact.intersect(at(4), at(50));
      ASSERT_TRUE(in.hit && out.hit);
      EXPECT_NEAR(v.voxels.to_index(in.point_mm).x, -0.5, 1e-6);
      EXPECT_NEAR(v.voxels.to_index(out.point_mm).x, 7.5, 1e-6);
      EXPECT_EQ(out.face, contact::ContactFace::back);
      EXPECT_GT(dot(in.normal, at(-1) - at(0)), 0.99);
      EXPECT_GT(dot(out.normal, at(-1) - at(0)), 0.99);
      EXPECT_FALSE(contact.intersect(at(-50), at(-2)).hit);
      EXPECT_FALSE(contact.intersect(at(50), at(60)).hit);
      EXPECT_EQ(contact.shape_at(at(-0.6)), 0);
      EXPECT_EQ(contact.shape_at(at(-0.4)), 1);
    }
}

// Windows that adjoin, and HU between windows that are nobody's: felt as decoded, but for the few cells that are boxes.
TEST(ContactHu, IsFeltWhereItIsDecoded) {
  for (const int bone_low : {101, 170}) {
    voxel::HapticVolume v;
    v.encoding = voxel::HapticEncoding::hu;
    v.voxels = grid::Grid<std::int16_t>(lattice(40, {1, 1, 1}), 0);
    v.shapes = {{"soft", 1, 0, 100}, {"bone", 2, std::int16_t(bone_low), 3000}};
    for (int k = 0; k < 40; ++k)
      for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i)
          v.voxels.at(i, j, k) =
              std::int16_t(150 + 400 * (std::sin(0.31 * i) + std::sin(0.27 * j + 1) * std::cos(0.23 * k)));
    const contact::ContactVolume contact(v, {});
    const voxel::HapticDecoder decoder(v);
    std::mt19937_64 rng(5);
    int felt[3] = {0, 0, 0}, apart = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vec3 p = v.voxels.to_world_mm({uniform(rng, 0, 39), uniform(rng, 0, 39), uniform(rng, 0, 39)});
      const int shape = contact.shape_at(p);
      ++felt[shape], apart += shape != (decoder.trilinear(1, p) >= 0.5 ? 1 : decoder.trilinear(2, p) >= 0.5 ? 2 : 0);
    }
    EXPECT_GT(std::min({felt[0], felt[1], felt[2]}), 500);
    // Where a layer parts what is open on its two sides, cells are boxes: air and the HU of nobody here.
    EXPECT_LE(apart, bone_low == 101 ? 20 : 400) << bone_low;
  }
}
