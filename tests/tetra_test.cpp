// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetra/tetra_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "base/pi.h"
#include "case_samples.h"
#include "meshio/sdf_model.h"
#include "surface/inside.h"
#include "surface/inside_query.h"
#include "surface/moments.h"

using namespace trephine;

namespace {

tetra::TetraMesh one(const std::array<Vec3, 4>& corners) {
  tetra::TetraMesh m;
  m.regions = {"all"};
  m.points_mm.assign(corners.begin(), corners.end());
  m.tetrahedra = {{0, 1, 2, 3}};
  m.region_of = {1};
  return m;
}

surface::TriMesh moved(surface::TriMesh mesh, Vec3 by) {
  mesh.origin_mm += by;
  return mesh;
}

surface::TriMesh box(Vec3 side, Vec3 middle) {
  surface::TriMesh m;
  m.origin_mm = middle;
  for (int n = 0; n < 8; ++n)
    m.points_mm.push_back(
        {(n & 1 ? 0.5 : -0.5) * side.x, (n & 2 ? 0.5 : -0.5) * side.y, (n & 4 ? 0.5 : -0.5) * side.z});
  for (const auto& t : std::vector<std::array<std::uint32_t, 3>>{{0, 2, 1},
                                                                 {1, 2, 3},
                                                                 {4, 5, 6},
                                                                 {5, 7, 6},
                                                                 {0, 1, 4},
                                                                 {1, 5, 4},
                                                                 {2, 6, 3},
                                                                 {3, 6, 7},
                                                                 {0, 4, 2},
                                                                 {2, 4, 6},
                                                                 {1, 3, 5},
                                                                 {3, 7, 5}})
    m.triangles.push_back(t);
  return m;
}

}  // namespace

TEST(Tetra, QualityOfKnownOnes) {
  const tetra::TetraMesh regular = one({Vec3{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}});
  const tetra::TetraQuality q = tetra::quality_of(regular);
  EXPECT_NEAR(std::acos(1.0 / 3) * 180 / pi, q.dihedral_min_deg, 1e-9);
  EXPECT_NEAR(q.dihedral_min_deg, q.dihedral_max_deg, 1e-9);
  EXPECT_NEAR(1, q.ratio_min, 1e-12);
  EXPECT_NEAR(8.0 / 3, tetra::volume_mm3(regular, 0), 1e-12);
  // A corner of a cube: right angles, and acos(1 / sqrt 3) at the slanted face.
  const tetra::TetraQuality corner = tetra::quality_of(one({Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_NEAR(std::acos(1 / std::sqrt(3)) * 180 / pi, corner.dihedral_min_deg, 1e-9);
  EXPECT_NEAR(90, corner.dihedral_max_deg, 1e-9);
  EXPECT_NEAR(std::sqrt(3) - 1, corner.ratio_min, 1e-9);  // 3 r / R with r = (3 - sqrt 3) / 6, R = sqrt 3 / 2
  // A flat one, and one that is turned inside out, are refused.
  EXPECT_THROW(tetra::quality_of(one({Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}})), Error);
  EXPECT_THROW(tetra::quality_of(one({Vec3{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}})), Error);
}

// The same places are inside as for the voxels, where both are asked.
TEST(Tetra, InsideIsAsForVoxels) {
  const surface::TriMesh mesh = moved(case_samples::ball(20, 12), {3, -40, 100});
  const surface::InsideQuery query(mesh);
  grid::Lattice lattice;
  lattice.size = {33, 31, 29};
  lattice.spacing_mm = {1.5, 1.6, 1.7};
  lattice.origin_mm = Vec3{3, -40, 100} - Vec3{1.5 * 16, 1.6 * 15, 1.7 * 14};
  const grid::Mask mask = surface::voxelize_inside(mesh, lattice);
  std::size_t inside = 0;
  for (int k = 0; k < 29; ++k)
    for (int j = 0; j < 31; ++j)
      for (int i = 0; i < 33; ++i) {
        const bool in = query.inside(lattice.to_world_mm({double(i), double(j), double(k)}));
        ASSERT_EQ(mask.voxels[mask.index(i, j, k)] != 0, in) << i << " " << j << " " << k;
        inside += in;
      }
  EXPECT_GT(inside, 5000u);
}

// A ball in a ball beside a third: three regions that share borders, of the right volumes.
TEST(Tetra, FillsNestedAndSeparateBalls) {
  const surface::TriMesh outer = case_samples::ball(20, 24), inner = case_samples::ball(9, 24),
                         beside = moved(case_samples::ball(6, 24), {40, 0, 0});
  tetra::TetraParams params;
  params.size_mm = 3;
  params.border_mm = 0.2;
  const auto filled = tetra::fill_with_tetrahedra({{"outer", &outer}, {"inner", &inner}, {"beside", &beside}}, params);
  const tetra::TetraMesh& m = filled.value;
  const auto& regions = filled.result.regions;
  const double whole = surface::volume_mm3(outer) / 1000, core = surface::volume_mm3(inner) / 1000;
  EXPECT_NEAR(whole - core, regions[0].second.volume_ml, 0.02 * whole);
  EXPECT_NEAR(core, regions[1].second.volume_ml, 0.04 * core);
  EXPECT_NEAR(surface::volume_mm3(beside) / 1000, regions[2].second.volume_ml, 0.07);
  for (const auto& [name, r] : regions) {
    EXPECT_NEAR(r.counted_volume_ml, r.volume_ml, 0.07 * r.volume_ml) << name;
    EXPECT_LT(r.deviation_max_mm, 0.5) << name;
    EXPECT_GT(r.deviation_rms_mm, 0) << name;
  }
  EXPECT_GT(filled.result.quality.dihedral_min_deg, 8);
  double all = 0;
  for (std::size_t n = 0; n < m.tetrahedra.size(); ++n) {
    ASSERT_GT(tetra::volume_mm3(m, n), 0);
    all += tetra::volume_mm3(m, n);
  }
  // Borders look out of their own region: what those of the inner ball enclose is its volume.
  const surface::TriMesh border = tetra::borders_of(m, 2);
  EXPECT_EQ(0u, surface::topology_of(border).boundary_edges);
  EXPECT_NEAR(1000 * regions[1].second.volume_ml, surface::volume_mm3(border), 1e-6);
  std::set<std::array<std::uint8_t, 2>> pairs(m.between.begin(), m.between.end());
  EXPECT_EQ((std::set<std::array<std::uint8_t, 2>>{{1, 0}, {2, 1}, {3, 0}}), pairs);
  // The same again.
  EXPECT_EQ(
      tetra::encode_msh(m),
      tetra::encode_msh(
          tetra::fill_with_tetrahedra({{"outer", &outer}, {"inner", &inner}, {"beside", &beside}}, params).value));
}

TEST(Tetra, RefusesWhatEnclosesNothing) {
  surface::TriMesh open = case_samples::ball(20, 8);
  std::vector<std::array<std::uint32_t, 3>> fewer(open.triangles.begin() + 3, open.triangles.end());
  open.triangles = fewer;
  try {
    tetra::fill_with_tetrahedra({{"shell", &open}}, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(ExitCode::bad_input, e.code());
    EXPECT_EQ("shell", e.field());
  }
}

// Mass and inertia of boxes, one within the other, against the formulas.
TEST(Sdf, MassOfBoxes) {
  const Vec3 side{40, 60, 100}, middle{10, -20, 300};
  const surface::Moments m = surface::moments_of(box(side, middle));
  EXPECT_NEAR(240000, m.volume, 1e-6);
  EXPECT_NEAR(0, norm(m.centre() - middle), 1e-9);
  const auto i = m.inertia();
  EXPECT_NEAR(240000 / 12.0 * (60 * 60 + 100 * 100), i[0], 1e-3);
  EXPECT_NEAR(240000 / 12.0 * (40 * 40 + 100 * 100), i[1], 1e-3);
  EXPECT_NEAR(240000 / 12.0 * (40 * 40 + 60 * 60), i[2], 1e-3);
  for (int n = 3; n < 6; ++n) EXPECT_NEAR(0, i[std::size_t(n)], 1e-3);

  const surface::TriMesh outer = box({100, 100, 100}, middle), inner = box({50, 50, 50}, middle + Vec3{20, 0, 0});
  meshio::SdfParams params;
  params.densities = "inner=3000";
  const auto made = meshio::sdf_model({{&outer, "outer", {1, 0, 0}, 1, false}, {&inner, "inner", {0, 1, 0}, 1, false}},
                                      "boxes", params);
  EXPECT_NEAR(1.0 + 0.125 * 2, made.result.mass_kg, 1e-12);
  // x of LPS is y of the model; the inner box draws the centre towards it.
  EXPECT_NEAR(0.020, made.result.centre_m[0], 1e-12);
  EXPECT_NEAR(0.010 + 0.25 * 0.020 / 1.25, made.result.centre_m[1], 1e-12);
  EXPECT_NEAR(0.300, made.result.centre_m[2], 1e-12);
  // About the front axis the inner one's offset counts (Steiner), about its own axis of offset it does not.
  const double own = 1.0 / 6 * 0.01 + 0.25 / 6 * 0.0025, offset = 0.25 * 1.0 / 1.25 * 0.0004;
  EXPECT_NEAR(own + offset, made.result.inertia_kg_m2[0], 1e-12);
  EXPECT_NEAR(own, made.result.inertia_kg_m2[1], 1e-12);
  EXPECT_NEAR(own + offset, made.result.inertia_kg_m2[2], 1e-12);
}
