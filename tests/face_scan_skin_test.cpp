// SPDX-License-Identifier: GPL-3.0-or-later
// The skin that is measured from a scan's values alone, and how much of it a thing shows.
#include <gtest/gtest.h>

#include <cmath>

#include "base/pi.h"
#include "face/scan_skin.h"
#include "meshing/contour.h"

namespace trephine {
namespace {

constexpr double ball_mm = 60;

/// A ball of tissue with a wall of bone 10 to 16 mm under its surface, a cavity in its middle, and a passage of
/// `passage_mm` from the cavity to the outside; by the values of air, tissue and bone.
template <class T>
grid::HuVolume head(T air, T tissue, T bone, double passage_mm) {
  grid::Lattice l;
  l.size = {160, 160, 160};
  l.origin_mm = {-79.5, -79.5, -79.5};
  grid::Grid<T> g(l, air);
  for (int k = 0; k < 160; ++k)
    for (int j = 0; j < 160; ++j)
      for (int i = 0; i < 160; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const double depth = ball_mm - norm(p);
        const bool passage = p.y < 0 && std::hypot(p.x, p.z) < passage_mm / 2;
        if (depth < 0 || depth > 40 || passage) continue;
        g.at(i, j, k) = depth > 10 && depth < 16 ? bone : tissue;
      }
  return g;
}

surface::TriMesh ball(double radius_mm) {
  grid::Lattice l;
  l.size = {90, 90, 90};
  l.spacing_mm = {1.7, 1.7, 1.7};
  l.origin_mm = {-75, -75, -75};
  grid::Field f(l);
  for (int k = 0; k < 90; ++k)
    for (int j = 0; j < 90; ++j)
      for (int i = 0; i < 90; ++i)
        f.at(i, j, k) = float(radius_mm - norm(l.to_world_mm({double(i), double(j), double(k)})));
  return meshing::contour(f, meshing::ContourParams()).value;
}

/// The least and the largest distance of the skin's crossings along x from the middle.
std::pair<double, double> range_mm(const grid::Field& f) {
  double least = 1e9, most = 0;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i + 1 < f.size[0]; ++i) {
        const double a = f.at(i, j, k), b = f.at(i + 1, j, k);
        if ((a > 0) == (b > 0)) continue;
        const double r = norm(f.to_world_mm({i + a / (a - b), double(j), double(k)}));
        least = std::min(least, r);
        most = std::max(most, r);
      }
  return {least, most};
}

TEST(ScanSkin, LiesWhereTheScanHasItInCtAndMr) {
  const auto ct = face::scan_skin(head<std::int16_t>(-1000, 30, 900, 8), face::ScanValues::hu);
  ASSERT_TRUE(ct);
  // The passage is followed by ten millimetres and not into the cavity.
  EXPECT_GT(range_mm(*ct).first, ball_mm - 14);
  EXPECT_LT(range_mm(*ct).second, ball_mm + 1);
  // In an MR bone is as dark as air: what lies behind it is no skin all the same.
  const auto mr = face::scan_skin(head<float>(5, 300, 8, 8), face::ScanValues::brightness);
  ASSERT_TRUE(mr);
  EXPECT_GT(range_mm(*mr).first, ball_mm - 14);
  EXPECT_LT(range_mm(*mr).second, ball_mm + 1.5);
  const auto whole = face::scan_skin(head<float>(5, 300, 8, 0), face::ScanValues::brightness);
  ASSERT_TRUE(whole);
  EXPECT_NEAR(range_mm(*whole).first, ball_mm, 1.5);  // on cells of 2 mm
  EXPECT_NEAR(range_mm(*whole).second, ball_mm, 1.5);
}

TEST(ScanSkin, NothingWhereNothingIsSeen) {
  EXPECT_FALSE(face::scan_skin(head<std::int16_t>(-1000, -1000, -1000, 0), face::ScanValues::hu));
  EXPECT_FALSE(face::scan_skin(head<std::int16_t>(30, 30, 30, 0), face::ScanValues::hu)) << "no air about it";
  EXPECT_FALSE(face::scan_skin(head<float>(7, 7, 7, 0), face::ScanValues::brightness));
}

TEST(ScanSkin, HowMuchOfItIsShown) {
  const grid::HuVolume scan = head<std::int16_t>(-1000, 30, 900, 0);
  const auto skin = face::scan_skin(scan, face::ScanValues::hu);
  ASSERT_TRUE(skin);
  const double area_cm2 = 4 * pi * ball_mm * ball_mm / 100;
  EXPECT_NEAR(face::skin_shown_cm2(*skin, ball(ball_mm)), area_cm2, 0.1 * area_cm2);
  EXPECT_EQ(face::skin_shown_cm2(*skin, ball(ball_mm - 4)), 0) << "bone under it";
  EXPECT_EQ(face::skin_shown_cm2(*skin, surface::TriMesh()), 0);
  EXPECT_NEAR(face::skin_shown_cm2(*skin, scan), area_cm2, 0.15 * area_cm2) << "the scan itself";
  voxel::HapticVolume felt;
  felt.voxels = std::get<grid::Grid<std::int16_t>>(head<std::int16_t>(0, 1255, 1255, 0));
  EXPECT_NEAR(face::skin_shown_cm2(*skin, felt), area_cm2, 0.15 * area_cm2);
  felt.voxels = std::get<grid::Grid<std::int16_t>>(head<std::int16_t>(0, 0, 2255, 0));
  EXPECT_EQ(face::skin_shown_cm2(*skin, felt), 0) << "bone alone";
}

}  // namespace
}  // namespace trephine
