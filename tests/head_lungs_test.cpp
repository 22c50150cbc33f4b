// SPDX-License-Identifier: GPL-3.0-or-later
// Bone that encloses air is a chest's, or an empty skull's: no brain is looked for in it.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "head/brain.h"
#include "mask/hu_view.h"
#include "place/cranium.h"
#include "place/lungs.h"
#include "report_of.h"

using namespace trephine;

namespace {

// A shell of bone that holds tissue, and air where z lies above `air_from_mm`.
grid::HuVolume shell(double air_from_mm) {
  grid::Grid<std::int16_t> g(grid::Lattice{{64, 64, 64}, {3, 3, 3}, {-96, -96, -96}, {}});
  for (int k = 0; k < 64; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i) {
        const Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
        const double r = norm(p);
        g.at(i, j, k) = std::int16_t(r > 84 ? -1000 : r > 76 ? 1100 : p.z > air_from_mm ? -800 : 35);
      }
  return g;
}

std::string refused(double air_from_mm) {
  const grid::HuVolume scan = shell(air_from_mm);
  const mask::HuView hu(scan);
  Report report;
  try {
    place::require_no_lungs(value_of(report, place::cranial_cavity(place::bone_of(hu), {})), hu);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    return e.what();
  }
  return "";
}

}  // namespace

TEST(Lungs, ABonyCaseFullOfAirIsNoHead) {
  EXPECT_NE(refused(-20).find("of the space that bone encloses is air, as in a chest"), std::string::npos);
  EXPECT_NE(refused(-90).find("100 %"), std::string::npos);  // a dry skull
  EXPECT_EQ(refused(45), "");                                // a tenth, ten times what a head has after an operation
  EXPECT_EQ(refused(90), "");
}

TEST(Lungs, NoBrainIsLookedForBesideThem) {
  try {
    head::find_brain(shell(-20), {}, {});
    FAIL() << "a brain in a chest";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("as in a chest"), std::string::npos) << e.what();
  }
}
