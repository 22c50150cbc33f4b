// SPDX-License-Identifier: GPL-3.0-or-later
// Where the dura ends at the air of the skull's base, and the third ventricle where a bleed moved it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "phantom/head.h"
#include "phantom/phantom.h"
#include "place/brainstem.h"
#include "place/cranium.h"
#include "place/zone_doubts.h"
#include "place/zones.h"
#include "report_of.h"

namespace trephine {
namespace {

/// How a head is scanned in voxels of 1.5 x 1.5 mm.
phantom::ScanParams scan_in(int slices_count, double slice_mm) {
  phantom::ScanParams how;
  how.columns_count = how.rows_count = 150;
  how.pixel_mm = 1.5;
  how.slices_count = slices_count;
  how.slice_step_mm = how.slice_thickness_mm = slice_mm;
  how.subvoxel_mm = 1.5;
  return how;
}

/// Bone cells of the mastoid, into which the cavity leaks: 18 x 18 x 14 mm below the tentorium, beside the brain.
struct Leaking {
  grid::HuVolume volume;
  mask::BitMask cavity, box;
  Vec3 middle_mm{50, 18, 4};

  explicit Leaking(double noise_hu = 8) {
    phantom::HeadParams who;
    who.level = phantom::Level::clinical;
    who.seed = 3;
    const phantom::Head head(who);
    phantom::ScanParams how = scan_in(60, 3);
    how.noise_hu = noise_hu;
    volume = phantom::volume_of(phantom::scan(head, how));
    Report ignored;
    cavity = place::cranial_cavity(place::bone_of(mask::HuView(volume)), {}).value;
    const grid::Lattice& l = cavity.lattice();
    box = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 d = l.to_world_mm({double(i), double(j), double(k)}) - middle_mm;
        row[i] = std::abs(d.x) < 9 && std::abs(d.y) < 9 && std::abs(d.z) < 7 && !cavity.get(i, j, k);
      }
    });
    cavity |= box;
  }

  /// The dura, with the box's voxels of those HU: the number of them inside it, and of all others.
  std::pair<double, double> dura(const std::function<int(int i, int j, int k)>& hu) {
    auto& v = std::get<grid::Grid<std::int16_t>>(volume);
    for (int k = 0; k < v.size[2]; ++k)
      for (int j = 0; j < v.size[1]; ++j)
        for (int i = 0; i < v.size[0]; ++i)
          if (box.get(i, j, k)) v.at(i, j, k) = std::int16_t(hu(i, j, k));
    place::ZoneParams params;
    params.what = place::Zone::dura;
    params.smooth_mm = 2;
    Report report;
    place::ZoneShapes shapes;
    shapes.volume = &volume;
    const grid::Field field = value_of(report, place::find_zone(cavity, shapes, params));
    const mask::BitMask inside = mask::positive(field, cavity.lattice());
    const double within = double(mask::both(inside, box).count());
    return {within, double(inside.count()) - within};
  }
};

TEST(SegmentZones, BoneCellsAtTheBaseAreNoneOfTheDuras) {
  Leaking scan;
  const double box = double(scan.box.count());
  ASSERT_GT(box, 400);
  const auto [tissue, rest] = scan.dura([](int, int, int) { return 40; });
  EXPECT_GT(tissue, 0.6 * box) << "what holds no air stays as it was";
  // Air with walls of bone, thinner than a voxel: of three voxels one is air, one half of it, one a wall. The field of
  // the box ends at its own edge, and the smoothed surface within a voxel of it.
  const auto [cells, beside] = scan.dura([](int i, int j, int k) {
    return (i + j + k) % 3 == 0 ? -800 : (i + j + k) % 3 == 1 ? -250 : 60;
  });
  EXPECT_LT(cells, 0.05 * box);
  EXPECT_NEAR(beside, rest, 0.002 * rest) << "and what lies beside it";
}

/// The third ventricle by the true ventricles of a head, and how much of the true third and lateral ones it holds.
struct FoundThird {
  Report report;
  double third = 0, lateral = 0;

  explicit FoundThird(phantom::Variant variant, double shift_mm, bool without = false) {
    phantom::HeadParams who;
    who.level = phantom::Level::clinical;
    who.seed = 3;
    who.variant = variant;
    const phantom::Head head(who);
    const grid::HuVolume volume = phantom::volume_of(phantom::scan(head, scan_in(90, 2)));
    Report ignored;
    const mask::BitMask cavity = place::cranial_cavity(place::bone_of(mask::HuView(volume)), {}).value;
    grid::Field ventricles(cavity.lattice());
    const auto each = [](const grid::Lattice& l, const auto& visit) {
      for (int k = 0; k < l.size[2]; ++k)
        for (int j = 0; j < l.size[1]; ++j)
          for (int i = 0; i < l.size[0]; ++i) visit(i, j, k, l.to_world_mm({double(i), double(j), double(k)}));
    };
    each(ventricles, [&](int i, int j, int k, Vec3 p) {
      double mm = -head.implicit_mm(phantom::Anatomy::ventricles, p);
      if (without && std::abs(p.x - shift_mm) < 4 && p.z < 54) mm = -1;
      ventricles.at(i, j, k) = float(mm == 0 ? -1e-6 : std::clamp(mm, -20.0, 20.0));
    });
    place::ZoneParams params;
    params.what = place::Zone::third_ventricle;
    const grid::Field zone = value_of(report, place::find_zone(cavity, {nullptr, &ventricles}, params));
    double all = 0, lateral_all = 0;
    each(ventricles, [&](int i, int j, int k, Vec3 p) {
      if (!(ventricles.at(i, j, k) > 0.3)) return;
      const Vec3 at = zone.to_index(p);
      const int x = int(std::lround(at.x)), y = int(std::lround(at.y)), z = int(std::lround(at.z));
      const bool holds = zone.contains(x, y, z) && zone.at(x, y, z) > 0;
      const bool is_third = std::abs(p.x - shift_mm) < 2.5 && p.z < 48 && p.z > 36 && p.y > -16 && p.y < 8;
      const bool is_lateral = std::abs(p.x - shift_mm) > 8 || p.z > 58;
      all += is_third, third += is_third && holds;
      lateral_all += is_lateral, lateral += is_lateral && holds;
    });
    third /= all, lateral /= lateral_all;
  }
};

// It is a critical structure of the lessons: where it was lost, a needle through it was no fault.
TEST(SegmentZones, TheThirdVentricleIsFollowedToTheSide) {
  const FoundThird normal(phantom::Variant::normal, 0), shifted(phantom::Variant::shifted, -8);
  EXPECT_GT(normal.third, 0.85);
  EXPECT_LT(normal.lateral, 0.02);
  EXPECT_EQ(normal.report.find("third_shift_mm"), nullptr);
  EXPECT_GT(shifted.third, 0.85);
  EXPECT_LT(shifted.lateral, 0.02);
  ASSERT_NE(shifted.report.find("third_shift_mm"), nullptr);
  EXPECT_NEAR(std::get<double>(*shifted.report.find("third_shift_mm")), -8, 2);
}

TEST(LongSegmentZones, NoLateralVentricleIsTakenForAThirdOneThatIsNotSeen) {
  using phantom::Variant;
  for (const Variant variant : {Variant::normal, Variant::hydrocephalic, Variant::small, Variant::shifted}) {
    try {
      const FoundThird found(variant, variant == Variant::shifted ? -8 : 0, true);
      EXPECT_LT(found.lateral, 0.02) << int(variant);
      EXPECT_EQ(found.report.find("third_shift_mm"), nullptr) << int(variant);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
    }
  }
}

// Noise makes single voxels of tissue as dark as air. Joined to a bone cell's true air they took the base of the brain.
TEST(SegmentZones, NoiseIsNoAir) {
  Leaking scan(60);
  const double box = double(scan.box.count());
  const auto [tissue, rest] = scan.dura([](int, int, int) { return 40; });
  const auto [air, beside] = scan.dura([](int, int, int) { return -800; });
  EXPECT_LT(air, 0.05 * box);
  EXPECT_NEAR(beside, rest, 0.01 * rest);
}

/// A zone of balls, and a scan in which all is `hu` but what is said of one side.
grid::Field balls(const std::vector<std::pair<Vec3, double>>& centres_and_radii_mm) {
  grid::Field zone(grid::Lattice{{60, 60, 60}, {1, 1, 1}, {-30, -30, -30}, {}});
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) {
        double mm = -20;
        for (const auto& [centre, radius] : centres_and_radii_mm)
          mm = std::max(mm, radius - norm(zone.to_world_mm({double(i), double(j), double(k)}) - centre));
        zone.at(i, j, k) = float(mm == 0 ? -1e-6 : mm);
      }
  return zone;
}
grid::HuVolume tissue_with(double from_x_mm, std::int16_t hu) {
  grid::Grid<std::int16_t> v(grid::Lattice{{60, 60, 60}, {1, 1, 1}, {-30, -30, -30}, {}}, std::int16_t{35});
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i)
        if (v.to_world_mm({double(i), double(j), double(k)}).x >= from_x_mm) v.at(i, j, k) = hu;
  return v;
}
std::vector<std::string> ids_of(const Warnings& warnings) {
  std::vector<std::string> ids;
  for (const Warning& w : warnings) {
    ids.push_back(w.id);
    EXPECT_FALSE(to_text(w).empty());
  }
  return ids;
}

// A block of a third of a millilitre and shards were called good.
TEST(ZoneDoubts, AThirdVentricleIsWholeAndOfAnAdultsSize) {
  using Ids = std::vector<std::string>;
  const auto doubts = [](const std::vector<std::pair<Vec3, double>>& of) {
    return ids_of(place::zone_doubts(balls(of), place::Zone::third_ventricle, nullptr));
  };
  EXPECT_EQ(doubts({{Vec3{}, 6.5}}), Ids{});                           // 1.15 ml
  EXPECT_EQ(doubts({{Vec3{}, 4.5}}), Ids{"unusual_third_ventricle"});  // 0.38 ml
  EXPECT_EQ(doubts({{Vec3{-12, 0, 0}, 5}, {Vec3{12, 0, 0}, 5}}),
            Ids{"unusual_third_ventricle"});  // two halves of 0.52 ml
  EXPECT_EQ(doubts({{Vec3{-12, 0, 0}, 7}, {Vec3{12, 0, 0}, 2}}), Ids{});
}

TEST(ZoneDoubts, NoZoneLiesInAirAndNoDuraHoldsFat) {
  using Ids = std::vector<std::string>;
  const grid::Field zone = balls({{Vec3{}, 12}});  // 7.2 ml
  const auto doubts = [&](place::Zone what, double from_x_mm, std::int16_t hu) {
    const grid::HuVolume volume = tissue_with(from_x_mm, hu);
    return ids_of(place::zone_doubts(zone, what, &volume));
  };
  EXPECT_EQ(doubts(place::Zone::midline, 11.5, -900), Ids{});  // less than a hundredth of it
  EXPECT_EQ(doubts(place::Zone::midline, 8, -900), Ids{"zone_in_air"});
  EXPECT_EQ(doubts(place::Zone::brainstem, 8, -100), Ids{});
  EXPECT_EQ(doubts(place::Zone::dura, 8, -900), Ids{});  // its air is taken off before
  EXPECT_EQ(doubts(place::Zone::dura, -2, -90), Ids{"fat_inside_dura"});
  EXPECT_EQ(doubts(place::Zone::dura, 7, -90), Ids{});  // under 2 ml of it lie within
}

}  // namespace
TEST(Brainstem, TheMedullaEndsInTheForamenThatTheScanShows) {
  grid::Lattice l;
  l.size = {100, 160, 100};
  l.spacing_mm = {1, 1, 1};
  l.origin_mm = {-50, -70, -60};
  place::HeadPlace same;  // the template's own axes
  same.centre_mm = same.to_lps({0, 0, 0}) * -1.0;
  ASSERT_LT(norm(same.to_lps({1, 2, 3}) - Vec3{1, 2, 3}), 1e-9);
  const auto end_with = [&](Vec3 foramen, double radius_mm) {
    const mask::BitMask cavity = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)}), to = p - foramen;
        // A jugular foramen lies beside it.
        const bool beside = to.x > 10 && to.x < 24 && std::abs(to.y) < 3;
        row[i] = p.z > -16 ? norm(p - Vec3{0, 10, 30}) < 60 : std::hypot(to.x, to.y) < radius_mm || beside;
      }
    });
    return place::find_medulla_end(cavity, same);
  };
  for (const Vec3 foramen : {Vec3{0, 27, 0}, Vec3{-4, 17, 0}, Vec3{3, 33, 0}}) {
    const auto end = end_with(foramen, 15);
    ASSERT_TRUE(end);
    EXPECT_LT(std::hypot(end->x - foramen.x, end->y - foramen.y), 1.5) << end->x << ", " << end->y;
    EXPECT_LT(place::brainstem_mm({foramen.x, foramen.y, -24}, *end), -4);
  }
  EXPECT_FALSE(end_with({0, 27, 0}, 24)) << "as wide as a posterior fossa";
  EXPECT_FALSE(end_with({0, 27, 0}, 2)) << "closed";
  EXPECT_FALSE(end_with({0, 48, 0}, 15)) << "no template lies so";
  l.size[1] = 100;  // the scan ends behind the foramen's middle
  EXPECT_FALSE(end_with({0, 27, 0}, 15)) << "half a foramen has no middle";
}

}  // namespace trephine
