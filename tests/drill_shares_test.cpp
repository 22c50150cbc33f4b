// SPDX-License-Identifier: GPL-3.0-or-later
// What a voxel is to a shape is asked in three ways, of which two are quick: they all say the same.
#include <gtest/gtest.h>

#include <random>

#include "drill/live_surface.h"
#include "voxel/raw_voxel.h"

using namespace trephine;

namespace {

// Raw values of all kinds, also such as no shape has, and EMPTY so often that some voxels are beside nothing.
std::int16_t any_raw(std::mt19937& random) {
  switch (random() % 8) {
    case 0:
      return std::int16_t(random());
    case 1:
      return voxel::detail::join(1 + int(random() % voxel::haptic_max_shapes), 1 + int(random() % voxel::haptic_full),
                                 random() & 1);
    case 2:
      return voxel::detail::join(1 + int(random() % 3), 1 + int(random() % voxel::haptic_full), false);
    case 3:
      return voxel::detail::join(1 + int(random() % 3), voxel::haptic_full, false);
    default:
      return voxel::haptic_empty;
  }
}

}  // namespace

TEST(Shares, TheQuickWaysSayWhatTheSlowOneDoes) {
  std::mt19937 random(3);
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::occupancy;
  v.voxels.size = {41, 37, 29};
  v.voxels.voxels.resize(v.voxels.count());
  int beside = 0, alone = 0, asked = 0;
  for (int round = 0; round < 4; ++round) {
    const bool sparse = round % 2;
    for (std::int16_t& raw : v.voxels.voxels) raw = sparse && random() % 10 ? voxel::haptic_empty : any_raw(random);
    for (const int number : {1, 2, 3, 17}) {
      const drill::ShadowVolume shadow(v, number);
      for (int k = 0; k < v.voxels.size[2]; ++k)
        for (int j = 0; j < v.voxels.size[1]; ++j)
          for (int i = 0; i < v.voxels.size[0]; ++i) {
            const int other = voxel::detail::other_shape(v.voxels, number, i, j, k);
            ASSERT_EQ(voxel::detail::beside_other_shape(v.voxels, number, i, j, k), other != 0);
            ++(other != 0 ? beside : alone);
            const int share = voxel::detail::share_of(v.voxels, number, i, j, k);
            ASSERT_EQ(int(shadow.data()[shadow.index(i, j, k)]), 257 * share) << v.voxels.at(i, j, k);
            const int own = voxel::detail::split(v.voxels.at(i, j, k)).number;
            asked += share > 0 && own != number;
          }
    }
  }
  EXPECT_GT(beside, 10000);
  EXPECT_GT(alone, 10000);
  EXPECT_GT(asked, 100) << "shared voxels, whose neighbours say whose the rest is";
}
