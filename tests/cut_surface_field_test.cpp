// SPDX-License-Identifier: GPL-3.0-or-later
// The same hole cut out of the mesh (exact) and out of the field before contouring: what the field's voxels cost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "boolean/cut_surface.h"
#include "meshing/contour.h"
#include "meshing/validity.h"
#include "metrics/deviation.h"
#include "report_of.h"
#include "voxel/cut.h"

namespace trephine {
namespace {

using Kind = boolean::Cutter::Kind;
constexpr double voxel_mm = 0.6;

/// Signed distance, in mm, on voxels around the north pole of balls about the origin: a vault of bone, or skin.
grid::Field around_the_pole(const std::function<double(double radius)>& distance) {
  grid::Field f;
  f.size = {72, 72, 44};
  f.spacing_mm = {voxel_mm, voxel_mm, voxel_mm};
  f.origin_mm = {-21.3, -21.3, 50.1};
  f.voxels.resize(f.count());
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i)
        f.at(i, j, k) = static_cast<float>(distance(norm(f.to_world_mm({double(i), double(j), double(k)}))));
  return f;
}

/// Cuts both ways and compares: removed volume, distance between the two results, triangles.
void compare(const grid::Field& field, const std::vector<boolean::Cutter>& cutters, const char* what) {
  Report r;
  const surface::TriMesh whole = value_of(r, meshing::contour(field, {}));
  Report cut_report;
  const surface::TriMesh of_mesh = value_of(cut_report, boolean::cut_surface(whole, cutters, {}));
  grid::Field cut = field;
  for (const boolean::Cutter& c : cutters)
    value_of(r, voxel::cut_field(cut, boolean::distance_to(c), boolean::bounds_of(c)));
  const surface::TriMesh of_field = value_of(r, meshing::contour(cut, {}));
  for (const surface::TriMesh* m : {&of_mesh, &of_field}) {
    const meshing::Validity v = meshing::check_validity(*m);
    EXPECT_TRUE(v.valid() && v.float32) << what << ": " << v.text();
  }
  // Of overlapping cutters a ridge is left whose crest is thinner than a voxel: the field loses it, and may pierce it.
  const bool ridge = cutters.size() > 1;
  if (!ridge) {
    EXPECT_EQ(meshing::check_validity(of_field).topology.genus, meshing::check_validity(of_mesh).topology.genus)
        << what;
  }
  const double by_mesh = surface::volume_mm3(whole) - surface::volume_mm3(of_mesh),
               by_field = surface::volume_mm3(whole) - surface::volume_mm3(of_field);
  metrics::DeviationParams samples;
  samples.sample_count = 50000;
  const metrics::Deviation d = metrics::measure_deviation(of_field, of_mesh, samples);
  std::printf(
      "%s: mesh removes %.2f mm3, field %.2f (%.2f %%); deviation max %.3f, p99 %.3f, RMS %.4f mm; %zu and %zu "
      "triangles\n",
      what, by_mesh, by_field, 100 * (by_field / by_mesh - 1), d.both.max_mm, d.both.p99_mm, d.both.rms_mm,
      of_mesh.triangles.size(), of_field.triangles.size());
  // The field's edges are rounded within a voxel of them; elsewhere the two agree to a small part of a voxel.
  EXPECT_NEAR(by_field / by_mesh, 1, 0.03) << what;
  EXPECT_LE(d.both.max_mm, (ridge ? 2.5 : 1.0) * voxel_mm) << what;
  EXPECT_LE(d.both.rms_mm, (ridge ? 0.1 : 0.05) * voxel_mm) << what;
  EXPECT_GT(by_mesh, 50) << what;
}

boolean::Cutter cylinder(Vec3 position, Vec3 direction, double radius, double depth) {
  boolean::Cutter c;
  c.position_mm = position;
  c.direction = normalized(direction);
  c.radius_mm = radius;
  c.above_mm = 10;
  c.depth_mm = depth;
  return c;
}

boolean::Cutter ellipsoid(Vec3 centre, Vec3 radii) {
  boolean::Cutter c;
  c.kind = Kind::ellipsoid;
  c.position_mm = centre;
  c.direction = {0, 0, -1};
  c.across = normalized(Vec3{1, 0.4, 0});
  c.radii_mm = {radii.x, radii.y, radii.z};
  return c;
}

TEST(MeshAgainstField, BurrHoleInAVault) {
  const grid::Field skull = around_the_pole([](double r) { return 3.5 - std::abs(r - 66); });
  compare(skull, {cylinder({0.3, 0.2, 70}, {0.05, -0.1, -1}, 7, 12)}, "burr hole of 14 mm");
  compare(skull, {cylinder({4, -5, 70}, {0.4, 0.3, -1}, 3, 14)}, "tilted hole of 6 mm");
}

TEST(MeshAgainstField, SeveralCuttersAtOnce) {
  const grid::Field skull = around_the_pole([](double r) { return 3.5 - std::abs(r - 66); });
  compare(skull,
          {cylinder({-5, 0.2, 70}, {0, 0, -1}, 5, 14), cylinder({5, 1, 70}, {0.1, 0, -1}, 5, 14),
           ellipsoid({0, -8, 68}, {9, 4, 3})},
          "two overlapping holes and an ellipsoid");
}

TEST(MeshAgainstField, EllipsoidInTheSkin) {
  const grid::Field skin = around_the_pole([](double r) { return 70 - r; });
  compare(skin, {ellipsoid({1, 2, 69}, {11, 8, 6})}, "ellipsoid in the skin");
  compare(skin, {ellipsoid({-7, 2, 69}, {8, 6, 5}), ellipsoid({7, -3, 68}, {9, 7, 6})}, "two ellipsoids in the skin");
}

}  // namespace
}  // namespace trephine
