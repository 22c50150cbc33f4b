// SPDX-License-Identifier: GPL-3.0-or-later
// Apparatus around the analytic head is taken off, and the head stays as it was scanned.
#include "body/body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "head/head_region.h"
#include "head_recipe.h"
#include "mask/field_edge.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "phantom_heads.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

using Volume = grid::Grid<std::int16_t>;

const Volume& head() {
  static const Volume v = [] {
    phantom::ScanParams how = phantom_heads::scan_of(220, 140, 8, 140 * 1.5, 264);
    how.table = false;
    how.subvoxel_mm = 1;
    return phantom::volume_of(phantom::scan(phantom_heads::head_of(phantom::Level::clinical, 5), how));
  }();
  return v;
}

grid::Field skin_of(const grid::HuVolume& volume) {
  return grid::fit(segmentation::segment(volume, {}, head_recipe::skin()).value, grid::lattice_of(volume), -1000.f);
}

const grid::Grid<float>& inside_mm() {
  static const grid::Grid<float> d = mask::signed_distance_mm(skin_of(head()));
  return d;
}

double figure(const Report& r, const char* name) { return std::get<double>(*r.find(name)); }

/// HU of the apparatus at a voxel, or nothing (-1e6).
using Apparatus = std::function<double(Vec3 place_mm, double outside_mm)>;

/// The head with apparatus in the air around it.
Volume with(const Apparatus& apparatus) {
  Volume v = head();
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i) {
        const double outside = -inside_mm().at(i, j, k);
        if (outside < 0.3) continue;
        const double hu = apparatus(v.to_world_mm(Vec3{double(i), double(j), double(k)}), outside);
        if (hu > v.at(i, j, k)) v.at(i, j, k) = std::int16_t(hu);
      }
  return v;
}

/// A perforated sheet that lies two to three millimetres off the skin.
double mask(Vec3 p, double outside_mm) {
  const double gap = 2.6 + 0.5 * std::sin(p.x / 15) * std::sin(p.z / 17);
  const bool hole = std::sin(p.x) * std::sin(p.z * 0.9) + 0.3 * std::sin(p.y) > 0.55;
  return !hole && outside_mm > gap && outside_mm < gap + 1.9 ? -120 : -1e6;
}
double couch(Vec3 p, double) {
  const double back = 120;
  if (p.y > back - 6 && p.y < back - 2) return 60;
  return p.y >= back - 2 && p.y < back + 4 ? -850 : -1e6;
}
/// A block of foam beside the head, and a clamp of metal.
double holder(Vec3 p, double outside_mm) {
  if (std::abs(p.z) < 25 && p.x > 60 && outside_mm > 2.2 && p.y > -20 && p.y < 60) return -150;
  return p.x < 0 && std::hypot(p.y - 10, p.z + 5) < 5 && outside_mm > 1 ? 2500 : -1e6;
}

struct Compared {
  double apparatus_ml = 0;  ///< of the new skin farther than a millimetre outside of the true one
  double lost_ml = 0;       ///< of the true skin, deeper than a millimetre, that the new one lacks
  double mean_mm = 0;       ///< mean distance of the two skins
};

Compared compare(const grid::HuVolume& cleaned) {
  const grid::Field after = skin_of(cleaned);
  const grid::Grid<float> new_mm = mask::signed_distance_mm(after);
  Compared c;
  double sum = 0, count = 0;
  const double ml = after.voxel_volume_mm3() / 1000;
  for (std::size_t v = 0; v < after.count(); ++v) {
    const float truth = inside_mm().voxels[v];
    if (after.voxels[v] > 0 && truth < -1) c.apparatus_ml += ml;
    if (after.voxels[v] <= 0 && truth > 1) c.lost_ml += ml;
    if (std::abs(truth) < 0.6) {
      sum += std::abs(new_mm.voxels[v] - truth);
      ++count;
    }
  }
  c.mean_mm = sum / count;
  return c;
}

TEST(Body, AHeadWithoutApparatusStaysAsItIs) {
  Report report;
  EXPECT_TRUE(std::get<Volume>(value_of(report, body::keep_body(head(), {}))) == head());
  EXPECT_LT(figure(report, "apparatus_ml"), 0.5);
}

TEST(LongBody, AMaskOnTheSkinGoesAndTheSkinStays) {
  Report report;
  const grid::HuVolume out = value_of(report, body::keep_body(with(mask), {}));
  EXPECT_GT(figure(report, "apparatus_ml"), 60);
  EXPECT_GT(figure(report, "thin_apparatus_ml"), 60);
  const Compared c = compare(out);
  EXPECT_LT(c.apparatus_ml, 1);
  EXPECT_LT(c.lost_ml, 1);  // ears and nose are kept
  EXPECT_LT(c.mean_mm, 0.1);
}

/// The same sheet pressed onto the skin, as dense as it: no gap tells it from the skin.
double pressed_mask(Vec3 p, double outside_mm) {
  const bool hole = std::sin(p.x) * std::sin(p.z * 0.9) + 0.3 * std::sin(p.y) > 0.25;
  const bool pressed = std::sin(p.x / 19) * std::sin(p.z / 17) > -0.6;  // it lifts off here and there
  const double from = pressed ? 0 : 2.6;
  return !hole && p.y < 60 && outside_mm > from && outside_mm < from + 1.9 ? 30 : -1e6;
}

TEST(LongBody, StrandsPressedOntoTheSkinGo) {
  const Volume scan = with(pressed_mask);
  body::BodyParams keep_strands;
  keep_strands.strand_mm = 0;
  Report report, before;
  const Compared c = compare(value_of(report, body::keep_body(scan, {}))),
                 was = compare(value_of(before, body::keep_body(scan, keep_strands)));
  EXPECT_GT(figure(report, "strands_on_skin_ml"), 10);
  EXPECT_FALSE(before.find("strands_on_skin_ml"));
  EXPECT_GT(was.mean_mm, 0.3);
  EXPECT_LT(c.mean_mm, 0.15);
  EXPECT_LT(c.apparatus_ml, 0.3 * was.apparatus_ml);
  EXPECT_LT(c.lost_ml, 1);  // ears and nose are kept
}

TEST(Body, BoneThatReachesTheSkinIsNoStrand) {
  // A pin of bone from the skull through the skin, 1.5 mm above it: where metal has streaked a scan it looks so.
  Volume scan = with(pressed_mask);
  std::vector<std::size_t> pin;
  for (int k = 0; k < scan.size[2]; ++k)
    for (int j = 0; j < scan.size[1]; ++j)
      for (int i = 0; i < scan.size[0]; ++i) {
        const Vec3 p = scan.to_world_mm(Vec3{double(i), double(j), double(k)});
        const double inside = inside_mm().at(i, j, k);
        if (p.x > 40 && std::hypot(p.y, p.z - 40) < 3 && inside > -1.5 && inside < 14)
          pin.push_back(scan.index(i, j, k));
      }
  ASSERT_GT(pin.size(), 50u);
  for (const std::size_t v : pin) scan.voxels[v] = 900;
  Report report;
  const Volume out = std::get<Volume>(value_of(report, body::keep_body(scan, {})));
  ASSERT_TRUE(report.find("strands_on_skin_ml"));
  for (const std::size_t v : pin) EXPECT_EQ(out.voxels[v], 900);
}

TEST(LongBody, ASheetWithoutHolesIsNotTakenForAMask) {
  const auto sheet = [](Vec3 p, double outside_mm) {
    return p.y < 60 && outside_mm > 2.6 && outside_mm < 4.5 ? 30 : -1e6;
  };
  Report report;
  const Compared c = compare(value_of(report, body::keep_body(with(sheet), {})));
  EXPECT_FALSE(report.find("strands_on_skin_ml"));
  EXPECT_LT(c.lost_ml, 1);
}

TEST(Body, CouchHolderAndClampGoTogetherWithAMask) {
  const grid::HuVolume out = body::keep_body(with([](Vec3 p, double d) {
                                               return std::max({mask(p, d), couch(p, d), holder(p, d)});
                                             }),
                                             {})
                                 .value;
  const Compared c = compare(out);
  EXPECT_LT(c.apparatus_ml, 6);  // where the block lies on the skin
  EXPECT_LT(c.lost_ml, 3);
  EXPECT_LT(c.mean_mm, 0.15);
}

// Side plates of a head holder, small and near as ears are, but dense: the ears that lean on them stay.
TEST(Body, DensePlatesThatTheEarsTouchGo) {
  const Volume& v = head();
  double left = 0, right = 0;
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i)
        if (inside_mm().at(i, j, k) > 0) {
          const double x = v.to_world_mm(Vec3{double(i), double(j), double(k)}).x;
          left = std::max(left, x);
          right = std::min(right, x);
        }
  const auto plates = [&](Vec3 p, double) {
    const bool beside = std::min(std::abs(p.x - left - 1), std::abs(p.x - right + 1)) < 1.8;
    return beside && std::abs(p.y - 30) < 55 && std::abs(p.z) < 40 ? 330 : -1e6;
  };
  Report report;
  const grid::HuVolume out = value_of(report, body::keep_body(with(plates), {}));
  EXPECT_GT(figure(report, "apparatus_ml"), 50);  // two plates of 3.6 x 110 x 80 mm hold 63 ml
  const Compared c = compare(out);
  EXPECT_LT(c.apparatus_ml, 2);  // an ear's edge on the plate
  EXPECT_LT(c.lost_ml, 1);
  EXPECT_LT(c.mean_mm, 0.1);
}

TEST(Body, ABoardThatTouchesTheHeadOverAWidePlaceGoes) {
  // The head is pressed into it by 4 mm, over a place of some 50 mm.
  const Volume& v = head();
  double back = -1e6;
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      for (int i = 0; i < v.size[0]; ++i)
        if (inside_mm().at(i, j, k) > 0) back = std::max(back, v.to_world_mm(Vec3{double(i), double(j), double(k)}).y);
  Report report;
  const grid::HuVolume out = value_of(
      report,
      body::keep_body(with([&](Vec3 p, double) { return p.y > back - 4 && p.y < back + 18 ? -40 : -1e6; }), {}));
  EXPECT_GT(figure(report, "apparatus_ml"), 1000);
  EXPECT_GT(figure(report, "board_thickness_mm"), 15);
  EXPECT_FALSE(mask::field_edge(mask::HuView(out)).tissue.any());  // where it was, the scan does not end
  const Compared c = compare(out);
  EXPECT_LT(c.apparatus_ml, 2);
  EXPECT_LT(c.lost_ml, 2);
  EXPECT_LT(c.mean_mm, 0.1);
}

TEST(LongBody, BoardsAreSoughtOnFineVoxelsToo) {
  Volume fine;
  fine.size = {460, 420, 300};
  fine.spacing_mm = {0.25, 0.25, 0.25};
  fine.voxels.assign(fine.count(), -1000);
  for (int k = 0; k < fine.size[2]; ++k)
    for (int j = 0; j < fine.size[1]; ++j)
      for (int i = 0; i < fine.size[0]; ++i)
        if (j > 380 || std::hypot(i - 230.0, j - 210.0) < 150) fine.at(i, j, k) = 40;
  Report report;
  value_of(report, body::keep_body(fine, {}));
  EXPECT_NEAR(figure(report, "board_thickness_mm"), 9.75, 0.3);
}

TEST(Body, ABoardThatATiltedGantryCutsAslantGoes) {
  // Slices tilted by 15 degrees; a cylinder of tissue along the table lies on a board, over a place of 40 mm.
  for (const double deg : {-15.0, 15.0}) {
    Volume v;
    v.size = {130, 150, 40};
    v.spacing_mm = {2, 2, 5};
    const double c = std::cos(deg * pi / 180), s = std::sin(deg * pi / 180);
    v.direction.column[1] = {0, c, s};
    v.direction.column[2] = {0, -s, c};
    v.origin_mm = v.direction * Vec3{-130, -150, -100};
    v.voxels.assign(v.count(), -1000);
    const auto is_board = [](Vec3 p) { return p.y > 77 && p.y < 95; };
    const auto each = [&](const auto& visit) {
      for (int k = 0; k < v.size[2]; ++k)
        for (int j = 0; j < v.size[1]; ++j)
          for (int i = 0; i < v.size[0]; ++i) visit(i, j, k, v.to_world_mm({double(i), double(j), double(k)}));
    };
    each([&](int i, int j, int k, Vec3 p) {
      if (is_board(p) || std::hypot(p.x, p.y) < 80) v.at(i, j, k) = 40;
    });
    Report report;
    const auto out = std::get<Volume>(value_of(report, body::keep_body(v, {})));
    double left = 0, lost = 0;
    each([&](int i, int j, int k, Vec3 p) {
      if (std::hypot(p.x, p.y) > 84 && out.at(i, j, k) > -300) left += 0.02;
      if (std::hypot(p.x, p.y) < 76 && out.at(i, j, k) < 0) lost += 0.02;
    });
    EXPECT_NEAR(figure(report, "board_thickness_mm"), 18, 2.1) << deg;
    EXPECT_LT(left, 5) << deg;
    EXPECT_LT(lost, 5) << deg;
  }
}

TEST(Body, AVolumeWithoutABodyStaysAndIsSaid) {
  Volume air(head(), std::int16_t(-1000));
  air.at(5, 5, 5) = 40;
  Report report;
  EXPECT_TRUE(std::get<Volume>(value_of(report, body::keep_body(air, {}))) == air);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("no body was found"), std::string::npos);
}

TEST(Body, TheSameBytesWithOneAndFourThreads) {
  const Volume scan = with(mask);
  Report one, four;
  set_thread_count(1);
  const grid::HuVolume a = value_of(one, body::keep_body(scan, {}));
  set_thread_count(4);
  const grid::HuVolume b = value_of(four, body::keep_body(scan, {}));
  set_thread_count(0);
  EXPECT_TRUE(std::get<Volume>(a) == std::get<Volume>(b));
  EXPECT_EQ(one.figures, four.figures);
}

TEST(HeadRegion, TheHeadIsKeptAndTheAirAroundItGoes) {
  Report report;
  const grid::HuVolume out = value_of(report, head::head_region(head(), {}));
  EXPECT_TRUE(report.warnings.empty()) << report.warnings[0];
  EXPECT_EQ(report.find("skin_cut"), nullptr);
  const grid::Lattice& l = grid::lattice_of(out);
  const grid::Field after = skin_of(out), before = skin_of(head());
  EXPECT_LT(l.count(), head().count());
  const grid::Box at = grid::place_in(l, head());
  std::size_t beyond = 0;
  for (int k = at.begin[2]; k < head().size[2]; ++k)
    for (int j = 0; j < head().size[1]; ++j)
      for (int i = 0; i < head().size[0]; ++i)
        beyond += before.at(i, j, k) > 0 && !l.contains(i - at.begin[0], j - at.begin[1], k - at.begin[2]);
  EXPECT_EQ(beyond, 0u);
}

TEST(HeadRegion, WhatTheScanDoesNotShowIsSaid) {
  grid::Box box = grid::whole_box(head());
  box.end[2] -= 40;
  box.end[0] -= 45;
  Report report;
  value_of(report, head::head_region(grid::crop(head(), box), {}));
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_NE(report.warnings[0].find("the vertex is missing"), std::string::npos) << report.warnings[0];
  EXPECT_NE(report.warnings[1].find("cuts the head on its left side"), std::string::npos) << report.warnings[1];
  const auto cut = [&](const char* name) {
    const ParameterValue* where = report.find(name);
    return where ? std::get<std::string>(*where) : "";
  };
  EXPECT_EQ(cut("skin_cut"), "above and on its left side");
  EXPECT_EQ(cut("brain_cut").substr(0, 5), "above");
  EXPECT_EQ(cut("brainstem_cut"), "");
}

TEST(HeadRegion, PaddingThatCutsTheHeadIsSaid) {
  // A round field whose middle lies 45 mm before the head's: its rim cuts the back of the head.
  Volume scan = head();
  const Vec3 middle = scan.to_world_mm({0.5 * (scan.size[0] - 1), 0.5 * (scan.size[1] - 1), 0.0});
  const double radius = 0.5 * scan.size[1] * scan.spacing_mm.y;
  std::size_t bone = 0;
  for (int k = 0; k < scan.size[2]; ++k)
    for (int j = 0; j < scan.size[1]; ++j)
      for (int i = 0; i < scan.size[0]; ++i) {
        const Vec3 p = scan.to_world_mm({double(i), double(j), double(k)});
        if (std::hypot(p.x - middle.x, p.y - middle.y + 45) < radius) continue;
        bone += scan.at(i, j, k) > 300;
        scan.at(i, j, k) = -1000;
      }
  ASSERT_GT(bone, 1000u);
  Report report;
  value_of(report, head::head_region(scan, {}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("cuts the head on its back side"), std::string::npos) << report.warnings[0];
  EXPECT_EQ(std::get<std::string>(*report.find("skin_cut")), "on its back side");
  EXPECT_EQ(std::get<std::string>(*report.find("skull_cut")), "on its back side");
}

TEST(HeadRegion, PaddingAboveIsSaidWhereverItBegins) {
  for (int less = 30; less < 34; ++less) {  // whole slices of padding, at each phase of the cells
    Volume scan = head();
    for (int k = scan.size[2] - less; k < scan.size[2]; ++k)
      for (int j = 0; j < scan.size[1]; ++j)
        for (int i = 0; i < scan.size[0]; ++i) scan.at(i, j, k) = -1000;
    Report report;
    value_of(report, head::head_region(scan, {}));
    ASSERT_NE(report.find("brain_cut"), nullptr) << less;
    EXPECT_EQ(std::get<std::string>(*report.find("skin_cut")), "above");
    EXPECT_EQ(std::get<std::string>(*report.find("sagittal_sinus_cut")), "above");
  }
}

TEST(HeadRegion, AScanThatEndsInTheScalpIsSaid) {
  int top = 0;
  for (int k = 0; k < head().size[2]; ++k)
    for (int j = 0; j < head().size[1]; ++j)
      for (int i = 0; i < head().size[0]; ++i)
        if (inside_mm().at(i, j, k) > 0) top = k;
  grid::Box box = grid::whole_box(head());
  box.end[2] = top - 2;  // 3 to 4.5 mm below the vertex
  Report report;
  value_of(report, head::head_region(grid::crop(head(), box), {}));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("the skin of the vertex is missing"), std::string::npos) << report.warnings[0];
}

TEST(HeadRegion, AScanWithoutACraniumStaysAndIsSaid) {
  const Volume water(head(), 20);
  Report report;
  EXPECT_TRUE(std::get<Volume>(value_of(report, head::head_region(water, {}))) == water);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("no cranial cavity"), std::string::npos);
}

}  // namespace
}  // namespace trephine
