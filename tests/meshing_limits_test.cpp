// SPDX-License-Identifier: GPL-3.0-or-later
// Soups that are made to take long: equal triangles, fans of thousands; limits of time that hold, and the total bound
// of a chain.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "base/pi.h"
#include "base/time_limit.h"
#include "meshing/decimate.h"
#include "meshing/repair.h"
#include "meshing/smooth.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"
#include "surface/incidence.h"

namespace trephine {
namespace {

using namespace shapes;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A ball, and a triangle through it many times over.
surface::TriMesh with_copies(int copies) {
  surface::TriMesh m = contoured(sphere(30, 10));
  const auto base = static_cast<std::uint32_t>(m.points_mm.size());
  for (const Vec3 p : {Vec3{-30, 1, 1}, Vec3{30, 2, 1}, Vec3{0, 30, 2}}) m.points_mm.push_back(p);
  for (int i = 0; i < copies; ++i) m.triangles.push_back({base, base + 1, base + 2});
  return m;
}

TEST(Limits, EqualTrianglesAreCountedNotPaired) {
  constexpr int copies = 100000;  // 5e9 pairs
  const meshing::Validity v = meshing::check_validity(with_copies(copies));
  EXPECT_EQ(v.topology.duplicate_triangles, std::size_t(copies - 1));
  EXPECT_GE(v.self_intersections, std::size_t(copies - 1)) << "each with the first";
  EXPECT_LT(v.self_intersections, std::size_t(copies + 5000)) << "and the first with the ball";
  EXPECT_FALSE(v.valid());
}

TEST(Limits, AFanOfThousandsIsCountedSoon) {
  // A disc of 100,000 triangles about one point, and another one that meets it there.
  surface::TriMesh m;
  m.points_mm = {{0, 0, 0}};
  constexpr std::uint32_t n = 100000;
  for (const double z : {1.0, -1.0})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2 * pi * i / n;
      m.points_mm.push_back({10 * std::cos(a), 10 * std::sin(a), z});
    }
  for (std::uint32_t d = 0; d < 2; ++d)
    for (std::uint32_t i = 0; i < n; ++i) m.triangles.push_back({0, 1 + d * n + i, 1 + d * n + (i + 1) % n});
  EXPECT_EQ(surface::count_fans(m, surface::Incidence(m), 0), 2);
  EXPECT_EQ(surface::topology_of(m).nonmanifold_points, 1u);
}

TEST(Limits, RepairGivesUpAfterAllOfItsTimeAndWhenAskedTo) {
  meshing::RepairParams p;
  p.total_limit_s = 0.01;
  p.recontour_voxels_count = 900;  // takes longer
  const surface::TriMesh soup = with_copies(3);
  Report report;
  const auto start = Clock::now();
  try {
    value_of(report, meshing::repair(soup, p));
    ADD_FAILURE() << "no limit";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::internal);
    EXPECT_EQ(e.field(), "total_limit_s");
  }
  p.total_limit_s = 36000;
  std::atomic<bool> cancel{false};
  std::thread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    cancel = true;
  });
  EXPECT_THROW(value_of(report, meshing::repair(soup, p, Progress(nullptr, &cancel))), Cancelled);
  user.join();
  // What both would take is minutes; this bound is for a machine that does much else beside it.
  EXPECT_LT(seconds_since(start), 300);
}

TEST(Limits, ATimeLimitPassesOnWhatHappensWithinIt) {
  EXPECT_EQ(within_time(60, {}, [](const TimeLimit& limit) { return limit.left_s() > 50 ? 3 : 0; }), 3);
  const std::atomic<bool> cancelled{true};
  const Progress outer(nullptr, &cancelled);
  EXPECT_THROW(within_time(60, outer,
                           [](const TimeLimit& limit) {
                             for (;;) limit.progress().check();
                           }),
               Cancelled);
}

TEST(Limits, AChainKeepsTheBoundThatWasAskedFor) {
  const surface::TriMesh ball = contoured(sphere(60, 20));
  meshing::DecimateParams fewer;
  fewer.max_deviation_mm = 0.3;
  fewer.target_triangles_count = 4;
  Report report;
  const surface::TriMesh rough = value_of(report, meshing::decimate(ball, fewer));
  meshing::SmoothParams p;
  p.max_displacement_mm = 0.3;
  p.iterations_count = 50;
  p.pass_band_ratio = 0.1;
  p.max_volume_change_percent = 100;
  Report free;
  value_of(free, meshing::smooth(rough, p, {}, &ball));
  const auto figure = [](const Report& r, const char* name) { return std::get<double>(*r.find(name)); };
  EXPECT_GT(figure(free, "reference_distance_max_mm"), 0.3) << "the control: without the bound it is broken";
  p.total_deviation_mm = 0.3;
  Report kept;
  const surface::TriMesh smoothed = value_of(kept, meshing::smooth(rough, p, {}, &ball));
  EXPECT_LE(figure(kept, "reference_distance_max_mm"), 0.3);
  EXPECT_EQ(figure(kept, "total_deviation_proven_mm"), 0.3);
  EXPECT_TRUE(meshing::check_validity(smoothed).valid());
  // A bound that is broken before anything moves, and one without what it is to.
  p.total_deviation_mm = 0.05;
  const auto code = [&](const surface::TriMesh* reference) {
    try {
      value_of(kept, meshing::smooth(rough, p, {}, reference));
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code(&ball), ExitCode::quality);
  EXPECT_EQ(code(nullptr), ExitCode::usage);
}

}  // namespace
}  // namespace trephine
