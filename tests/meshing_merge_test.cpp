// SPDX-License-Identifier: GPL-3.0-or-later
// Contours whose triangles are merged: valid, of the same pieces and handles, and within the bound, whatever the field.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/exact.h"
#include "meshing/marching_cubes.h"
#include "meshing/reference_distance.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "surface/cell_merge.h"

namespace trephine {
namespace {

using namespace shapes;

Result merged(const grid::Field& f, double within_mm) {
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  p.keep_cavities = true;
  p.within_mm = within_mm;
  Result out;
  out.mesh = value_of(out.report, meshing::contour(f, p));
  return out;
}

/// A field of one of several kinds: noise, smooth noise, thin sheets, and such that end, steps of whole numbers, a ball
/// at the border.
grid::Field random_field(std::uint64_t seed) {
  Random random(seed);
  grid::Lattice l = lattice(6 + int(random() * 10), 6 + int(random() * 10), 6 + int(random() * 10),
                            {0.4 + random(), 0.4 + random(), 0.4 + 3 * random()}, {10 * random(), -7, 3});
  const double c = std::cos(6 * random()), s = std::sqrt(1 - c * c);
  l.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, random() < 0.5 ? 1.0 : -1.0}};
  grid::Field f(l);
  const int kind = int(seed % 7);
  const Vec3 n{random() - 0.5, random() - 0.5, random() - 0.5}, m{random() - 0.5, random() - 0.5, random() - 0.5};
  const double at = 4 * random(), thick = 0.3 + random(), wave = 0.3 + random(), rough = 0.5 * random() * random();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p{double(i), double(j), double(k)};
        const double x = dot(p, n) / norm(n), y = dot(p, m) / norm(m), u = random() - 0.5;
        double v = u;
        if (kind == 1) v = std::sin(wave * x) + std::cos(wave * y) + rough * u;
        if (kind == 2) v = thick - std::abs(x - at) + 0.3 * rough * u;
        if (kind == 3) v = thick - std::abs(std::fmod(std::abs(x) + at, 3 * thick) - thick) + rough * u;
        if (kind == 4) v = std::nearbyint(4 * (std::sin(wave * x) * std::cos(wave * y) + rough * u)) + 0.5;
        if (kind == 6) v = std::min(thick - std::abs(x - at), std::abs(y - at) - 1);
        if (kind == 5) v = 4 - norm(p - Vec3{at, at, 2}) + rough * u;
        f.at(i, j, k) = static_cast<float>(v);
      }
  return f;
}

/// Returns how many triangles there were and are.
std::array<std::size_t, 2> compare(std::uint64_t seed) {
  const grid::Field f = random_field(seed);
  const double within_mm = 0.02 * std::pow(200.0, double(seed / 7 % 10) / 9);
  Result full;
  try {
    full = merged(f, 0);
  } catch (const Error&) {
    return {};  // no surface, or all of it in one slice
  }
  const Result made = merged(f, within_mm);
  const std::string what = "seed " + std::to_string(seed) + " within " + std::to_string(within_mm);
  const meshing::Validity v = meshing::check_validity(made.mesh);
  EXPECT_TRUE(v.valid() && v.float32) << what << ": " << v.text();
  EXPECT_EQ(made.count("components_count"), full.count("components_count")) << what;
  EXPECT_EQ(made.count("genus_count"), full.count("genus_count")) << what;
  EXPECT_EQ(made.number("within_proven_mm"), within_mm);
  // Points that were drawn in are not those of the interpolated surface.
  if (full.count("points_drawn_in_count") == 0 && made.count("points_drawn_in_count") == 0) {
    const meshing::DistanceToReference to(full.mesh, made.mesh.origin_mm);
    EXPECT_LE(to.largest_mm(made.mesh), within_mm + 1e-3) << what;
    if (seed % 4 == 0 && within_mm > 0.2) EXPECT_EQ(to.beyond(made.mesh, within_mm + 1e-3, {}).size(), 0u) << what;
  }
  return {full.mesh.triangles.size(), made.mesh.triangles.size()};
}

void compare_many(std::uint64_t from, std::uint64_t to) {
  std::size_t before = 0, after = 0, fields = 0;
  for (std::uint64_t seed = from; seed < to; ++seed) {
    const auto n = compare(seed);
    before += n[0];
    after += n[1];
    fields += n[0] > 0;
  }
  EXPECT_GT(10 * fields, 8 * (to - from));
  EXPECT_LT(double(after), 0.95 * double(before));
}

TEST(CellMerge, KeepsRandomSurfaces) { compare_many(0, 300); }
TEST(LongCellMerge, KeepsRandomSurfaces) { compare_many(300, 12300); }

/// A tilted plate with rounded rims, thinner than a cell in places and cut by the border, in thick slices.
grid::Field plate() {
  grid::Lattice l = lattice(70, 60, 30, {0.5, 0.5, 1.5}, {100, -20, 5});
  return sample(l, [](Vec3 p) {
    const Vec3 q = p - Vec3{117, -5, 27};
    return 0.9 - 0.012 * q.x - std::abs(0.2 * q.x + 0.1 * q.y + 0.97 * q.z - 0.004 * q.y * q.y);
  });
}

TEST(CellMerge, FlatPartsHaveFewTriangles) {
  const grid::Field f = plate();
  const Result full = merged(f, 0), made = merged(f, 0.3);
  EXPECT_LT(4 * made.mesh.triangles.size(), full.mesh.triangles.size());
  EXPECT_EQ(std::size_t(made.count("triangles_before_count")), full.mesh.triangles.size());
  EXPECT_FALSE(full.report.find("triangles_before_count"));
  EXPECT_EQ(made.count("genus_count"), full.count("genus_count"));
  const meshing::DistanceToReference to(full.mesh, made.mesh.origin_mm);
  EXPECT_EQ(to.beyond(made.mesh, 0.3, {}).size(), 0u);
  EXPECT_LT(to.largest_mm(made.mesh), 0.3);
  // The finer the bound, the nearer the surface.
  EXPECT_LT(2 * to.largest_mm(merged(f, 0.05).mesh), to.largest_mm(made.mesh));
}

TEST(CellMerge, DividedToTheLastTheSurfaceIsThatOfMarchingCubes) {
  const grid::Field f = plate();
  const surface::TriMesh cubes = meshing::marching_cubes(f, 0, meshing::find_inside(f, 0), 0.002, {});
  surface::CellMerge merge(cubes, f.spacing_mm, 0.3, meshing::triangles_intersect, {});
  std::size_t before = merge.mesh().triangles.size();
  EXPECT_LT(before, cubes.triangles.size() / 4);
  int times = 0;
  for (; merge.divide({cubes.points_mm.begin(), cubes.points_mm.end()}, {}) > 0; ++times) {
    const surface::TriMesh now = merge.mesh();
    EXPECT_GT(now.triangles.size(), before);
    EXPECT_EQ(surface::topology_of(now).euler_characteristic, surface::topology_of(cubes).euler_characteristic);
    EXPECT_TRUE(surface::topology_of(now).closed() && surface::topology_of(now).manifold());
    before = now.triangles.size();
  }
  EXPECT_EQ(times, 3);  // of 8, 4 and 2 cells
  EXPECT_EQ(before, cubes.triangles.size());
  EXPECT_EQ(merge.mesh().points_mm.size(), cubes.points_mm.size());
}

TEST(CellMerge, DropsThePiecesThatTheFineContourDrops) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    grid::Field f = noise(14, seed, 0.25, false);
    f.spacing_mm = {0.5, 0.5, 1.5};
    meshing::ContourParams p;
    p.min_component_mm3 = 1.5;
    const auto full = meshing::contour(f, p);
    p.within_mm = 0.4;
    const auto made = meshing::contour(f, p);
    EXPECT_EQ(made.result.components_count, full.result.components_count);
    EXPECT_EQ(made.result.genus_count, full.result.genus_count);
    EXPECT_EQ(made.result.cavities_dropped_count, full.result.cavities_dropped_count);
    EXPECT_EQ(made.result.small_components_dropped_count, full.result.small_components_dropped_count);
  }
}

TEST(CellMerge, DecimationsBoundHoldsForTheFineContour) {
  const grid::Field f = plate();
  const surface::TriMesh full = merged(f, 0).mesh, made = merged(f, 0.3).mesh;
  meshing::DecimateParams p;
  p.max_deviation_mm = 0.5;
  p.input_within_mm = 0.3;
  const auto few = meshing::decimate(made, p);
  EXPECT_LT(few.value.triangles.size(), made.triangles.size());
  EXPECT_LE(few.result.deviation_max_mm, 0.2);  // what is left for it
  EXPECT_EQ(few.result.deviation_proven_mm, 0.5);
  EXPECT_EQ(meshing::DistanceToReference(full, few.value.origin_mm).beyond(few.value, 0.5, {}).size(), 0u);
  p.input_within_mm = 0.5;
  EXPECT_THROW(meshing::decimate(made, p), Error);
}

TEST(CellMerge, SameBytesWithAnyThreads) {
  for (const grid::Field& f : {plate(), noise(30, 7, 0.3, false)}) {
    set_thread_count(1);
    const surface::TriMesh one = merged(f, 0.4).mesh;
    set_thread_count(3);
    const surface::TriMesh three = merged(f, 0.4).mesh;
    set_thread_count(0);
    EXPECT_TRUE(one.points_mm == three.points_mm && one.triangles == three.triangles);
  }
}

}  // namespace
}  // namespace trephine
