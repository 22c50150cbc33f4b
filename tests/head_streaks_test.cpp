// SPDX-License-Identifier: GPL-3.0-or-later
// Straight streaks across whole slices, as a head holder or fillings leave them in a few slices of a scan.
#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "base/pi.h"
#include "head/ventricle_parts.h"
#include "mask/streaks.h"

namespace trephine::segmentation {
namespace {

constexpr double turn = 20 * pi / 180;

/// Across the streaks, and along them.
double across(Vec3 p) { return p.y * std::cos(turn) - p.x * std::sin(turn); }
double along(Vec3 p) { return p.x * std::cos(turn) + p.y * std::sin(turn); }
/// Dark and bright lines of unequal distance.
double streak_hu(Vec3 p) { return 16 * std::sin(across(p) / 4.0 + std::sin(across(p) / 17.0)); }

/// Tissue of 30 HU with noise, a dark fissure of 70 mm, and a horn of 20 mm that lies along the streaks.
struct Scene {
  grid::Lattice lattice;
  mask::BitMask known;
  grid::Grid<float> sound;
  static bool in_horn(Vec3 p) { return std::abs(across(p) + 20) < 3 && std::abs(along(p) - 10) < 10; }

  Scene() {
    lattice.size = {130, 150, 5};
    lattice.spacing_mm = {1, 1, 3};
    lattice.origin_mm = {-64.5, -74.5, 0};
    known = mask::make_mask(lattice, [&](int j, int, std::uint8_t* row) {
      for (int i = 0; i < lattice.size[0]; ++i) row[i] = std::hypot((i - 64.5) / 60, (j - 74.5) / 70) < 1;
    });
    sound = grid::Grid<float>(lattice, 30.f);
    std::uint32_t state = 1;
    for (int k = 0; k < lattice.size[2]; ++k)
      for (int j = 0; j < lattice.size[1]; ++j)
        for (int i = 0; i < lattice.size[0]; ++i) {
          const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)});
          float& v = sound.at(i, j, k);
          if (in_horn(p) || (std::abs(p.x) < 1.2 && p.y < 0)) v = 8;
          for (int n = 0; n < 4; ++n)
            v += 5 * (float((state = state * 1664525u + 1013904223u) >> 8) / 16777216.f - 0.5f) / std::sqrt(4.f / 12);
        }
  }
  grid::Grid<float> streaked() const {
    grid::Grid<float> out = sound;
    for (const int k : {1, 2})
      for (int j = 0; j < lattice.size[1]; ++j)
        for (int i = 0; i < lattice.size[0]; ++i)
          out.at(i, j, k) += float(streak_hu(lattice.to_world_mm({double(i), double(j), double(k)})));
    return out;
  }
  /// The RMS of the difference from the sound slice, over known voxels.
  double off_hu(const grid::Grid<float>& g, int k) const {
    double sum = 0;
    int count = 0;
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i) {
        if (!known.get(i, j, k)) continue;
        sum += (g.at(i, j, k) - sound.at(i, j, k)) * (g.at(i, j, k) - sound.at(i, j, k));
        ++count;
      }
    return std::sqrt(sum / count);
  }
  double horn_hu(const grid::Grid<float>& g, int k) const {
    double sum = 0;
    int count = 0;
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i)
        if (in_horn(lattice.to_world_mm({double(i), double(j), double(k)}))) sum += g.at(i, j, k), ++count;
    return sum / count;
  }
};

}  // namespace

TEST(Streaks, AreTakenOffTheirSlicesAndAHornStays) {
  const Scene s;
  grid::Grid<float> hu = s.streaked();
  const auto found = mask::remove_streaks(hu, s.known);
  ASSERT_EQ(found.size(), 2u);
  for (int n = 0; n < 2; ++n) {
    const int k = 1 + n;
    EXPECT_EQ(found[n].slice, k);
    EXPECT_GT(found[n].rms_hu, 6);
    EXPECT_GT(s.off_hu(s.streaked(), k), 10);
    EXPECT_LT(s.off_hu(hu, k), 4.5);
    EXPECT_LT(s.horn_hu(hu, k), 14) << "of 8 HU in tissue of 30";
  }
  for (const int k : {0, 3, 4}) EXPECT_EQ(s.off_hu(hu, k), 0) << k;
}

TEST(Streaks, AFissureAndAHornAreNone) {
  const Scene s;
  grid::Grid<float> hu = s.sound;
  EXPECT_TRUE(mask::remove_streaks(hu, s.known).empty());
  EXPECT_EQ(hu.voxels, s.sound.voxels);
}

TEST(Streaks, TheSameBitsWhateverTheThreads) {
  const Scene s;
  grid::Grid<float> one = s.streaked(), four = one;
  const int before = thread_count();
  set_thread_count(1);
  mask::remove_streaks(one, s.known);
  set_thread_count(4);
  mask::remove_streaks(four, s.known);
  set_thread_count(before);
  EXPECT_EQ(one.voxels, four.voxels);
}

TEST(Streaks, AreSaidWhereVentriclesLieInThem) {
  const Scene s;
  mask::BitMask high(s.lattice), low(s.lattice);
  high.set(60, 60, 4);
  low.set(60, 60, 1);
  EXPECT_FALSE(head::warn_of_streaks({{1, 7}, {2, 9.4}}, s.lattice, high));
  const auto said = head::warn_of_streaks({{1, 7}, {2, 9.4}}, s.lattice, low);
  ASSERT_TRUE(said);
  EXPECT_NE(to_text(*said).find("streaks of 9 HU cross the slices at z 3 to 6 mm"), std::string::npos)
      << to_text(*said);
}

}  // namespace trephine::segmentation
