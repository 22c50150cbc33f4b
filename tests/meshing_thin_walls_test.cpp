// SPDX-License-Identifier: GPL-3.0-or-later
// Walls about as thin as a voxel (orbit, sutures) are neither pierced nor merged by decimation and smoothing: pieces,
// genus and the distance between their two sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "meshing/decimate.h"
#include "meshing/smooth.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"
#include "surface/triangle_tree.h"

namespace trephine {
namespace {

using namespace shapes;

/// The pieces of a surface, the largest volume first.
std::vector<surface::TriMesh> pieces(const surface::TriMesh& m) {
  std::vector<int> of;
  std::vector<surface::TriMesh> all(surface::label_components(m, of));
  for (std::size_t t = 0; t < of.size(); ++t) all[of[t]].triangles.push_back(m.triangles[t]);
  for (surface::TriMesh& p : all) {
    p.origin_mm = m.origin_mm;
    p.points_mm = m.points_mm;
    surface::drop_unused_points(p);
  }
  std::sort(all.begin(), all.end(), [](const surface::TriMesh& a, const surface::TriMesh& b) {
    return std::abs(surface::volume_mm3(a)) > std::abs(surface::volume_mm3(b));
  });
  return all;
}

/// Least distance between two surfaces, from points spread over a's triangles and then over b's.
double min_distance_mm(const surface::TriMesh& a, const surface::TriMesh& b) {
  double least2 = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const surface::TriangleTree tree(*to);
    constexpr int n = 4;
    for (const auto& t : from->triangles) {
      const Vec3 o = from->points_mm[t[0]], u = from->points_mm[t[1]] - o, v = from->points_mm[t[2]] - o;
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n - i; ++j)
          least2 = std::min(least2, tree.squared_distance(o + u * (double(i) / n) + v * (double(j) / n), least2));
    }
  }
  return std::sqrt(least2);
}

/// Of the walls between each piece and the next smaller one within it.
double thinnest_mm(const surface::TriMesh& m) {
  const auto all = pieces(m);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < all.size(); ++i) least = std::min(least, min_distance_mm(all[i - 1], all[i]));
  return least;
}

surface::TriMesh decimated(const surface::TriMesh& m, double keep, double bound) {
  meshing::DecimateParams p;
  p.keep_ratio = keep;
  p.target_triangles_count = 0;
  p.max_deviation_mm = bound;
  Report r;
  return value_of(r, meshing::decimate(m, p));
}

/// Closed, and of the topology that it was.
void expect_same_topology(const surface::TriMesh& before, const surface::TriMesh& after, const std::string& what) {
  const meshing::Validity was = meshing::check_validity(before), is = meshing::check_validity(after);
  EXPECT_TRUE(is.valid()) << what << ": " << is.text();
  EXPECT_EQ(is.topology.components, was.topology.components) << what;
  EXPECT_EQ(is.topology.genus, was.topology.genus) << what;
}

/// The walls of `m` are as thick as that, at least; then decimated to 50, 10 and 2 % and with bounds, and smoothed.
/// Without a bound at least `share` of the thinnest wall stays; with one, all of it but the bound on either side.
void check_walls(const surface::TriMesh& m, double share, const char* name) {
  const double before = thinnest_mm(m);
  ASSERT_TRUE(meshing::check_validity(m).valid());
  for (const auto& [keep, bound] : {std::pair{0.5, 0.0}, {0.1, 0.0}, {0.02, 0.0}, {0.02, 0.3}, {0.0, 0.1}}) {
    const std::string what = std::string(name) + ", " + std::to_string(keep) + ", bound " + std::to_string(bound);
    const surface::TriMesh fewer = decimated(m, keep == 0.0 ? 0.001 : keep, bound);
    expect_same_topology(m, fewer, what);
    if (bound == 0) {
      EXPECT_LE(fewer.triangles.size(), std::size_t(keep * double(m.triangles.size())) + 4) << what;
    }
    const double after = thinnest_mm(fewer);
    EXPECT_GE(after, bound > 0 ? before - 2 * bound : share * before) << what;
    if (keep != 0.1 && bound != 0.3) continue;
    double thinnest_smooth = after;
    for (const meshing::SmoothMethod method :
         {meshing::SmoothMethod::windowed_sinc, meshing::SmoothMethod::laplacian, meshing::SmoothMethod::feature}) {
      meshing::SmoothParams s;
      s.method = method;
      s.iterations_count = 40;
      s.max_displacement_mm = 0.1;
      Report r;
      const surface::TriMesh smoothed = value_of(r, meshing::smooth(fewer, s));
      expect_same_topology(m, smoothed, what + ", smoothed");
      const double thin = thinnest_mm(smoothed);
      EXPECT_GE(thin, after - 2 * s.max_displacement_mm) << what;
      thinnest_smooth = std::min(thinnest_smooth, thin);
    }
    std::printf("%s: %zu to %zu triangles, thinnest wall %.3f to %.3f mm, smoothed %.3f mm\n", what.c_str(),
                m.triangles.size(), fewer.triangles.size(), before, after, thinnest_smooth);
  }
}

grid::Field shells(const grid::Lattice& l, std::vector<double> radii, double half, bool binary) {
  return sample(l, [&](Vec3 p) {
    double d = -1e9;
    for (const double r : radii) d = std::max(d, half - std::abs(norm(p) - r));
    return binary ? (d > 0 ? 0.5 : -0.5) : d;
  });
}

TEST(ThinWalls, OneVoxelSheet) {  // a hollow ball whose wall is one voxel, as a mask gives it
  const grid::Lattice l = lattice(29, 29, 29, {1, 1, 1}, {-14, -14, -14});
  check_walls(contoured(shells(l, {11.5}, 0.9, true)), 0.8, "one-voxel sheet");
}

TEST(ThinWalls, DoubleWallOfAnOrbit) {  // two walls of 1.6 voxels, 1.4 voxels apart
  const grid::Lattice l = lattice(37, 37, 37, {1, 1, 1}, {-18.1, -18.2, -18.3});
  check_walls(contoured(shells(l, {12, 15}, 0.8, false)), 0.5, "double wall");
}

TEST(ThinWalls, PlateWithHolesAndASuture) {  // an open edge all around; tunnels stay, the slit stays open
  grid::Field f(lattice(48, 30, 12));
  for (float& v : f.voxels) v = -0.5f;
  for (int j = 2; j < 28; ++j)
    for (int i = 2; i < 46; ++i) {
      const int k = 5 + int(std::lround(2 * std::sin(i / 8.0)));
      const bool hole = i % 11 == 5 && j % 9 == 4;        // of a voxel
      const bool suture = i == 24 + j / 3 % 2 && j < 26;  // a zigzag slit of one voxel, all but through
      if (hole || suture) continue;
      f.at(i, j, k) = 0.5f;
      if (i > 2 && int(std::lround(2 * std::sin((i - 1) / 8.0))) + 5 < k) f.at(i, j, k - 1) = 0.5f;
      if (i < 45 && int(std::lround(2 * std::sin((i + 1) / 8.0))) + 5 < k) f.at(i, j, k - 1) = 0.5f;
    }
  const surface::TriMesh m = contoured(f);
  const meshing::Validity was = meshing::check_validity(m);
  ASSERT_TRUE(was.valid()) << was.text();
  EXPECT_GE(was.topology.genus, 8);
  for (const double keep : {0.5, 0.2, 0.1}) {
    const surface::TriMesh fewer = decimated(m, keep, 0);
    expect_same_topology(m, fewer, std::to_string(keep));
    meshing::SmoothParams s;
    s.max_displacement_mm = 0.1;
    Report r;
    expect_same_topology(m, value_of(r, meshing::smooth(fewer, s)), "smoothed");
  }
  const surface::TriMesh bounded = decimated(m, 0.001, 0.2);
  expect_same_topology(m, bounded, "bound");
  EXPECT_NEAR(surface::volume_mm3(bounded) / surface::volume_mm3(m), 1, 0.1);
}

}  // namespace
}  // namespace trephine
