// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of bodies whose line integrals are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <map>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "fluoro/fluoro_thread.h"
#include "fluoro/fluoroscope.h"

using namespace trephine;

namespace {

constexpr int bone_hu = 800;
constexpr double bone_per_mm = fluoro::water_per_mm * (1 + bone_hu / 1000.0);

// n^3 voxels about the origin, possibly oblique; HU by how much of the voxel the body fills.
template <class F>
grid::Grid<std::int16_t> ct_of(int n, double side_mm, F inside_mm, bool oblique = false) {
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = {side_mm, side_mm, side_mm};
  if (oblique) {
    const Vec3 z = normalized(Vec3{0.1, -0.2, 0.9}), x = normalized(cross(Vec3{0.1, 1, 0.2}, z));
    l.direction.column = {x, cross(z, x), z};
  }
  const double half = 0.5 * (n - 1);
  l.origin_mm = l.direction * Vec3{-half * side_mm, -half * side_mm, -half * side_mm};
  grid::Grid<std::int16_t> ct(l, -1000);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double share =
            std::clamp(0.5 + inside_mm(l.to_world_mm({double(i), double(j), double(k)})) / side_mm, 0.0, 1.0);
        ct.at(i, j, k) = std::int16_t(std::lround(-1000 + share * (1000 + bone_hu)));
      }
  return ct;
}

fluoro::CArmParams free_arm(double orbit, double tilt, bool parallel = false) {
  fluoro::CArmParams a;
  a.view = fluoro::CArmParams::View::free;
  a.orbit_deg = orbit;
  a.tilt_deg = tilt;
  if (parallel) a.source_to_centre_mm = 0;
  a.detector_mm = parallel ? 160 : 260;
  return a;
}

// The share of the ray within the ball.
double ball_chord(const fluoro::CArm::Ray& r, Vec3 c, double radius) {
  const Vec3 d = c - r.from_mm;
  const double off2 = dot(d, d) - dot(d, r.direction) * dot(d, r.direction);
  return off2 < radius * radius ? 2 * std::sqrt(radius * radius - off2) : 0;
}

}  // namespace

TEST(Fluoro, ABallWithinOnePercentOfItsChordsInEveryPose) {
  const Vec3 centre{4, -7, 9};
  const double radius = 40;
  for (const bool oblique : {false, true}) {
    const fluoro::FluoroVolume volume(ct_of(
        128, 1, [&](Vec3 p) { return radius - norm(p - centre); }, oblique));
    for (const auto& [orbit, tilt] :
         std::vector<std::pair<double, double>>{{0, 0}, {90, 0}, {33, 20}, {-71, -40}, {200, 75}}) {
      const fluoro::CArm arm(free_arm(orbit, tilt), 64);
      const fluoro::FluoroIntegrals picture = volume.integrals(arm);
      double worst = 0, most = 0;
      int seen = 0;
      double sum = 0, sum_truth = 0;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          const double truth = bone_per_mm * ball_chord(arm.ray(x + 0.5, y + 0.5), centre, radius);
          const double is = double(picture.integral[std::size_t(y * 64 + x)]);
          most = std::max(most, truth);
          // At the rim a chord changes within a voxel: there in parts of the whole.
          if (truth > 0.4 * bone_per_mm * 2 * radius) {
            worst = std::max(worst, std::abs(is - truth) / (bone_per_mm * 2 * radius));
            ++seen;
          } else {
            EXPECT_LT(std::abs(is - truth), 0.08 * bone_per_mm * 2 * radius);
          }
          sum += is;
          sum_truth += truth;
        }
      EXPECT_GT(seen, 250);
      EXPECT_LT(worst, 0.01) << orbit << " " << tilt;
      EXPECT_NEAR(sum / sum_truth, 1, 0.002);
      EXPECT_NEAR(most, bone_per_mm * 2 * radius, 0.02 * most);
    }
  }
}

TEST(Fluoro, ASlabWithinOnePercentOfItsLengths) {
  // 20 mm thick across y; rays cross it at any slant.
  const fluoro::FluoroVolume volume(ct_of(128, 1, [](Vec3 p) { return 10 - std::abs(p.y); }));
  for (const auto& [orbit, tilt] : std::vector<std::pair<double, double>>{{0, 0}, {25, 0}, {-40, 15}, {0, 35}}) {
    const fluoro::CArm arm(free_arm(orbit, tilt), 32);
    int seen = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const fluoro::CArm::Ray r = arm.ray(x + 0.5, y + 0.5);
        const double enter = (-10 - r.from_mm.y) / r.direction.y, leave = (10 - r.from_mm.y) / r.direction.y;
        bool within = true;  // of the volume, both times
        for (const double t : {enter, leave}) {
          const Vec3 p = r.from_mm + r.direction * t;
          within = within && std::abs(p.x) < 62 && std::abs(p.z) < 62;
        }
        if (!within) continue;
        ++seen;
        EXPECT_NEAR(volume.along(r), bone_per_mm * std::abs(leave - enter),
                    0.01 * bone_per_mm * std::abs(leave - enter));
      }
    EXPECT_GT(seen, 100);
  }
  // A slab that fills the volume to its border.
  const fluoro::FluoroVolume full(ct_of(64, 1, [](Vec3) { return 10.0; }));
  EXPECT_NEAR(full.along({{0, -500, 0}, {0, 1, 0}}), bone_per_mm * 64, 1e-6);
  EXPECT_EQ(full.along({{0, -500, 40}, {0, 1, 0}}), 0);
}

TEST(Fluoro, TurnedByHalfATurnTheParallelPictureIsItsMirrorImage) {
  const fluoro::FluoroVolume volume(ct_of(96, 1.1, [](Vec3 p) {
    return std::max(25 - norm(p - Vec3{20, 5, -8}), 9 - norm(p - Vec3{-30, -20, 25}));
  }));
  const fluoro::FluoroIntegrals a = volume.integrals(fluoro::CArm(free_arm(40, 0, true), 96));
  const fluoro::FluoroIntegrals b = volume.integrals(fluoro::CArm(free_arm(220, 0, true), 96));
  double worst = 0, most = 0, unlike = 0;
  for (std::size_t y = 0; y < 96; ++y)
    for (std::size_t x = 0; x < 96; ++x) {
      most = std::max(most, double(a.integral[y * 96 + x]));
      worst = std::max(worst, std::abs(double(a.integral[y * 96 + x]) - double(b.integral[y * 96 + 95 - x])));
      unlike = std::max(unlike, std::abs(double(a.integral[y * 96 + x]) - double(b.integral[y * 96 + x])));
    }
  EXPECT_LT(worst, 1e-4 * most);
  EXPECT_GT(unlike, 0.5 * most);
}

TEST(Fluoro, TheNeedlesTipIsWhereItIsProjected) {
  const grid::Grid<std::int16_t> ct = ct_of(96, 1, [](Vec3 p) { return 30 - norm(p); });
  fluoro::Fluoroscope scope(ct);
  for (const auto& [orbit, tilt] : std::vector<std::pair<double, double>>{{0, 0}, {90, 0}, {30, 25}, {150, -30}}) {
    fluoro::CArmParams params = free_arm(orbit, tilt);
    constexpr int size = 256;
    const fluoro::CArm arm(params, size);
    const fluoro::MetalRod needle{{3, 4, -5}, {45, 30, 60}, 2.5};
    const fluoro::FluoroPicture without = scope.picture(params, size, {}), with = scope.picture(params, size, {needle});
    // Half of the brightest change, nearest to the tip along the needle's picture.
    const auto tip = arm.project(needle.tip_mm), tail = arm.project(needle.tail_mm);
    const double length = std::hypot(tail[0] - tip[0], tail[1] - tip[1]);
    ASSERT_GT(length, 20);
    const double ux = (tail[0] - tip[0]) / length, uy = (tail[1] - tip[1]) / length;
    double inner = 1e9;
    int changed = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        if (with.grey[std::size_t(y * size + x)] < without.grey[std::size_t(y * size + x)] + 20) continue;
        ++changed;
        const double dx = x + 0.5 - tip[0], dy = y + 0.5 - tip[1];
        EXPECT_LT(std::abs(dx * uy - dy * ux), 3.2);  // beside the needle nothing changes
        if (std::abs(dx * uy - dy * ux) < 0.5) inner = std::min(inner, dx * ux + dy * uy);
      }
    EXPECT_GT(changed, 60);
    // A needle that comes towards the eye has a round end: its flat end is seen slantwise, by its radius at most.
    const double slant = std::abs(dot(normalized(needle.tail_mm - needle.tip_mm), arm.beam()));
    EXPECT_LT(inner, 0.5 + 1e-9) << orbit;
    EXPECT_GT(inner, -0.5 - slant * 1.25 * length / norm(needle.tail_mm - needle.tip_mm) * 2) << orbit;
  }
}

// A point at the patient's left is seen at the edge that says L.
TEST(Fluoro, TheLettersAreThePatientsSides) {
  for (const double orbit : {0.0, 30.0, 90.0, 180.0, 210.0, 270.0, -90.0}) {
    fluoro::CArmParams p;
    p.view = fluoro::CArmParams::View::free;
    p.orbit_deg = orbit;
    const fluoro::CArm arm(p, 256);
    const auto [at_left, at_right] = arm.side_letters();
    const std::map<std::string, Vec3> sides = {
        {"L", {40, 0, 0}}, {"R", {-40, 0, 0}}, {"A", {0, -40, 0}}, {"P", {0, 40, 0}}};
    EXPECT_LT(arm.project(sides.at(at_left))[0], 128) << orbit;
    EXPECT_GT(arm.project(sides.at(at_right))[0], 128) << orbit;
    EXPECT_EQ(std::string(at_left) == "A" || std::string(at_left) == "P", std::abs(std::cos(orbit * M_PI / 180)) < 0.6);
  }
}

TEST(Fluoro, ChordsOfARod) {
  const fluoro::MetalRod rod{{0, 0, 0}, {0, 0, 10}, 4};
  EXPECT_NEAR(fluoro::chord_mm(rod, {{-50, 0, 5}, {1, 0, 0}}), 4, 1e-12);
  EXPECT_NEAR(fluoro::chord_mm(rod, {{-50, 1, 5}, {1, 0, 0}}), 2 * std::sqrt(3.0), 1e-12);
  EXPECT_EQ(fluoro::chord_mm(rod, {{-50, 2.1, 5}, {1, 0, 0}}), 0);
  EXPECT_EQ(fluoro::chord_mm(rod, {{-50, 0, 10.5}, {1, 0, 0}}), 0);
  EXPECT_NEAR(fluoro::chord_mm(rod, {{0.5, 0.5, -50}, {0, 0, 1}}), 10, 1e-12);
  EXPECT_EQ(fluoro::chord_mm(rod, {{3, 0, -50}, {0, 0, 1}}), 0);
  EXPECT_NEAR(fluoro::chord_mm(rod, {{0, 0, 5}, normalized(Vec3{1, 0, 1})}), 2 * 2 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(fluoro::chord_mm({{1, 1, 1}, {1, 1, 1}, 3}, {{0, 1, 1}, {1, 0, 0}}), 0);
}

TEST(Fluoro, TheSamePictureWhateverTheThreadCountAndFromWhatIsKept) {
  const grid::Grid<std::int16_t> ct = ct_of(64, 1.5, [](Vec3 p) { return 30 - norm(p - Vec3{5, 3, 1}); });
  fluoro::Fluoroscope scope(ct);
  set_thread_count(1);
  const fluoro::FluoroPicture one = scope.picture(free_arm(20, 10), 100, {});
  set_thread_count(0);
  fluoro::Fluoroscope other(ct);
  EXPECT_EQ(one.grey, other.picture(free_arm(20, 10), 100, {}).grey);
  EXPECT_NE(one.grey, scope.picture(free_arm(25, 10), 100, {}).grey);
  EXPECT_EQ(one.grey, scope.picture(free_arm(20, 10), 100, {}).grey);
}

namespace {

// Waits for a picture of that size.
fluoro::MadeFluoro wait_for(fluoro::FluoroThread& thread, int size) {
  for (int n = 0; n < 60000; ++n) {
    if (auto made = thread.take(); made && made->picture.size == size) return *made;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ADD_FAILURE() << "no picture";
  return {};
}

}  // namespace

TEST(FluoroThread, ShowsWhatTheFluoroscopeShowsAndTheNewestNeedle) {
  const grid::Grid<std::int16_t> ct = ct_of(96, 1, [](Vec3 p) { return 30 - norm(p - Vec3{5, 3, 1}); });
  constexpr int size = 128;
  fluoro::FluoroThread thread(ct, size);
  fluoro::Fluoroscope scope(ct);
  const auto needle = [](double z) { return std::vector<fluoro::MetalRod>{{{3, 4, z}, {45, 30, z + 60}, 2.5}}; };
  // Of the arm alone nothing is shown.
  thread.move(free_arm(20, 0));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(thread.take());
  thread.show(free_arm(20, 0), needle(-5));
  EXPECT_EQ(wait_for(thread, size).picture.grey, scope.picture(free_arm(20, 0), size, needle(-5)).grey);
  EXPECT_FALSE(thread.take());  // each is given once
  // The needle moves many times: the last one is seen, and never one of another place of the arm.
  for (int n = 0; n < 50; ++n) thread.show(free_arm(20, 0), needle(0.2 * n - 5));
  fluoro::MadeFluoro last = wait_for(thread, size);
  while (!HasFailure() && last.metal[0].tip_mm.z < needle(0.2 * 49 - 5)[0].tip_mm.z) last = wait_for(thread, size);
  EXPECT_GE(last.waited_s, 0);
  EXPECT_EQ(last.picture.grey, scope.picture(free_arm(20, 0), size, needle(0.2 * 49 - 5)).grey);
  // To another place while the last picture of this one is still to be made: both are.
  thread.show(free_arm(70, 10), needle(0));
  thread.move(free_arm(-30, 0));
  const fluoro::MadeFluoro moved = wait_for(thread, size);
  EXPECT_EQ(moved.arm.orbit_deg, 70);
  EXPECT_EQ(moved.picture.grey, scope.picture(free_arm(70, 10), size, needle(0)).grey);
}

TEST(FluoroThread, ACoarsePictureComesFirstAndTheEndIsAtOnce) {
  const grid::Grid<std::int16_t> ct = ct_of(160, 1, [](Vec3 p) { return 70 - norm(p); });
  fluoro::FluoroThread thread(ct,
                              2048);  // the coarse one is there to be taken while the whole one is made: for seconds
  thread.show(free_arm(0, 0), {});
  EXPECT_EQ(wait_for(thread, 1024).picture.size, 1024);
  // While the whole one is made, the arm goes elsewhere, and the object ends.
  thread.show(free_arm(90, 0), {});
  // Of a picture that would take minutes hardly anything is made. Work is counted, for time is the machine's load.
  const std::clock_t before = std::clock();
  {
    fluoro::FluoroThread other(ct, 8192);
    other.show(free_arm(10, 0), {});
  }
  EXPECT_LT(double(std::clock() - before) / CLOCKS_PER_SEC, 20);
  EXPECT_THROW(fluoro::FluoroThread(grid::Grid<std::int16_t>(), 512), Error);
}

// While the arm turns, pictures of half the size follow, each of where it was; once it stands the whole one comes.
TEST(FluoroThread, ATurningArmIsSeen) {
  const grid::Grid<std::int16_t> ct = ct_of(160, 1, [](Vec3 p) { return 70 - norm(p - Vec3{9, 2, 4}); });
  constexpr int size = 512;
  fluoro::FluoroThread thread(ct, size);
  fluoro::Fluoroscope scope(ct);
  int seen = 0;
  double orbit = 0;
  for (; seen < 3 && orbit < 200; orbit += 0.1) {
    thread.show(free_arm(orbit, 0), {});
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto made = thread.take();
    if (!made) continue;
    // Where this thread stood still for as long as a whole picture takes, so did the arm.
    if (made->picture.size == size) continue;
    ++seen;
    EXPECT_EQ(made->picture.size, size / 2);
    EXPECT_LE(made->arm.orbit_deg, orbit);
    EXPECT_EQ(made->picture.grey, scope.picture(made->arm, size / 2, {}).grey);
  }
  EXPECT_EQ(seen, 3);
  thread.show(free_arm(orbit, 0), {});
  EXPECT_EQ(wait_for(thread, size).arm.orbit_deg, orbit);
}

// Printed, and bounded loosely: the machine's load is not the program's.
TEST(Fluoro, TimesOfAPicture) {
  grid::Grid<std::int16_t> ct = ct_of(256, 1, [](Vec3 p) { return 100 - norm(p); });
  const auto seconds = [&](int size, const fluoro::CArmParams& params) {
    const fluoro::FluoroVolume volume(ct);
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    const fluoro::FluoroIntegrals picture = volume.integrals(fluoro::CArm(params, size));
    EXPECT_GT(picture.integral[std::size_t(size * size / 2 + size / 2)], 1);
    return std::array<double, 2>{std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
                                 double(std::clock() - before) / CLOCKS_PER_SEC};
  };
  for (const double orbit : {0.0, 90.0, 37.0})
    for (const int size : {256, 512}) {
      fluoro::CArmParams arm = free_arm(orbit, 10);
      arm.detector_mm = 400;
      const auto [wall, cpu] = seconds(size, arm);
      std::printf("through 256^3, orbit %g, %d x %d: %.3f s, of all cores %.3f s\n", orbit, size, size, wall, cpu);
      EXPECT_LT(cpu, size > 256 ? 20 : 5);
    }
}
