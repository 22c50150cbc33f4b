// SPDX-License-Identifier: GPL-3.0-or-later
// What a second scan shows that lies on the CT: brain and ventricles of an MR, vessels of an angiography; and the zones
// of a CT alone. Truth: the synthetic head.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"
#include "head/brain.h"
#include "head/ventricles.h"
#include "itk/registration.h"
#include "mask/filters.h"
#include "phantom/phantom.h"
#include "phantom/random.h"
#include "place/cranium.h"
#include "place/zones.h"
#include "report_of.h"
#include "segmentation/t1_contrast.h"
#include "segmentation/vessels.h"

namespace trephine {
namespace {

using mask::BitMask;
using phantom::Anatomy;
using phantom::Head;

Head head_of(phantom::Level level, int seed, bool contrast = false) {
  phantom::HeadParams p;
  p.level = level;
  p.seed = seed;
  p.hard.contrast = contrast;
  return Head(p);
}

/// A second scan of the head where it lies, on the CT's voxels.
grid::HuVolume laid(const Head& head, phantom::SecondScan contrast, double voxel_mm, const grid::Lattice& on,
                    double noise = 0.04, double bias = 0.3) {
  phantom::SecondScanParams p;
  p.contrast = contrast;
  p.voxel_mm = voxel_mm;
  p.noise_ratio = noise;
  p.bias_ratio = bias;
  p.turn_deg = {6, -9, 4};
  p.shift_mm = {10, -7, 12};
  const phantom::Second second = phantom::second_scan(head, p);
  return itk::resample_onto(grid::HuVolume(second.volume), on, second.truth,
                            contrast == phantom::SecondScan::mr ? 0.0f : -1000.0f);
}

grid::Lattice box(double voxel_mm) {
  grid::Lattice l;
  l.size = {static_cast<int>(180 / voxel_mm), static_cast<int>(220 / voxel_mm), static_cast<int>(190 / voxel_mm)};
  l.spacing_mm = {voxel_mm, voxel_mm, voxel_mm};
  l.origin_mm = {-89.7, -115.3, -45.2};
  return l;
}

struct Ct {
  grid::HuVolume volume;
  BitMask cavity;
};

Ct ct_of(const Head& head, double voxel_mm) {
  Ct ct{laid(head, phantom::SecondScan::ct, voxel_mm, box(voxel_mm), 0.01), {}};
  Report report;
  ct.cavity = value_of(report, place::cranial_cavity(place::bone_of(mask::HuView(ct.volume)), {}));
  return ct;
}

std::string said(const Report& report) {
  std::string text;
  for (const auto& [name, value] : report.figures) text += name + " " + to_text(value) + "; ";
  return text;
}

double dice(const Head& head, Anatomy anatomy, const grid::Field& field) {
  double both = 0, sum = 0;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        const bool found = field.at(i, j, k) > 0;
        const bool is = head.implicit_mm(anatomy, field.to_world_mm({double(i), double(j), double(k)})) < 0;
        both += found && is;
        sum += double(found) + is;
      }
  return 2 * both / sum;
}

std::string refused(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    return e.what();
  }
  return "";
}

TEST(LongSecondScan, BrainAndVentriclesOfAnMr) {
  const Head head = head_of(phantom::Level::clinical, 4);
  const Ct ct = ct_of(head, 1.6);
  const grid::HuVolume mr = laid(head, phantom::SecondScan::mr, 1.2, grid::lattice_of(ct.volume));
  Report report;
  segmentation::T1ContrastParams params;
  const grid::HuVolume grey = value_of(report, segmentation::t1_contrast(mr, ct.volume, ct.cavity, params));
  const grid::Field brain = head::find_brain(grey, {}, {}).value;
  params.bright = segmentation::T1Bright::white;
  const grid::HuVolume white = segmentation::t1_contrast(mr, ct.volume, ct.cavity, params).value;
  const grid::Field ventricles = head::find_ventricles(white, {&brain, nullptr}, {}).value;
  const double of_brain = dice(head, Anatomy::brain, brain),
               of_ventricles = dice(head, Anatomy::ventricles, ventricles);
  std::printf("brain %.4f, ventricles %.4f\n%s", of_brain, of_ventricles, said(report).c_str());
  EXPECT_GT(of_brain, 0.95);
  EXPECT_GT(of_ventricles, 0.95);
  // CSF 250, grey 720, white 1000 of the phantom, which the bias must not change.
  EXPECT_NEAR(std::get<double>(*report.find("csf_to_grey_ratio")), 250.0 / 720, 0.06);
  EXPECT_NEAR(std::get<double>(*report.find("grey_to_white_ratio")), 0.72, 0.04);
  EXPECT_GT(std::get<double>(*report.find("bias_ratio")), 0.1);
  // The CT's bone stays, and the same comes of one thread.
  set_thread_count(1);
  EXPECT_EQ(std::get<grid::Grid<float>>(segmentation::t1_contrast(mr, ct.volume, ct.cavity, params).value),
            std::get<grid::Grid<float>>(white));
  set_thread_count(0);
}

TEST(SecondScan, WhatIsNoT1IsRefused) {
  const Head head = head_of(phantom::Level::clinical, 4);
  const Ct ct = ct_of(head, 2.5);
  grid::HuVolume mr = laid(head, phantom::SecondScan::mr, 2.5, grid::lattice_of(ct.volume));
  const auto why = [&](const grid::HuVolume& scan) {
    return refused([&] { segmentation::t1_contrast(scan, ct.volume, ct.cavity, {}); });
  };
  EXPECT_EQ(why(mr), "");
  // T2: what is bright becomes dark.
  grid::HuVolume t2 = mr;
  for (auto& v : std::get<grid::Grid<std::int16_t>>(t2).voxels)
    v = static_cast<std::int16_t>(v > 0 ? 1400 - std::min<int>(v, 1300) : 0);
  EXPECT_NE(why(t2).find("not that of T1"), std::string::npos) << why(t2);
  // Half of the head.
  grid::HuVolume half = mr;
  auto& grid = std::get<grid::Grid<std::int16_t>>(half);
  std::fill(grid.voxels.begin(), grid.voxels.begin() + static_cast<std::ptrdiff_t>(grid.voxels.size() / 2),
            std::int16_t(0));
  EXPECT_NE(why(half).find("outside of the MR"), std::string::npos);
}

void check_vessels(double ct_mm, double cta_mm, bool without) {
  const Head head = head_of(phantom::Level::hard, 3), with = head_of(phantom::Level::hard, 3, true);
  const Ct ct = ct_of(head, ct_mm);
  const grid::HuVolume cta = laid(head, phantom::SecondScan::cta, cta_mm, grid::lattice_of(ct.volume), 0.012);
  Report report;
  const grid::Field found =
      value_of(report, segmentation::find_vessels(cta, ct.volume, ct.cavity, nullptr, nullptr, {}));
  double truth = 0, hit = 0, all = 0, near = 0;
  const grid::Grid<float> mm = mask::signed_distance_mm(found, {});
  const grid::Lattice& l = grid::lattice_of(ct.volume);
  const grid::Box at = grid::place_in(found, l);
  for (int k = 0; k < found.size[2]; ++k)
    for (int j = 0; j < found.size[1]; ++j)
      for (int i = 0; i < found.size[0]; ++i) {
        const Vec3 p = found.to_world_mm({double(i), double(j), double(k)});
        const bool is = with.thing(p) == phantom::Thing::vessel;
        truth += is;
        hit += is && mm.at(i, j, k) > -1;
        const bool inside = found.at(i, j, k) > 0;
        all += inside;
        if (!inside) continue;
        bool close = is;
        for (const Vec3 d :
             {Vec3{1.5, 0, 0}, Vec3{-1.5, 0, 0}, Vec3{0, 1.5, 0}, Vec3{0, -1.5, 0}, Vec3{0, 0, 1.5}, Vec3{0, 0, -1.5}})
          close = close || with.thing(p + d) == phantom::Thing::vessel;
        near += close;
      }
  std::printf("%.1f of %.1f ml within 1 mm of what was found; of what was found %.3f near a vessel; %s\n", hit / 1000,
              truth / 1000, near / all, said(report).c_str());
  EXPECT_EQ(at.empty(), false);
  EXPECT_GT(hit, 0.9 * truth);
  EXPECT_GT(near, 0.85 * all);
  if (!without) return;
  // Without contrast agent there is none.
  const grid::HuVolume plain = laid(head, phantom::SecondScan::ct, cta_mm, l, 0.012);
  EXPECT_NE(refused([&] {
              value_of(report, segmentation::find_vessels(plain, ct.volume, ct.cavity, nullptr, nullptr, {}));
            }).find("no vessel"),
            std::string::npos);
}

TEST(LongSecondScan, VesselsOfAnAngiography) { check_vessels(1.6, 1.4, false); }
TEST(SecondScan, LongVesselsOfAnAngiography) { check_vessels(1, 0.8, true); }

// A trunk of sorts: two opacified vessels in soft tissue between a bone and a lung. `without` leaves the vein out.
TEST(SecondScan, VesselsOfATrunk) {
  grid::Lattice l;
  l.size = {60, 64, 48};
  l.spacing_mm = {1, 1, 1};
  grid::Grid<std::int16_t> ct(l), cta(l);
  grid::Field vein(l);
  mask::BitMask bone(l);
  const auto tube = [](int j, int k, double y, double z, double r) { return r - std::hypot(j - y, k - z); };
  double artery_mm3 = 0;
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 60; ++i) {
        const std::size_t n = l.index(i, j, k);
        const double skin = std::hypot((j - 32) / 28.0, (k - 24) / 21.0);
        const bool is_bone = tube(j, k, 22, 34, 4) > 0, lung = tube(j, k, 46, 14, 8) > 0;
        const auto noise = [&](std::uint64_t seed) { return 20 * (phantom::uniform(seed, 1, n) - 0.5); };
        const double plain = skin > 1 ? -1000 : is_bone ? 700 : lung ? -850 : 45;
        const double artery = std::clamp(tube(j, k, 22, 22, 4) + 0.5, 0.0, 1.0),
                     in_vein = std::clamp(tube(j, k, 36, 26, 5) + 0.5, 0.0, 1.0);
        artery_mm3 += artery;
        vein.voxels[n] = static_cast<float>(tube(j, k, 36, 26, 5));
        if (is_bone) bone.set(i, j, k);
        ct.voxels[n] = static_cast<std::int16_t>(plain + noise(1));
        cta.voxels[n] = static_cast<std::int16_t>(plain + 250 * std::max(artery, in_vein) + noise(2));
      }
  segmentation::VesselsParams params;
  params.region = segmentation::VesselRegion::soft_tissue;
  params.enhancement_hu = 125;
  params.smoothing_sigma_mm = 0.5;
  const mask::BitMask tissue = segmentation::soft_tissue_around(grid::HuVolume(ct), bone);
  const auto volume_of = [&](const grid::Field& f) {
    return static_cast<double>(std::count_if(f.voxels.begin(), f.voxels.end(), [](float v) { return v > 0; }));
  };
  const grid::Field both =
      segmentation::find_vessels(grid::HuVolume(cta), grid::HuVolume(ct), tissue, nullptr, nullptr, params).value;
  EXPECT_GT(volume_of(both), 1.8 * artery_mm3);
  const grid::Field artery =
      segmentation::find_vessels(grid::HuVolume(cta), grid::HuVolume(ct), tissue, nullptr, &vein, params).value;
  EXPECT_NEAR(volume_of(artery), artery_mm3, 0.1 * artery_mm3);
  const grid::Field of_vein =
      segmentation::find_vessels(grid::HuVolume(cta), grid::HuVolume(ct), tissue, &vein, nullptr, params).value;
  EXPECT_NEAR(volume_of(of_vein), volume_of(vein), 0.1 * volume_of(vein));
  EXPECT_NE(refused([&] {
              segmentation::find_vessels(grid::HuVolume(ct), grid::HuVolume(ct), tissue, nullptr, nullptr, params);
            }).find("no vessel"),
            std::string::npos);
}

/// The synthetic head's brainstem, without what is individual of it.
double stem_mm(Vec3 p) {
  const auto capsule = [&](Vec3 a, Vec3 b, double r, double s) {
    const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
    return norm(p - (a + (b - a) * t)) - (r + t * (s - r));
  };
  return std::min(capsule({0, 6, 30}, {0, 16, 4}, 11.5, 12), capsule({0, 16, 4}, {0, 27, -26}, 9, 6));
}

void check_zones(const std::vector<int>& seeds) {
  for (const int seed : seeds) {
    const Head head = head_of(phantom::Level::hard, seed, true);
    const Ct ct = ct_of(head_of(phantom::Level::hard, seed), 1.5);
    const grid::Field brain = head::find_brain(ct.volume, {}, {}).value;
    const grid::Field ventricles = head::find_ventricles(ct.volume, {&brain, nullptr}, {}).value;
    const auto zone = [&](place::Zone what, double thickness_mm = 0) {
      place::ZoneParams params;
      params.what = what;
      params.thickness_mm = thickness_mm;
      params.half_width_mm = 3;
      Report report;
      grid::Field field = value_of(report, place::find_zone(ct.cavity, {nullptr, &ventricles}, params));
      std::printf("seed %d: %s\n", seed, said(report).c_str());
      for (const float v : field.voxels) EXPECT_TRUE(std::isfinite(v) && v != 0);
      return field;
    };
    const auto holds = [](const grid::Field& f, Vec3 p, double mm = 0) {
      const Vec3 q = f.to_index(p);
      const int i = int(std::lround(q.x)), j = int(std::lround(q.y)), k = int(std::lround(q.z));
      return f.contains(i, j, k) && f.at(i, j, k) > -mm;
    };
    const grid::Field sinus = zone(place::Zone::sagittal_sinus), third = zone(place::Zone::third_ventricle),
                      stem = zone(place::Zone::brainstem), midline = zone(place::Zone::midline),
                      dura = zone(place::Zone::dura), shell = zone(place::Zone::dura, 3);
    double sinus_all = 0, sinus_in = 0, stem_all = 0, stem_in = 0, stem_both = 0, third_all = 0, third_in = 0,
           lateral_all = 0, lateral_in = 0, slab = 0, slab_in = 0, within = 0, within_in = 0;
    for (double z = -30; z < 125; z += 1.5)
      for (double y = -80; y < 85; y += 1.5)
        for (double x = -60; x < 60; x += 1.5) {
          const Vec3 p{x, y, z};
          if ((z > 70 || (y > 60 && z > 40)) && std::abs(x) < 6 && head.thing(p) == phantom::Thing::vessel)
            ++sinus_all, sinus_in += holds(sinus, p, 1);  // a voxel at the inner table
          if (z > -20 && stem_mm(p) < 0) ++stem_all, stem_both += holds(stem, p);
          stem_in += holds(stem, p);
          if (head.implicit_mm(Anatomy::ventricles, p) < -0.5) {
            // The phantom's third ventricle: a slab of the midline below the foramina; the lateral ones beside it.
            const bool is_third = std::abs(x) < 2 && z < 48 && z > 36 && y > -16 && y < 8;
            const bool is_lateral = std::abs(x) > 8 || z > 58;
            third_all += is_third;
            third_in += is_third && holds(third, p);
            lateral_all += is_lateral;
            lateral_in += is_lateral && holds(third, p);
          }
          const int label = head.label(p);
          if ((label == 3 || label == 5) && z > 0) {
            ++within;
            within_in += holds(dura, p);
            if (std::abs(x) < 0.5) ++slab, slab_in += holds(midline, p);
          }
        }
    std::printf("sinus %.3f of %.0f, stem %.3f, Dice %.3f, third %.3f of %.0f, lateral %.4f, midline %.3f, dura %.4f\n",
                sinus_in / sinus_all, sinus_all, stem_both / stem_all, 2 * stem_both / (stem_all + stem_in),
                third_in / third_all, third_all, lateral_in / lateral_all, slab_in / slab, within_in / within);
    EXPECT_GT(sinus_in, 0.95 * sinus_all);
    EXPECT_GT(stem_both, 0.75 * stem_all);
    EXPECT_GT(third_in, 0.85 * third_all);
    EXPECT_LT(lateral_in, 0.02 * lateral_all);
    EXPECT_GT(within_in, 0.97 * within);  // the rest are voxels at the inner table
    EXPECT_GT(slab_in, 0.98 * slab);
    // Lateral ventricles that are wider than the template's, by 4 mm all around, are none of the third.
    grid::Field wide = grid::Field(ventricles, 0.0f);
    wide.voxels = mask::signed_distance_mm(ventricles).voxels;
    for (float& v : wide.voxels) v = std::clamp(v + 4, -10.0f, 10.0f);
    place::ZoneParams params;
    params.what = place::Zone::third_ventricle;
    Report report;
    const grid::Field of_wide = value_of(report, place::find_zone(ct.cavity, {nullptr, &wide}, params));
    const place::HeadPlace at = place::place_in_cavity(ct.cavity, &wide, {});
    double zone_all = 0, zone_lateral = 0, template_lateral = 0;
    for (int k = 0; k < wide.size[2]; ++k)
      for (int j = 0; j < wide.size[1]; ++j)
        for (int i = 0; i < wide.size[0]; ++i) {
          const Vec3 p = wide.to_world_mm({double(i), double(j), double(k)});
          const bool lateral = std::abs(p.x) > 7 || p.z > 54;
          zone_all += holds(of_wide, p);
          zone_lateral += lateral && holds(of_wide, p);
          if (!lateral || !(wide.at(i, j, k) > 0)) continue;
          const Vec3 t = at.to_template(p);
          const double third_mm = place::place_mm(place::Place::third, t);
          template_lateral += third_mm < 6 && third_mm < std::min(place::place_mm(place::Place::lateral_left, t),
                                                                  place::place_mm(place::Place::lateral_right, t));
        }
    std::printf("of wide ventricles: %.0f voxels, lateral %.4f, by the template alone %.4f\n", zone_all,
                zone_lateral / zone_all, template_lateral / zone_all);
    EXPECT_GT(zone_all, 500);
    // By the template's border alone 0.007 to 0.07 of the zone, by how well the head fits the template.
    EXPECT_LT(zone_lateral, 0.75 * template_lateral);
    EXPECT_LT(zone_lateral, 0.03 * zone_all);
    // The shell lies along the inner table and holds nothing of the middle.
    EXPECT_FALSE(holds(shell, {0, 0, 60}));
    EXPECT_TRUE(holds(dura, {0, 0, 60}));
  }
}

TEST(SecondScan, ZonesOfACtAlone) { check_zones({3}); }

// Where a scan loses the thin bone of the base, the cavity runs on into what lies behind it.
TEST(SecondScan, TheDuraEndsWhereATemplatesCavityDoes) {
  const Head head = head_of(phantom::Level::clinical, 3);
  const Ct ct = ct_of(head, 2.5);
  BitMask leaked = ct.cavity;
  const Vec3 under{30, -75, 0};  // an orbit
  std::int64_t added = 0;
  const grid::Lattice& l = leaked.lattice();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 d = l.to_world_mm({double(i), double(j), double(k)}) - under;
        if (std::abs(d.x) > 18 || std::abs(d.y) > 18 || std::abs(d.z) > 25 || leaked.get(i, j, k)) continue;
        leaked.set(i, j, k);
        ++added;
      }
  ASSERT_GT(double(added) * l.voxel_volume_mm3() / 1000, 20) << "ml";
  place::ZoneParams params;
  params.what = place::Zone::dura;
  const auto ml = [&](const BitMask& cavity, double max_beyond_mm, std::size_t warnings) {
    params.max_beyond_mm = max_beyond_mm;
    Report report;
    value_of(report, place::find_zone(cavity, {}, params));
    EXPECT_EQ(report.warnings.size(), warnings) << said(report);
    return std::get<double>(*report.find("volume_ml"));
  };
  const double whole = ml(ct.cavity, 0, 0), leaking = ml(leaked, 0, 0);
  EXPECT_GT(leaking, whole + 20);
  EXPECT_NEAR(ml(ct.cavity, 10, 0), whole, 0.005 * whole) << "a cavity that is right stays";
  EXPECT_LT(ml(leaked, 10, 1), whole + 0.4 * (leaking - whole));
}
TEST(SecondScan, LongZonesOfACtAlone) { check_zones({8, 11, 12, 13}); }

}  // namespace
}  // namespace trephine
