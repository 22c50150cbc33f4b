// SPDX-License-Identifier: GPL-3.0-or-later
// The confidence of landmarks is held to what the scan shows.
#include <gtest/gtest.h>

#include <cmath>

#include "craniometry_found.h"
#include "head/landmarks_parts.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace craniometry_test;

TEST(LongLandmarksEarned, KochersPointsAreNoSurerThanTheBregma) {
  const head::HeadLandmarks seen = find(scene());
  ASSERT_TRUE(seen.find("bregma"));
  for (const char* name : {"kocher_left", "kocher_right"})
    EXPECT_LE(confidence(seen, name), confidence(seen, "bregma")) << name;
  // Without a vault there is nothing of a suture, and what is left of the bregma is an estimate.
  LandmarkScene s = scene();
  std::visit(
      [](auto& g) {
        for (auto& v : g.voxels)
          if (v > 400) v = 900;  // bone of one density: no suture shows
      },
      s.volume);
  Report report;
  const head::HeadLandmarks none = find(s, report);
  ASSERT_TRUE(none.find("bregma") && none.find("kocher_left"));
  EXPECT_EQ(none.find("bregma")->source, "estimated");
  for (const char* name : {"kocher_left", "kocher_right"})
    EXPECT_LE(confidence(none, name), confidence(none, "bregma")) << name;
  // A bregma that a person placed is sure.
  head::LandmarkInputs in = s.inputs();
  in.given = {{"bregma", none.find("bregma")->position_mm, 1, "given"}};
  EXPECT_GT(confidence(value_of(report, head::find_landmarks(s.volume, in, {})), "kocher_left"), 0.8);
}

/// Every n-th slice as a scan of slices so thick.
LandmarkScene of_thick_slices(int n) {
  phantom::HeadParams who;
  who.seed = 3;
  phantom::ScanParams how;
  how.columns_count = how.rows_count = 180;
  how.slices_count = 190 / n;
  how.pixel_mm = 1.3;
  how.slice_step_mm = how.slice_thickness_mm = n;
  how.subvoxel_mm = 1.3;
  return make_scene(who, how);
}

TEST(LongLandmarksEarned, ThickSlicesAllowNoCertainty) {
  for (const int slice_mm : {5, 7}) {
    const head::HeadLandmarks found = find(of_thick_slices(slice_mm));
    const double most = 1 / (1 + slice_mm * slice_mm / 100.0);
    EXPECT_FALSE(found.landmarks.empty());
    for (const cases::CaseLandmark& l : found.landmarks) {
      EXPECT_LE(l.confidence, most + 1e-9) << l.name << " in slices of " << slice_mm << " mm";
      for (const auto& [name, at] : scene().head.landmarks())
        if (name == l.name && l.confidence >= 0.5) {
          EXPECT_LT(norm(l.position_mm - at), 8) << name;
        }
    }
  }
}

TEST(LongLandmarksEarned, AHeadThatMovedBelowKochersPointsMakesThemLessSure) {
  const auto found_in = [](double motion_mm) {
    phantom::HeadParams who;
    who.seed = 3;
    who.level = phantom::Level::hard;
    who.hard.motion_mm = motion_mm;
    phantom::ScanParams how;
    how.columns_count = how.rows_count = 180;
    how.slices_count = 95;
    how.pixel_mm = 1.3;
    how.slice_step_mm = how.slice_thickness_mm = 2;
    how.subvoxel_mm = 1.3;
    return find(make_scene(who, how));
  };
  const head::HeadLandmarks still = found_in(0), moved = found_in(5);
  for (const char* name : {"kocher_left", "kocher_right"}) {
    EXPECT_GT(confidence(still, name), 0.8) << name;
    EXPECT_GT(confidence(moved, name), 0.3) << name;
    EXPECT_LT(confidence(moved, name), 0.55) << name;
  }
  EXPECT_GT(confidence(moved, "nasion"), 0.8);  // it lies where the slices show it
}

TEST(LandmarksEarned, AnEarThatIsCutOffBelowIsDoubtful) {
  const double all = 1e4;
  for (const double z : {-18.0, -12.0, -6.0}) {
    const head::HeadLandmarks found = find(cut(scene(), {-all, -all, z}, {all, all, all}));
    for (const char* name : {"tragus_left", "tragus_right"})
      if (confidence(found, name) >= 0.5) {
        EXPECT_LT(norm(found.find(name)->position_mm - scene().head.landmark(name)), 4) << name << " " << z;
      }
  }
  const head::HeadLandmarks rim = find(cut(scene(), {-all, -all, 2}, {all, all, all}));
  for (const char* name : {"tragus_left", "tragus_right"}) EXPECT_LT(confidence(rim, name), 0.5) << name;
}

TEST(LandmarksEarned, AnEarOnWhichSomethingLayIsDoubtful) {
  const LandmarkScene& s = scene();
  grid::HuVolume as_read = s.volume;
  const Vec3 ear = s.head.landmark("tragus_left");
  std::visit(
      [&](auto& g) {
        for (int k = 0; k < g.size[2]; ++k)
          for (int j = 0; j < g.size[1]; ++j)
            for (int i = 0; i < g.size[0]; ++i) {
              const Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
              if (p.x > 60 && norm(p - ear) < 45 && g.at(i, j, k) < -900) g.at(i, j, k) = 100;  // a pad on the ear
            }
      },
      as_read);
  head::LandmarkInputs in = s.inputs();
  in.as_read = &as_read;
  const head::HeadLandmarks found = head::find_landmarks(s.volume, in, {}).value;
  EXPECT_LT(confidence(found, "tragus_left"), 0.5);
  in.as_read = &s.volume;  // nothing was taken off
  const head::HeadLandmarks bare = head::find_landmarks(s.volume, in, {}).value;
  for (const char* name : {"tragus_left", "tragus_right"}) EXPECT_GT(confidence(bare, name), 0.8) << name;
  // With one ear doubtful the other is too, and with them the level by which these are found.
  for (const char* name : {"inion", "vertex"}) EXPECT_LT(confidence(found, name), 0.6 * confidence(bare, name)) << name;
}

// The reason that a doubtful landmark is given is the one that lowered it most, and names no figure that is harmless.
TEST(LandmarksEarned, TheStrongestReasonIsGiven) {
  mask::ScanFigures thick;
  thick.slice_step_mm = 4.9;
  thick.tiles_count = 100;
  thick.noise_hu = 4;
  head::HeadLandmarks all;
  for (const char* name : {"inion", "nasion", "tragus_left"}) all.landmarks.push_back({name, {}, 0.6, "found"});
  head::Reasons reasons;
  head::hold_to_scan(all, {}, thick, reasons);
  EXPECT_EQ(reasons.of("inion"), "slices of 4.9 mm show it no better");
  head::lower_confidence(all.landmarks[2], 0.4, "no ear", reasons);
  head::hold_to_level(all, {}, reasons);
  EXPECT_EQ(reasons.of("inion"), "the tragi and the nasion, by which the head is levelled, are doubtful");
  EXPECT_EQ(reasons.of("tragus_left"), "no ear");
  EXPECT_EQ(reasons.of("nasion"), "slices of 4.9 mm show it no better");
  EXPECT_EQ(reasons.of("vertex"), "");
  thick.noise_hu = 150;
  head::Reasons noisy;
  head::hold_to_scan(all, {}, thick, noisy);
  EXPECT_EQ(noisy.of("nasion"), "slices of 4.9 mm and noise of 150 HU show it no better");
}

}  // namespace
}  // namespace trephine
