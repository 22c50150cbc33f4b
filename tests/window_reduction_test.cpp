// SPDX-License-Identifier: GPL-3.0-or-later
// What a window leaves out to be quick enough, and what it says of that.
#include "window/reduction.h"

#include <gtest/gtest.h>

using namespace trephine;

namespace {

// So many pictures of that time; returns how often another step began.
int pictures(window::Reduction& r, double ms, int count) {
  int changes = 0;
  for (int n = 0; n < count; ++n) changes += r.look(ms);
  return changes;
}

}  // namespace

TEST(Reduction, StepsAreTakenInTheirOrderAndTold) {
  window::Reduction r(100, {}, 40, false);
  EXPECT_EQ(r.level(), 0);
  EXPECT_EQ(r.text(texts::Language::english), "");
  EXPECT_EQ(pictures(r, 300, 8), 1);
  EXPECT_FALSE(r.view().occlusion);
  EXPECT_TRUE(r.view().shadow) << "it tells the depth: it goes last";
  EXPECT_EQ(r.text(texts::Language::english), "no darkening of creases, rough edges");
  EXPECT_EQ(r.text(texts::Language::german), "ohne Abdunkeln von Falten, raue Kanten");
  EXPECT_EQ(pictures(r, 300, 8), 1);
  EXPECT_FALSE(r.view().grain);
  EXPECT_EQ(r.coarse().within_mm, 0);
  EXPECT_EQ(pictures(r, 300, 8), 1);
  EXPECT_EQ(r.coarse().within_mm, 2.5) << "three times too long: the largest triangles at once";
  EXPECT_NE(r.text(texts::Language::english).find("coarse surfaces (2.5 mm) beyond 40 mm of the tool"),
            std::string::npos);
  EXPECT_EQ(r.scale(), 1);
  EXPECT_EQ(pictures(r, 300, 800), 1) << "there is no further step";
  EXPECT_EQ(r.scale(), 0.5);
  EXPECT_FALSE(r.view().shadow);
  EXPECT_NE(r.text(texts::Language::english).find("half the pixels"), std::string::npos);
}

TEST(Reduction, AMachineThatIsQuickEnoughKeepsAll) {
  window::Reduction r(100, {}, 40, false);
  EXPECT_EQ(pictures(r, 99, 1000), 0);
  window::Reduction never(0, {}, 40, true);
  EXPECT_EQ(pictures(never, 1e4, 1000), 0);
  EXPECT_EQ(never.level(), 0);
}

// One slow picture of eight is none; where all are quick a step is taken back, but not to and fro for ever.
TEST(Reduction, ItDoesNotSway) {
  window::Reduction r(100, {}, 40, true);
  EXPECT_EQ(r.level(), 1) << "the processor draws";
  for (int n = 0; n < 20; ++n) {
    r.look(900);
    EXPECT_EQ(pictures(r, 60, 7), 0);
  }
  EXPECT_EQ(pictures(r, 20, 40), 1);
  EXPECT_EQ(r.level(), 0);
  int changes = 0;
  for (int n = 0; n < 50; ++n) changes += pictures(r, 300, 8) + pictures(r, 20, 40);
  EXPECT_LE(changes, 6);
}

// How much too long pictures take says how large triangles become; if that does not do, they become larger.
TEST(Reduction, ItTakesTheFinestTrianglesThatDo) {
  window::Reduction r(100, {}, 40, false);
  pictures(r, 110, 16);
  EXPECT_EQ(r.coarse().within_mm, 0);
  for (const double mm : {0.5, 1.0, 1.5}) {
    EXPECT_EQ(pictures(r, 110, 8), 1);
    EXPECT_EQ(r.coarse().within_mm, mm);
    EXPECT_EQ(r.level(), 3);
    EXPECT_EQ(pictures(r, 90, 80), 0) << "it does";
  }
  EXPECT_EQ(r.text(texts::Language::german),
            "ohne Abdunkeln von Falten, raue Kanten, ohne Körnung, grobe Flächen (1.5 mm) weiter als 40 mm vom "
            "Instrument");
  window::Reduction slower(100, {}, 40, false);
  pictures(slower, 140, 24);
  EXPECT_EQ(slower.coarse().within_mm, 1);
  pictures(slower, 180, 8);
  EXPECT_EQ(slower.coarse().within_mm, 1.5);
  EXPECT_EQ(pictures(slower, 20, 40), 1);
  EXPECT_EQ(slower.coarse().within_mm, 1) << "much quicker than need be: one size back";
  EXPECT_EQ(slower.level(), 3);
}

TEST(Reduction, ASizeThatIsGivenIsTheOnlyOne) {
  scene::ViewParams whole;
  whole.coarse_mm = 1.2;
  window::Reduction r(100, whole, 40, false);
  pictures(r, 300, 16);
  EXPECT_EQ(r.coarse().within_mm, 0);
  pictures(r, 300, 8);
  EXPECT_EQ(r.coarse().within_mm, 1.2);
  EXPECT_EQ(r.level(), 3);
  pictures(r, 300, 8);
  EXPECT_EQ(r.level(), 4);
  EXPECT_EQ(r.coarse().within_mm, 1.2);
}

TEST(Reduction, AProcessorThatDrawsLeavesHalfOfItsCores) {
  EXPECT_EQ(window::software_cost_ms(80, 120, 2), 120);
  EXPECT_EQ(window::software_cost_ms(80, 120, 16), 80);
  EXPECT_EQ(window::software_cost_ms(80, 1200, 16), 150);
  EXPECT_EQ(window::software_cost_ms(80, 120, 1), 120) << "one core draws, too";
  EXPECT_EQ(window::software_cost_ms(80, 120, 0), 120) << "nobody knows how many there are";
}
