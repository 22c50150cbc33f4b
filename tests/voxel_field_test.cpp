// SPDX-License-Identifier: GPL-3.0-or-later
// Solids of fields: where they are felt, against what is analytic; voxels larger and smaller than the field's.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "report_of.h"
#include "voxel/decode.h"
#include "voxel/shape_occupancy.h"
#include "voxel_shapes.h"

namespace trephine {
namespace {

using shapes::Offsets;
using shapes::offsets_of;
using shapes::Solid;
using shapes::uniform;

// What a scanner's voxels may be: fine, thick slices, a zone's cells.
const std::vector<Vec3> scanned{{0.45, 0.45, 0.6}, {0.48, 0.48, 1.5}, {2, 2, 2}};

grid::Field field_of(const Solid& solid, Vec3 spacing_mm, const Mat3& direction) {
  grid::Field f(shapes::lattice_around(surface::bounds_of(solid.mesh), spacing_mm, direction, {0.1, 0.2, 0.3}));
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i)
        f.at(i, j, k) = float(-100 * solid.distance(f.to_world_mm({double(i), double(j), double(k)})));
  return f;
}

Offsets felt(const Solid& solid, const grid::Field& field, Vec3 spacing_mm, const Mat3& direction) {
  voxel::VoxelizeShape shape;
  shape.name = "a";
  shape.field = &field;
  Report report;
  const voxel::HapticVolume volume = value_of(
      report, voxel::voxelize(shapes::lattice_around(surface::bounds_of(solid.mesh), spacing_mm, direction), {shape}));
  const voxel::HapticDecoder decoder(volume);
  return offsets_of(solid.points, 2, [&](Vec3 p) { return decoder.trilinear(1, p); });
}

TEST(FieldSolid, PlanesOfEveryDirectionAreExact) {
  std::mt19937_64 rng(61);
  for (const Vec3 of : scanned)
    for (const Vec3 h : {Vec3{0.8, 0.8, 0.8}, Vec3{0.4, 0.4, 0.95}})
      for (int n = 0; n < 3; ++n) {
        const Solid solid = shapes::block({9, 10, 12}, {}, shapes::turned(rng), 5, 600, rng);
        const Mat3 axes = n ? shapes::turned(rng) : Mat3{};
        const Offsets o = felt(solid, field_of(solid, of, axes), h, n == 1 ? axes : Mat3{});
        EXPECT_EQ(o.missed, 0);
        EXPECT_LT(o.worst, 0.02 * h.x) << "voxels of " << of.z << ", felt in " << h.x;
      }
}

TEST(FieldSolid, BallsAreAsExactAsTheirFieldsVoxelsBend) {
  std::mt19937_64 rng(62);
  for (const Vec3 of : scanned) {
    const Solid solid = shapes::ball(12, {0.3, 0.2, 0.1}, 1000, rng);
    const Offsets o = felt(solid, field_of(solid, of, shapes::turned(rng)), {0.8, 0.8, 0.8}, {});
    // Between a field's voxels the surface is a chord: inside of the ball by up to cell^2 / (8 radius) along each axis.
    const double chord_mm = (of.x * of.x + of.y * of.y + of.z * of.z) / (8 * 12);
    EXPECT_EQ(o.missed, 0);
    EXPECT_LT(std::abs(o.bias), 0.02 + chord_mm) << of.z;
    EXPECT_LT(o.rms, 0.03 + chord_mm) << of.z;
    EXPECT_LT(o.worst, 0.02 + chord_mm) << of.z;
  }
}

// Where a volume's border cuts the shape it ends half a voxel beyond the last one's centre, as its contour does.
TEST(FieldSolid, EndsHalfAVoxelBeyondAField) {
  std::mt19937_64 rng(63);
  const Solid ball = shapes::ball(12, {}, 0, rng);
  const grid::Field whole = field_of(ball, {0.5, 0.5, 1.5}, {});
  grid::Box box = grid::whole_box(whole);
  box.begin[2] = whole.size[2] / 2;
  const grid::Field half = grid::crop(whole, box);
  Solid cut = ball;
  const double end_mm = half.to_world_mm({0, 0, -0.5}).z;
  for (int n = 0; n < 500; ++n) cut.points.push_back({{uniform(rng, -6, 6), uniform(rng, -6, 6), end_mm}, {0, 0, -1}});
  const Offsets o = felt(cut, half, {0.8, 0.8, 0.8}, {});
  EXPECT_EQ(o.missed, 0);
  EXPECT_LT(o.worst, 0.02);
}

TEST(FieldSolid, ThinSheetsAreFelt) {
  std::mt19937_64 rng(64);
  for (int n = 0; n < 8; ++n) {
    const Mat3 pose = shapes::turned(rng), axes = n < 4 ? pose : Mat3{};
    const Vec3 along = transpose_times(axes, pose.column[2]);
    const double side = 0.8 * norm({along.x, along.y, along.z}), thick = 1.5 * side;
    const Solid solid = shapes::block({12, 12, thick / 2}, {}, pose, 5, 300, rng, 2);
    const Offsets o = felt(solid, field_of(solid, {0.45, 0.45, 0.6}, axes), {0.8, 0.8, 0.8}, axes);
    EXPECT_EQ(o.missed, 0);
    EXPECT_LT(o.rms, 0.1 * side);
  }
}

TEST(FieldSolid, SameBytesWhateverTheThreadCount) {
  std::mt19937_64 rng(65);
  const Solid solid = shapes::ball(9, {}, 0, rng);
  const grid::Field field = field_of(solid, {0.45, 0.45, 1.5}, shapes::turned(rng));
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(solid.mesh), {0.4, 0.4, 0.95});
  std::vector<grid::Grid<std::uint8_t>> made;
  for (const int threads : {1, 2, 4}) {
    set_thread_count(threads);
    made.push_back(voxel::detail::solid_occupancy(field, {}, l, {}));
  }
  set_thread_count(0);
  EXPECT_EQ(made[0], made[1]);
  EXPECT_EQ(made[0], made[2]);
}

// Voxels that are turned are felt as those of a field that has them on the other side, at its border too.
TEST(FieldSolid, TurnedVoxelsAreOnTheOtherSide) {
  std::mt19937_64 rng(66);
  const Solid solid = shapes::ball(9, {}, 0, rng);
  const grid::Field whole = field_of(solid, {0.45, 0.45, 1.5}, shapes::turned(rng));
  const grid::Lattice l = shapes::lattice_around(surface::bounds_of(solid.mesh), {0.4, 0.4, 0.95});
  grid::Field other = whole;
  std::vector<bool> turned(whole.count(), false);
  for (std::size_t v = 0; v < whole.count(); v += 1 + rng() % 40) {
    turned[v] = true;
    other.voxels[v] = other.voxels[v] > 0 ? -other.voxels[v] : std::max(-other.voxels[v], 1e-3f);
  }
  const auto felt_of = [&](const grid::Field& f, const std::vector<bool>& t) {
    return voxel::detail::solid_occupancy(f, t, l, {});
  };
  EXPECT_EQ(felt_of(whole, turned), felt_of(other, {}));
  EXPECT_NE(felt_of(whole, turned), felt_of(whole, {}));
}

}  // namespace
}  // namespace trephine
