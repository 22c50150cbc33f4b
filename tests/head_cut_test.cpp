// SPDX-License-Identifier: GPL-3.0-or-later
// Heads that the field of view cuts: what is said of brain and dura, and what is no cavity any more.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "base/pi.h"
#include "head/head_region.h"
#include "mask/hu_view.h"
#include "phantom/head.h"
#include "phantom/phantom.h"
#include "place/cranium.h"
#include "place/zones.h"

namespace trephine {
namespace {

const grid::HuVolume& whole() {
  static const grid::HuVolume volume = [] {
    phantom::HeadParams who;
    who.level = phantom::Level::clinical;
    who.seed = 11;
    phantom::ScanParams how;
    how.columns_count = how.rows_count = 112;
    how.pixel_mm = 2;
    how.slices_count = 60;
    how.slice_step_mm = how.slice_thickness_mm = 3;
    how.subvoxel_mm = 2;
    how.noise_hu = 6;
    return phantom::volume_of(phantom::scan(phantom::Head(who), how));
  }();
  return volume;
}

/// The field is cut off beyond that column, the patient's left, or row, the back.
grid::HuVolume cut_at(int column, int axis = 0) {
  return std::visit(
      [&](const auto& g) {
        grid::Box box = grid::whole_box(g);
        box.end[axis] = column;
        return grid::HuVolume(grid::crop(g, box));
      },
      whole());
}

std::map<std::string, std::string> cuts_of(const grid::HuVolume& volume) {
  const auto cut = head::head_region(volume, {}).result.cut;
  return {cut.begin(), cut.end()};
}

}  // namespace

TEST(HeadCut, ACavityThatNothingClosesAtTheFieldsEdgeIsCutThere) {
  using Cuts = std::map<std::string, std::string>;
  EXPECT_EQ(cuts_of(whole()), Cuts{});
  const std::string left = "on its left side";
  const Cuts deep{{"skin", left}, {"skull", left}, {"brain", left}, {"dura", left}};
  EXPECT_EQ(cuts_of(cut_at(82)), deep);
  EXPECT_EQ(cuts_of(cut_at(68)), deep);
  const std::string back = "on its back side";
  EXPECT_EQ(cuts_of(cut_at(82, 1)), (Cuts{{"skin", back},
                                          {"skull", back},
                                          {"brain", back},
                                          {"dura", back},
                                          {"midline", back},
                                          {"sagittal_sinus", back}}));
  EXPECT_EQ(cuts_of(cut_at(93)), (Cuts{{"skin", left}})) << "the scalp alone";
}

TEST(HeadCut, SlicesAtAWrongDistanceMakeAHeadOfUnusualProportions) {
  const auto warned = [](double slices) {
    grid::HuVolume volume = whole();
    std::visit([&](auto& g) { g.spacing_mm.z *= slices; }, volume);
    for (const Warning& w : head::head_region(volume, {}).warnings)
      if (w.id == "unusual_proportions") return true;
    return false;
  };
  EXPECT_FALSE(warned(1));
  EXPECT_FALSE(warned(1.1));
  EXPECT_TRUE(warned(0.6));
  EXPECT_TRUE(warned(1.7));
}

TEST(HeadCut, RowsOrColumnsAtAWrongDistanceMakeOneToo) {
  const auto warned = [](int axis, double stretch) {
    grid::HuVolume volume = whole();
    std::visit([&](auto& g) { g.spacing_mm[axis] *= stretch; }, volume);
    int count = 0;
    for (const Warning& w : head::head_region(volume, {}).warnings) count += w.id == "unusual_proportions";
    return count;
  };
  EXPECT_EQ(warned(0, 0.95), 0);
  EXPECT_EQ(warned(1, 0.95), 0);
  EXPECT_EQ(warned(0, 0.7), 1) << "columns";
  EXPECT_EQ(warned(1, 0.7), 1) << "rows";
}

TEST(HeadCut, AHeadThatIsTurnedOnTheCouchHasItsProportions) {
  grid::HuVolume volume = whole();
  const double turn = 50 * pi / 180;
  std::visit(
      [&](auto& g) {
        g.direction.column[0] = {std::cos(turn), std::sin(turn), 0};
        g.direction.column[1] = {-std::sin(turn), std::cos(turn), 0};
      },
      volume);
  const auto region = head::head_region(volume, {});
  EXPECT_NEAR(*region.result.cavity_length_ratio, *head::head_region(whole(), {}).result.cavity_length_ratio, 0.02);
}

TEST(HeadCut, HalfAHeadHasNoZones) {
  const grid::HuVolume half = cut_at(60);
  const auto cavity = place::cranial_cavity(place::bone_of(mask::HuView(half)), {});
  place::ZoneParams dura;
  dura.what = place::Zone::dura;
  try {
    place::find_zone(cavity.value, {}, dura);
    FAIL() << cavity.result.cranial_cavity_ml;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("the smallest whole cranial cavity"), std::string::npos) << e.what();
  }
}

}  // namespace trephine
