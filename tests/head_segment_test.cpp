// SPDX-License-Identifier: GPL-3.0-or-later
// Brain and ventricles of an analytic head: nested ellipsoids with noise, a foramen magnum, a canal, a passage out.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "head/brain.h"
#include "head/ventricles.h"
#include "head_recipe.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

double ellipsoid(Vec3 p, Vec3 at, Vec3 r) {  // < 1 inside
  const Vec3 d = p - at;
  return norm({d.x / r.x, d.y / r.y, d.z / r.z});
}

bool in_ventricles(Vec3 p) {
  for (double side : {-1.0, 1.0})
    if (ellipsoid(p, {side * 11, 0, 8}, {7, 27, 7}) < 1) return true;
  return ellipsoid(p, {0, 0, -4}, {3, 13, 10}) < 1;
}
bool in_brain(Vec3 p) { return ellipsoid(p, {0, 0, 0}, {63, 78, 58}) < 1 && p.z > -50; }

/// 1.0 x 1.0 x 2.0 mm, noise of `noise_hu`, all soft tissue `shift_hu` brighter than usual.
grid::Grid<std::int16_t> head(double noise_hu, double shift_hu = 0) {
  grid::Grid<std::int16_t> g;
  static_cast<grid::Lattice&>(g) = [] {
    grid::Lattice l;
    l.size = {170, 200, 80};
    l.spacing_mm = {1, 1, 2};
    l.origin_mm = {-84.5, -99.5, -90};
    return l;
  }();
  g.voxels.resize(g.count());
  unsigned state = 3;
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        const Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
        double hu = -1000;
        const double inner = ellipsoid(p, {0, 0, 0}, {66, 81, 61}), outer = ellipsoid(p, {0, 0, 0}, {73, 88, 68});
        const double canal = std::hypot(p.x, p.y - 20);
        if (ellipsoid(p, {0, 0, 0}, {79, 94, 73}) < 1 || (p.z < -30 && std::hypot(p.x, p.y - 10) < 55)) hu = 40;
        if (outer < 1) hu = 1200;
        if (p.z < -55 && canal < 16) hu = canal < 11 ? 8 : 1200;  // vertebrae round the canal
        if (inner < 1) hu = 8;
        if (p.z < -50 && canal < 15 && outer < 1) hu = 8;  // foramen magnum
        if (in_brain(p)) hu = 31;
        if (in_ventricles(p)) hu = 8;
        if (p.z < -10 && p.z > -70 && std::hypot(p.x, p.y - 14) < 1.0) hu = 8;  // a thin passage to the cisterns
        if (hu > -500 && hu < 100) hu += shift_hu;
        double noise = 0;
        for (int n = 0; n < 12; ++n) {
          state = state * 1664525u + 1013904223u;
          noise += (state >> 8) / double(1u << 24) - 0.5;
        }
        g.at(i, j, k) = std::int16_t(std::lround(hu + noise_hu * noise));
      }
  return g;
}

template <class Truth>
double dice(const grid::Field& f, const grid::Lattice& l, Truth&& truth) {
  const grid::Box at = grid::place_in(f, l);
  double both = 0, sum = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const int a = i - at.begin[0], b = j - at.begin[1], c = k - at.begin[2];
        const bool found = f.contains(a, b, c) && f.at(a, b, c) > 0;
        const bool is = truth(l.to_world_mm({double(i), double(j), double(k)}));
        both += found && is;
        sum += int(found) + int(is);
      }
  return 2 * both / sum;
}

head_recipe::Fields segment_head(const grid::HuVolume& volume) {
  head_recipe::Fields f;
  f.skull = segmentation::segment(volume, {}, head_recipe::skull()).value;
  f.brain = head::find_brain(volume, {&f.skull, nullptr, nullptr}, head_recipe::brain(22)).value;
  f.ventricles = head::find_ventricles(volume, {&f.brain, nullptr}, {}).value;
  return f;
}

TEST(SegmentHead, BrainAndVentriclesOfNestedEllipsoids) {
  for (double shift : {0.0, -8.0}) {  // a scanner that is off by 8 HU
    const auto volume = head(6, shift);
    const head_recipe::Fields a = segment_head(volume);
    EXPECT_GT(dice(a.brain, volume, [](Vec3 p) { return in_brain(p); }), 0.97) << shift;
    EXPECT_GT(dice(a.ventricles, volume, [](Vec3 p) { return in_ventricles(p); }), 0.92) << shift;
    const Vec3 cord = a.brain.to_index({0, 20, -85});
    EXPECT_LT(cord.z, 0) << "the spinal canal is left out";
  }
}

// A holder's streaks in a few slices look like horns.
TEST(SegmentHead, StreaksBesideTheVentriclesAreNoneOfThem) {
  auto streaked = head(6);
  const head_recipe::Fields sound = segment_head(streaked);
  for (int k = 0; k < streaked.size[2]; ++k)
    for (int j = 0; j < streaked.size[1]; ++j)
      for (int i = 0; i < streaked.size[0]; ++i) {
        const Vec3 p = streaked.to_world_mm({double(i), double(j), double(k)});
        const double across = 0.94 * p.y - 0.34 * p.x;
        if (p.z > 3 && p.z < 10 && in_brain(p))
          streaked.at(i, j, k) += std::int16_t(std::lround(18 * std::sin(across / 3.5 + std::sin(across / 15))));
      }
  Report report;
  const grid::Field found = value_of(report, head::find_ventricles(streaked, {&sound.brain, nullptr}, {}));
  const auto truth = [](Vec3 p) { return in_ventricles(p); };
  EXPECT_GT(dice(found, streaked, truth), 0.9) << dice(sound.ventricles, streaked, truth) << " without streaks";
  int said = 0;
  for (const std::string& w : report.warnings) said += w.rfind("streaks of", 0) == 0;
  EXPECT_EQ(said, 1);
}

TEST(SegmentHead, WithoutASkullItFindsBoneItself) {
  const auto volume = head(6);
  head::BrainParams p;
  p.lower_hu = 22;
  Report report;
  const grid::Field brain = value_of(report, head::find_brain(volume, {}, p));
  EXPECT_GT(dice(brain, volume, [](Vec3 x) { return in_brain(x); }), 0.97);
  ASSERT_NE(report.find("cranial_cavity_ml"), nullptr);
}

TEST(SegmentHead, WhatCannotBeABrainIsRefused) {
  const grid::HuVolume volume = head(6);
  const grid::Field envelope = head::find_brain(volume, {}, {}).value;
  EXPECT_GT(dice(envelope, grid::lattice_of(volume), [](Vec3 x) { return in_brain(x); }), 0.97);
  head::VentriclesParams ventricles;
  ventricles.lower_hu = 20;
  EXPECT_THROW(head::find_ventricles(volume, {&envelope, nullptr}, ventricles), Error) << "above upper_hu's default";
  try {
    head::find_ventricles(volume, {}, {});
    ADD_FAILURE() << "ventricles without a brain";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::usage);
  }
  // What is not of one value only is looked at.
  const grid::Field skull = segmentation::segment(volume, {}, {}).value;
  try {
    head::find_brain(grid::Grid<std::int16_t>(grid::lattice_of(volume), 40), {&skull, nullptr, nullptr}, {});
    ADD_FAILURE() << "a brain in a constant image";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_EQ(e.field(), "volume");
  }
}

TEST(SegmentHead, TheSameBitsWithOneAndTwoThreadsAndAtTheSameTime) {
  const grid::HuVolume volume = head(6);
  const int before = thread_count();
  set_thread_count(1);
  const head_recipe::Fields one = segment_head(volume);
  set_thread_count(2);
  head_recipe::Fields beside;
  std::thread other([&] { beside = segment_head(volume); });
  const head_recipe::Fields again = segment_head(volume);
  other.join();
  set_thread_count(before);
  for (const head_recipe::Fields* a : std::initializer_list<const head_recipe::Fields*>{&beside, &again}) {
    EXPECT_TRUE(a->skull.voxels == one.skull.voxels && a->skull.size == one.skull.size);
    EXPECT_TRUE(a->brain.voxels == one.brain.voxels && a->brain.size == one.brain.size);
    EXPECT_TRUE(a->ventricles.voxels == one.ventricles.voxels && a->ventricles.size == one.ventricles.size);
  }
}

TEST(SegmentHead, CanBeCancelled) {
  const grid::HuVolume volume = head(6);
  std::atomic<bool> cancel{true};
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  EXPECT_THROW(segmentation::segment(volume, {}, p, Progress({}, &cancel)), Cancelled);
}

}  // namespace
}  // namespace trephine
