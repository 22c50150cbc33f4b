// SPDX-License-Identifier: GPL-3.0-or-later
// Registration against the truth of phantoms: where Kocher's points and the ventricles come to lie.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"
#include "grid/resample.h"
#include "itk/same_place.h"
#include "itk_scans.h"
#include "report_of.h"

using namespace trephine;
using phantom::Head;

namespace {

Head clinical_head(int seed) { return phantom_heads::head_of(phantom::Level::clinical, seed); }

phantom::Second mr_of(const Head& head, double voxel_mm, int seed) {
  phantom::SecondScanParams p;
  p.contrast = phantom::SecondScan::mr;
  p.voxel_mm = voxel_mm;
  p.noise_ratio = 0.04;
  p.bias_ratio = 0.3;
  p.scan_seed = seed;
  return phantom::second_scan(head, p);
}

Head hard_head(int seed) { return phantom_heads::head_of(phantom::Level::hard, seed); }

/// With contrast agent, which the first scan has not.
phantom::Second angiography_of(const Head& head, double voxel_mm, int seed) {
  phantom::SecondScanParams p;
  p.contrast = phantom::SecondScan::cta;
  p.voxel_mm = voxel_mm;
  p.noise_ratio = 0.015;
  p.scan_seed = seed;
  return phantom::second_scan(head, p);
}

struct Registered {
  double mean = 0, worst = 0, worst_published = 0;
  int doubtful = 0;
};

Registered over_offsets(const grid::HuVolume& ct, const phantom::Second& rest, const std::vector<Vec3>& places,
                        int from, int to, itk::RegistrationParams params) {
  Registered all;
  for (int n = from; n < to; ++n) {
    const phantom::Second second = moved(rest, random_offset(static_cast<std::uint64_t>(n), 30, 20));
    Report report;
    const auto start = std::chrono::steady_clock::now();
    const itk::Registration r = itk::register_scans(ct, grid::HuVolume(second.volume), nullptr, {}, params);
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double error = target_error_mm(r.map, second.truth, places);
    std::printf(
        "offset %2d: %.3f mm, turn %.1f, spread %.3f, inverse %.3f, overlap %.2f, margin %.2f, scale %.4f, %.1f s %s\n",
        n, error, r.figures.turn_deg, *r.figures.spread_mm, *r.figures.inverse_mm, *r.figures.overlap_ratio,
        *r.figures.margin_ratio, *r.figures.scale_ratio, s, r.doubts.c_str());
    all.mean += error / (to - from);
    all.worst = std::max(all.worst, error);
    if (r.doubts.empty())
      all.worst_published = std::max(all.worst_published, error);
    else
      ++all.doubtful;
  }
  return all;
}

}  // namespace

TEST(Registration, LaysAnMrOnTheCt) {
  const Head head = clinical_head(3);
  itk::RegistrationParams quick;
  quick.finest_mm = 2;
  quick.samples_count = 20000;
  const Registered o = over_offsets(quick_ct(head, 2), mr_of(head, 2, 1), targets(head), 0, 3, quick);
  EXPECT_LT(o.mean, 0.5);
  EXPECT_LT(o.worst, 1.0);
  EXPECT_EQ(o.doubtful, 0);
}

TEST(LongRegistration, LaysAnAngiographyOnTheCt) {
  const Head head = hard_head(3);
  itk::RegistrationParams quick;
  quick.moving = itk::MovingValues::hu;
  quick.finest_mm = 2;
  quick.samples_count = 20000;
  const Registered o = over_offsets(quick_ct(head, 2), angiography_of(head, 2, 1), targets(head), 0, 3, quick);
  EXPECT_LT(o.mean, 0.5);
  EXPECT_LT(o.worst, 1.0);
  EXPECT_EQ(o.doubtful, 0);
}

TEST(Registration, LongAngiographyOverTwentyOffsets) {
  double worst = 0, mean = 0;
  int doubtful = 0;
  itk::RegistrationParams params;
  params.moving = itk::MovingValues::hu;
  for (int h = 0; h < 2; ++h) {
    const Head head = hard_head(10 + h);
    const grid::HuVolume fixed = head_ct(head, 1, 12);
    const Registered o = over_offsets(fixed, angiography_of(head, 1, h), targets(head), 10 * h, 10 * h + 10, params);
    mean += o.mean / 2;
    worst = std::max(worst, o.worst);
    doubtful += o.doubtful;
  }
  std::printf("mean %.3f mm, worst %.3f mm, doubtful %d\n", mean, worst, doubtful);
  EXPECT_LT(mean, 0.5);
  EXPECT_LT(worst, 1.0);
  EXPECT_EQ(doubtful, 0);
}

TEST(Registration, TakesAGivenTransform) {
  const Head head = clinical_head(3);
  const grid::HuVolume ct = quick_ct(head, 3);
  const phantom::Second second = moved(mr_of(head, 3, 1), itk::rigid_map({5, 9, -7}, {12, -9, 4}, {}));
  Report report;
  const itk::Registration r = itk::given_registration(ct, grid::HuVolume(second.volume), second.truth, {});
  EXPECT_EQ(r.doubts, "");
  EXPECT_EQ(target_error_mm(r.map, second.truth, targets(head)), 0);
  EXPECT_GT(*r.figures.overlap_ratio, 0.8);
  EXPECT_TRUE(r.warnings.empty()) << "the images agree with it";
  itk::LinearMap away = second.truth, wide = second.truth;
  away.offset_mm.x += 300;
  EXPECT_NE(itk::given_registration(ct, grid::HuVolume(second.volume), away, {}).doubts, "");
  wide.matrix.column[1] = wide.matrix.column[1] * 1.01;
  EXPECT_THROW(itk::given_registration(ct, grid::HuVolume(second.volume), wide, {}), Error);
  itk::LinearMap mirrored = second.truth;
  mirrored.matrix.column[0] = -mirrored.matrix.column[0];
  EXPECT_THROW(itk::given_registration(ct, grid::HuVolume(second.volume), mirrored, {}), Error)
      << "left would be right";
}

// Two kernels of one scan lie upon each other as they are; a patient who moved by 3 mm in between does not.
TEST(LongRegistration, BonesTellTwoKernelsFromAPatientWhoMoved) {
  const Head head = hard_head(3);
  const phantom::ScanParams how = phantom_heads::scan_of(200, 40, 20, 80);
  const grid::HuVolume soft = phantom::volume_of(phantom::scan(head, how)),
                       sharp = phantom::volume_of(phantom::scan(head, how, {0.6, 2}));
  const double same = itk::bone_ratio(soft, sharp);
  grid::HuVolume moved = sharp;
  std::visit([](auto& grid) { grid.origin_mm.x += 3; }, moved);
  const double apart = itk::bone_ratio(soft, moved);
  std::printf("bone_ratio %.3f, moved by 3 mm %.3f\n", same, apart);
  EXPECT_GT(same, itk::min_bone_ratio + 0.05);
  EXPECT_LT(apart, itk::min_bone_ratio - 0.05);
}

TEST(Registration, SaysThatAResultIsDoubtful) {
  const Head head = clinical_head(3);
  const grid::HuVolume ct = quick_ct(head, 3);
  itk::RegistrationParams quick;
  quick.finest_mm = 2.5;
  quick.samples_count = 15000;
  const auto doubts = [&](const grid::HuVolume& moving) {
    return itk::register_scans(ct, moving, nullptr, {}, quick).doubts;
  };
  const auto warnings = [](const itk::Registration& r) {
    EXPECT_EQ(r.doubts, "");
    std::vector<std::string> texts;
    for (const Warning& w : r.warnings) texts.push_back(to_text(w));
    return texts;
  };
  phantom::Second mr = mr_of(head, 3, 1);
  const itk::Registration same = itk::register_scans(ct, grid::HuVolume(mr.volume), nullptr, {}, quick);
  EXPECT_EQ(warnings(same), std::vector<std::string>());
  EXPECT_FALSE(*same.figures.another_patient);
  // A head that is a little longer, as another patient's may be, is within the limits, and named.
  phantom::Second longer = mr;
  longer.volume.spacing_mm.y *= 1.025;
  const itk::Registration other = itk::register_scans(ct, grid::HuVolume(longer.volume), nullptr, {}, quick);
  const std::vector<std::string> said = warnings(other);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("whether this is the same patient"), std::string::npos) << said[0];
  EXPECT_TRUE(*other.figures.another_patient);
  // Voxels of a wrong size: no rigid map can lay it on the CT.
  phantom::Second stretched = mr;
  stretched.volume.spacing_mm.y *= 1.08;
  EXPECT_NE(doubts(grid::HuVolume(stretched.volume)).find("largest_scale_ratio"), std::string::npos);
  // Noise alone.
  phantom::Second noise = mr;
  for (std::size_t i = 0; i < noise.volume.voxels.size(); ++i)
    noise.volume.voxels[i] = static_cast<std::int16_t>(500 + 500 * phantom::uniform(1, 2, i));
  EXPECT_NE(doubts(grid::HuVolume(noise.volume)), "");
  // A small part of the head.
  phantom::Second part = mr;
  part.volume = grid::crop(mr.volume, {{0, 0, 0}, {mr.volume.size[0], 25, mr.volume.size[2]}});
  EXPECT_NE(doubts(grid::HuVolume(part.volume)), "");
}

TEST(Registration, DoesNotDependOnThreads) {
  const Head head = clinical_head(4);
  const grid::HuVolume ct = quick_ct(head, 4);
  const phantom::Second second = moved(mr_of(head, 4, 2), random_offset(7, 20, 15));
  itk::RegistrationParams quick;
  quick.finest_mm = 3;
  quick.samples_count = 8000;
  std::vector<std::string> results;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    Report report;
    const itk::Registration r = itk::register_scans(ct, grid::HuVolume(second.volume), nullptr, {}, quick);
    std::string text = itk::encode_tfm(r.map);
    for (const auto& f : figures_of(r.figures)) text += to_text(f.second) + "\n";
    results.push_back(text);
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

TEST(LongRegistration, BeginsWhereItIsTold) {
  const Head head = clinical_head(3);
  const grid::HuVolume ct = quick_ct(head, 3);
  const phantom::Second second = moved(mr_of(head, 3, 1), itk::rigid_map({150, 0, 60}, {60, -50, 80}, {}));
  itk::RegistrationParams quick;
  quick.finest_mm = 2.5;
  quick.samples_count = 15000;
  const std::vector<Vec3> places = targets(head);
  Report far, near;
  const itk::Registration alone = itk::register_scans(ct, grid::HuVolume(second.volume), nullptr, {}, quick);
  EXPECT_TRUE(alone.doubts != "" || target_error_mm(alone.map, second.truth, places) < 1) << "wrong and not said";
  EXPECT_GT(target_error_mm(alone.map, second.truth, places), 10) << "too easy for this test";
  const itk::LinearMap start =
      itk::then(second.truth, itk::rigid_map({5, 5, 5}, {8, 0, 6}, second.truth({0, -10, 42})));
  const itk::Registration r = itk::register_scans(ct, grid::HuVolume(second.volume), nullptr, start, quick);
  EXPECT_EQ(r.doubts, "");
  EXPECT_LT(target_error_mm(r.map, second.truth, places), 1.0);
}

TEST(Registration, LongOverFortyOffsets) {
  double worst = 0, mean = 0;
  int doubtful = 0;
  for (int h = 0; h < 4; ++h) {
    const Head head = clinical_head(10 + h);
    const grid::HuVolume fixed = head_ct(head, 1, 12);
    const Registered o = over_offsets(fixed, mr_of(head, 1, h), targets(head), 10 * h, 10 * h + 10, {});
    mean += o.mean / 4;
    worst = std::max(worst, o.worst);
    doubtful += o.doubtful;
    EXPECT_LT(o.worst_published, 2.0);
  }
  std::printf("mean %.3f mm, worst %.3f mm, doubtful %d\n", mean, worst, doubtful);
  EXPECT_LT(mean, 0.5);
  EXPECT_LT(worst, 1.0);
  EXPECT_EQ(doubtful, 0);
}

// Scans as nobody wants them: thick slices, much noise, a slab of the head, an offset beyond what is promised, a strong
// bias. Right or refused, never wrong and published.
TEST(Registration, LongHardScansAreRightOrRefused) {
  const Head head = clinical_head(21);
  const grid::HuVolume ct = quick_ct(head, 2);
  const std::vector<Vec3> places = targets(head);
  phantom::SecondScanParams usual;
  usual.contrast = phantom::SecondScan::mr;
  usual.voxel_mm = 2;
  usual.noise_ratio = 0.04;
  phantom::SecondScanParams noisy = usual, biased = usual;
  noisy.noise_ratio = 0.25;
  biased.bias_ratio = 0.85;
  const phantom::Second scans[] = {phantom::second_scan(head, usual), phantom::second_scan(head, noisy),
                                   phantom::second_scan(head, biased)};
  itk::RegistrationParams quick;
  quick.finest_mm = 2;
  quick.samples_count = 20000;
  int published = 0, right = 0, all = 0;
  double worst = 0;
  for (std::uint64_t n = 0; n < 60; ++n) {
    const int kind = static_cast<int>(n % 6);
    const bool far = kind == 3;
    phantom::Second second = moved(scans[kind == 1   ? 1
                                         : kind == 2 ? 2
                                                     : 0],
                                   random_offset(n, far ? 90 : 30, far ? 80 : 20));
    grid::HuVolume moving(second.volume);
    Report report;
    const auto& size = second.volume.size;
    if (kind == 4) moving = value_of(report, grid::resample(grid::HuVolume(second.volume), {{2, 2, 7}}));
    if (kind == 5) {  // a slab across the body's axis, which is the second one of its lattice
      const int from = static_cast<int>(n) / 6 * 9, to = std::min(size[1], from + 30);
      moving = grid::crop(second.volume, {{0, from, 0}, {size[0], to, size[2]}});
    }
    const itk::Registration r = itk::register_scans(ct, moving, nullptr, {}, quick);
    const double error = target_error_mm(r.map, second.truth, places);
    std::printf("%2d kind %d: %.2f mm %s\n", static_cast<int>(n), kind, error, r.doubts.c_str());
    ++all;
    published += r.doubts.empty();
    right += error < 1;
    if (r.doubts.empty()) worst = std::max(worst, error);
  }
  std::printf("%d scans, %d right, %d published, of these the worst %.2f mm\n", all, right, published, worst);
  EXPECT_LT(worst, 2);
  EXPECT_GT(published, all / 2);
}
