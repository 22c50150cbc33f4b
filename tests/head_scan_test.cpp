// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"
#include "head/soft_tissue.h"
#include "mask/scan_verdict.h"
#include "phantom/phantom.h"
#include "phantom/random.h"
#include "report_of.h"

using namespace trephine;
using namespace trephine::phantom;
using mask::measure_scan;
using mask::ScanFigures;

namespace {

/// A slab of a head with brain in it, at level hard, so that every kernel is at hand.
const phantom::Head& one_head() {
  static const phantom::Head h = [] {
    phantom::HeadParams p;
    p.level = phantom::Level::hard;
    p.seed = 7;
    return phantom::Head(p);
  }();
  return h;
}

phantom::ScanParams slab(double noise_hu) {
  phantom::ScanParams p;
  p.columns_count = p.rows_count = 400;
  p.field_of_view_mm = 200;
  p.slices_count = 6;
  p.centre_mm = {0, -5, 64};
  p.noise_hu = noise_hu;
  return p;
}

grid::HuVolume scanned(const phantom::ScanParams& p, const phantom::Kernel& kernel) {
  return phantom::volume_of(phantom::scan(one_head(), p, kernel));
}

}  // namespace

// Item 3: noise of 5 to 60 HU is measured within a tenth, whatever its colour. What the sharp kernel makes of it is
// known from a scan of air.
TEST(ScanFigures, NoiseIsMeasuredWhateverItsColour) {
  phantom::ScanParams air = slab(1.5);  // so that nothing is clipped at -1024 HU
  air.centre_mm = {0, -400, 64};
  air.table = false;
  const phantom::Scan in_air = phantom::scan(one_head(), air, phantom::Kernel{0.6, 2});
  double square = 0;
  for (const std::int16_t v : in_air.hu) square += (v + 1000.0) * (v + 1000.0);
  const double gain = std::sqrt(square / double(in_air.hu.size())) / 1.5;
  EXPECT_GT(gain, 2);
  for (const double noise : {5.0, 60.0}) {
    const ScanFigures soft = measure_scan(scanned(slab(noise), {1.0, 0})),
                      sharp = measure_scan(scanned(slab(noise), {0.6, 2}));
    std::printf("%2.0f HU: soft %.1f, cube %.1f, neighbours %.2f; sharp %.1f of %.1f, cube %.1f, neighbours %.2f\n",
                noise, soft.noise_hu, soft.cube_noise_hu, soft.neighbour_correlation_ratio, sharp.noise_hu,
                gain * noise, sharp.cube_noise_hu, sharp.neighbour_correlation_ratio);
    EXPECT_NEAR(soft.noise_hu, noise, 0.1 * noise + 0.5);
    EXPECT_NEAR(sharp.noise_hu, gain * noise, 0.1 * gain * noise + 0.5);
    EXPECT_GT(soft.neighbour_correlation_ratio, 0.6);
    EXPECT_LT(sharp.neighbour_correlation_ratio, 0.35);
    EXPECT_NEAR(soft.kernel_mm, 1.0, 0.2);
    EXPECT_LT(soft.slice_correlation_ratio, 0.15);
    EXPECT_LT(soft.artefact_ratio, 0.02);
  }
  const ScanFigures white = measure_scan(scanned(slab(30), {0, 0}));
  EXPECT_NEAR(white.neighbour_correlation_ratio, 0, 0.08);
}

// A sharp kernel's noise once looked white to the brain's own guard, and the brain was found with a Dice of 0.
TEST(ScanFigures, NoiseOfAnyColourThatHidesTheBrainIsRefused) {
  EXPECT_NO_THROW(head::check_scan_noise(scanned(slab(12), {0.6, 2})));
  for (const phantom::Kernel& kernel : {phantom::Kernel{1.0, 0}, phantom::Kernel{0.6, 2}}) try {
      head::check_scan_noise(scanned(slab(60), kernel));
      ADD_FAILURE() << "not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality);
      EXPECT_NE(std::string(e.what()).find("smoother kernel"), std::string::npos) << e.what();
    }
}

TEST(ScanFigures, ThickOverlappingSlicesAndWideKernelsShow) {
  phantom::ScanParams p = slab(12);
  p.slice_thickness_mm = 2;
  EXPECT_NEAR(measure_scan(scanned(p, {1.0, 0})).slice_correlation_ratio, 0.67, 0.15);
  double before = 0;
  for (const double kernel : {0.7, 1.4, 2.4, 3.5}) {
    const double edge = measure_scan(scanned(slab(3), {kernel, 0})).edge_mm;
    EXPECT_NEAR(edge, kernel, 0.2 * kernel + 0.15);
    EXPECT_GT(edge, before);
    before = edge;
  }
}

TEST(ScanFigures, StreaksShow) {
  phantom::HeadParams who;
  who.level = phantom::Level::hard;
  who.hard.clip = true;
  phantom::ScanParams p = slab(8);
  p.centre_mm = {0, -5, 22};
  const double clean = measure_scan(phantom::volume_of(phantom::scan(one_head(), p))).artefact_ratio;
  p.streak_hu = 400;
  const double streaks = measure_scan(phantom::volume_of(phantom::scan(phantom::Head(who), p))).artefact_ratio;
  std::printf("artefacts: %.3f without, %.3f with a clip\n", clean, streaks);
  EXPECT_LT(clean, 0.05);
  EXPECT_GT(streaks, clean + 0.05);
}

TEST(ScanFigures, SameWhateverTheThreadsAndTheAxis) {
  const grid::HuVolume v = scanned(slab(12), {1.0, 0});
  set_thread_count(1);
  const ScanFigures one = measure_scan(v);
  set_thread_count(4);
  const ScanFigures four = measure_scan(v);
  set_thread_count(0);
  EXPECT_EQ(one.noise_hu, four.noise_hu);
  EXPECT_EQ(one.edge_mm, four.edge_mm);
  EXPECT_EQ(one.cube_noise_hu, four.cube_noise_hu);
}

// Nothing to measure is said, not guessed.
TEST(ScanFigures, AirIsUnknown) {
  grid::Grid<std::int16_t> air;
  air.size = {64, 64, 20};
  air.voxels.assign(64 * 64 * 20, -1000);
  const ScanFigures f = measure_scan(grid::HuVolume(air));
  EXPECT_FALSE(f.known());
  const mask::ScanVerdict v = mask::judge_scan(f, {});
  EXPECT_EQ(v.brain, mask::Suitability::unknown);
  EXPECT_EQ(v.kernel, "unknown");
  ASSERT_EQ(v.reasons.size(), 1u);
}

// The verdict holds for every measure at its limits, and says what to do.
TEST(ScanVerdict, EveryLimitHasItsVerdictAndItsRemedy) {
  ScanFigures good;
  good.pixel_mm = 0.5, good.slice_step_mm = 1, good.tiles_count = 5000, good.noise_hu = 8, good.cube_noise_hu = 4;
  good.neighbour_correlation_ratio = 0.7, good.kernel_mm = 1, good.edge_mm = 1;
  const mask::ScanLimits limits;
  EXPECT_EQ(mask::judge_scan(good, limits).text(), "suited for brain, ventricles and skull");
  EXPECT_TRUE(mask::judge_scan(good, limits).reasons.empty());
  const auto changed = [&](auto change) {
    ScanFigures f = good;
    change(f);
    const mask::ScanVerdict v = mask::judge_scan(f, limits);
    for (const mask::ScanReason& r : v.reasons) {
      EXPECT_FALSE(r.remedy.empty()) << r.verdict();
      EXPECT_NE(to_text(r.warning()).find("; " + r.remedy), std::string::npos) << r.verdict();
    }
    EXPECT_EQ(v.reasons.empty(), v.text() == "suited for brain, ventricles and skull");
    return v.text();
  };
  EXPECT_EQ(changed([](ScanFigures& f) { f.cube_noise_hu = 15; }),
            "doubtful for brain and ventricles, suited for skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.cube_noise_hu = 24; }),
            "unsuited for brain and ventricles, suited for skull");
  // The bone kernel that the guard of 23 HU let pass: neighbours differ by 67 HU, a cube of 2 mm hardly.
  EXPECT_EQ(changed([](ScanFigures& f) { f.noise_hu = 51, f.neighbour_correlation_ratio = 0.15, f.kernel_mm = 0.4; }),
            "doubtful for brain and ventricles, suited for skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.noise_hu = 90, f.neighbour_correlation_ratio = 0.15, f.kernel_mm = 0.4; }),
            "unsuited for brain and ventricles, doubtful for skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.noise_hu = 160; }),
            "unsuited for brain, ventricles and skull, doubtful for skin");
  EXPECT_EQ(changed([](ScanFigures& f) { f.slice_step_mm = 5; }), "doubtful for brain, ventricles and skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.slice_step_mm = 8; }), "unsuited for brain, ventricles and skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.edge_mm = 3.5; }), "suited for brain and ventricles, doubtful for skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.noise_hu = 1.5, f.kernel_mm = 3; }),
            "suited for brain, doubtful for ventricles, suited for skull");
  // A filter that keeps edges: what noise is left is as fine as before, and its whole HU are finer still.
  EXPECT_EQ(changed([](ScanFigures& f) { f.noise_hu = 1.1, f.cube_noise_hu = 0.8, f.kernel_mm = 1; }),
            "suited for brain, doubtful for ventricles, suited for skull");
  EXPECT_EQ(changed([](ScanFigures& f) { f.artefact_ratio = 0.2; }),
            "doubtful for brain and ventricles, suited for skull");
}

TEST(ScanVerdict, RefusesWhereAsked) {
  mask::ScanLimits limits;
  const grid::HuVolume noisy = scanned(slab(60), {0.6, 2});
  Report report;
  value_of(report, mask::judge_scan(noisy, limits));
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings[0].find("softer kernel"), std::string::npos);
  limits.refuse = true;
  try {
    value_of(report, mask::judge_scan(noisy, limits));
    FAIL() << "not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("import.series"), std::string::npos);
  }
}
