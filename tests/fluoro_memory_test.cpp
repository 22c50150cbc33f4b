// SPDX-License-Identifier: GPL-3.0-or-later
// Which places of a C-arm are remembered.
#include <gtest/gtest.h>

#include "fluoro/fluoro_memory.h"

using namespace trephine;

namespace {

fluoro::CArmParams at(double orbit_deg) {
  fluoro::CArmParams arm;
  arm.view = fluoro::CArmParams::View::free;
  arm.orbit_deg = orbit_deg;
  return arm;
}

fluoro::KeptFluoro picture(double orbit_deg, int size = 16) {
  return {at(orbit_deg), {size, std::vector<float>(std::size_t(size) * std::size_t(size), float(orbit_deg))}, 1};
}

}  // namespace

// A swing of the arm to a side in steps of 5 degrees, and back, is one of 31 places: all of them are there at once. The
// bytes of 512 x 512 pixels for each are within the bound too.
TEST(FluoroMemory, ASwingToASideAndBackIsRemembered) {
  fluoro::FluoroMemory memory;
  for (int deg = -75; deg <= 75; deg += 5) memory.keep(picture(deg));
  for (int deg = 75; deg >= -75; deg -= 5) {
    const fluoro::KeptFluoro* kept = memory.find(at(deg), 16);
    ASSERT_TRUE(kept) << deg;
    EXPECT_EQ(kept->integrals.integral[0], float(deg));
  }
  EXPECT_FALSE(memory.find(at(2), 16));
  EXPECT_FALSE(memory.find(at(5), 32));
  fluoro::FluoroMemory large;
  for (int n = 0; n < 32; ++n) large.keep(picture(n, 512));
  EXPECT_EQ(large.places(), 32u);
  EXPECT_EQ(large.bytes(), std::size_t{32} << 20);
}

TEST(FluoroMemory, WhatWasAskedForLongestAgoGoesFirst) {
  fluoro::FluoroMemory memory(3, 1 << 20);
  for (const int deg : {0, 10, 20}) memory.keep(picture(deg));
  ASSERT_TRUE(memory.find(at(0), 16)) << "asked for again: 10 is the oldest now";
  memory.keep(picture(30));
  EXPECT_EQ(memory.places(), 3u);
  EXPECT_FALSE(memory.find(at(10), 16));
  for (const int deg : {0, 20, 30}) EXPECT_TRUE(memory.find(at(deg), 16)) << deg;
}

TEST(FluoroMemory, ItsBytesAreBounded) {
  constexpr std::size_t bytes = 16 * 16 * sizeof(float);
  fluoro::FluoroMemory memory(100, 5 * bytes);
  for (int deg = 0; deg < 40; ++deg) {
    memory.keep(picture(deg));
    ASSERT_LE(memory.bytes(), 5 * bytes);
  }
  EXPECT_EQ(memory.places(), 5u);
  EXPECT_TRUE(memory.find(at(35), 16));
  memory.keep(picture(50, 64));
  EXPECT_EQ(memory.places(), 1u) << "the newest stays, however large";
  EXPECT_TRUE(memory.find(at(50), 64));
}

TEST(FluoroMemory, TheWholePictureTakesThePlaceOfTheCoarseOne) {
  fluoro::FluoroMemory memory(3, 1 << 20);
  memory.keep(picture(0, 8));
  memory.keep(picture(0, 16));
  EXPECT_EQ(memory.places(), 1u);
  EXPECT_FALSE(memory.find(at(0), 8));
  EXPECT_TRUE(memory.find(at(0), 16));
}
