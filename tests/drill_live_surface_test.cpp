// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that follows while a shape is drilled: closed, and the same as one made anew.
#include <gtest/gtest.h>
#include <time.h>

#include <atomic>
#include <cstring>
#include <thread>

#include "drill/cell_triangles.h"
#include "drill_closed.h"
#include "drill_scene.h"

using namespace trephine;
using namespace trephine::drilling;

namespace {

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e6 + double(t.tv_nsec) * 1e-3;
}

bool same(const drill::BrickMesh& a, const drill::BrickMesh& b) {
  return a.indices == b.indices && a.vertices.size() == b.vertices.size() &&
         (a.vertices.empty() ||
          std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(drill::LiveVertex)) == 0);
}

int differing(const drill::LiveSurface& a, const drill::LiveSurface& b) {
  int n = 0;
  for (std::size_t i = 0; i < a.layout().count(); ++i) n += !same(a.brick(i), b.brick(i));
  return n;
}

}  // namespace

// Every set of solid corners: each crossed edge once in and once out, and faces that fit their neighbours'.
TEST(LiveSurface, TheCellsTrianglesAreClosedByTheirNeighbours) {
  std::mt19937_64 rng(1);
  for (int n = 0; n < 30; ++n) {
    voxel::HapticVolume v;
    v.voxels = grid::Grid<std::int16_t>(lattice(14, 1), voxel::haptic_empty);
    v.shapes = {voxel::occupancy_shape("bone", 1)};
    for (std::int16_t& raw : v.voxels.voxels)
      if (rng() % 100 < std::uint64_t(10 + 3 * n)) raw = voxel::detail::join(1, 1 + int(rng() % 255), true);
    const Closed is = look_at(drill::LiveSurface(v, 1));
    EXPECT_EQ(is.open, 0u) << n;
    EXPECT_GT(is.volume_mm3, 0) << "turned outwards";
  }
}

// 10,000 cuts of a ball that goes about in a block as a hand does: no edge has more than two triangles, as before a fan
// of triangles was begun where none of its diagonals lies in a face of its cell.
TEST(LiveSurface, TenThousandCutsLeaveASurfaceOfTwoFacesAnEdge) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(72, 0.4), voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("bone", 1)};
  for (int k = 4; k < 68; ++k)
    for (int j = 4; j < 68; ++j)
      for (int i = 4; i < 68; ++i) v.voxels.at(i, j, k) = voxel::detail::join(1, 255, true);
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.02};
  drill::Cutter cutter;
  cutter.radius_mm = 1.25;
  drill::Drill drill(v, shapes, cutter, {}, nullptr);
  std::mt19937_64 rng(5);
  Vec3 tip = v.voxels.to_world_mm({36, 36, 60}), way;
  for (int n = 0; n < 10000; ++n) {
    if (n % 50 == 0) {
      const Vec3 to = v.voxels.to_world_mm({uniform(rng, 5, 67), uniform(rng, 5, 67), uniform(rng, 10, 67)});
      way = (to - tip) * (1.0 / 50);
    }
    drill::ToolPose pose;
    pose.tip_mm = tip;
    drill.cut_way(pose, tip + normalized(way) * 0.1, 0, 0.001);
    tip += way;
  }
  const Closed is = look_at(drill::LiveSurface(v, 1));
  std::printf("  %zu triangles, %zu edges with more than two, %zu corners of %zu whose normal faces away\n",
              is.triangles, is.crowded, is.away, 3 * is.triangles);
  EXPECT_GT(is.triangles, 20000u) << "else little was cut";
  EXPECT_EQ(is.open, 0u);
  EXPECT_EQ(is.crowded, 0u);
}

TEST(LiveSurface, ABallHasItsVolumeAndNormals) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(lattice(40, 0.5), voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("bone", 1)};
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i) {
        const double d = 14 - norm(Vec3{i - 19.4, j - 19.6, k - 19.5});
        const int o = int(std::lround(255 * std::clamp(0.5 + 0.5 * d, 0.0, 1.0)));
        if (o > 0) v.voxels.at(i, j, k) = voxel::detail::join(1, o, true);
      }
  const drill::LiveSurface s(v, 1);
  const Closed is = look_at(s);
  EXPECT_EQ(is.open, 0u);
  EXPECT_NEAR(is.volume_mm3, 4.0 / 3 * M_PI * 343, 0.006 * 1437);
  double worst = 0, off = 0;
  for (std::size_t n = 0; n < s.layout().count(); ++n)
    for (const drill::LiveVertex& p : s.brick(n).vertices) {
      const Vec3 r = Vec3{p.position_mm[0], p.position_mm[1], p.position_mm[2]} - Vec3{9.7, 9.8, 9.75};
      off = std::max(off, std::abs(norm(r) - 7));
      worst = std::max(worst, 1 - dot(normalized(r), Vec3{p.normal[0], p.normal[1], p.normal[2]}));
    }
  EXPECT_LT(off, 0.02);
  EXPECT_LT(std::acos(1 - worst) * 180 / M_PI, 6);
}

// "What must be shown", 6: after a session the bricks are those of a surface made anew, without an open edge, and the
// border of the region is closed.
TEST(LiveSurface, FollowsADrillExactly) {
  voxel::HapticVolume v = layers(60, 0.5);
  drill::DirtyBricks marks(v.voxels);
  drill::Drill drill(v, of_layers(), ball(1.6), {}, &marks);
  drill::LiveSurface bone(v, 2), skin(v, 1);
  EXPECT_EQ(look_at(bone).open, 0u);
  std::mt19937_64 rng(5);
  std::vector<std::size_t> marked;
  std::size_t made = 0, frames = 0;
  Vec3 at = v.voxels.to_world_mm({30, 30, 38}), to = at;
  for (int tick = 0; tick < 4000; ++tick) {
    if (tick % 150 == 0) to = v.voxels.to_world_mm({uniform(rng, -1, 61), uniform(rng, -1, 61), uniform(rng, 20, 40)});
    at += (to - at) * 0.02;
    cut(drill, centred(at, 1.6), 0.001);
    if (tick == 2000) drill.incise(v.voxels.to_world_mm({30, 30, 45}), 6);
    if (drill.incising()) drill.go_on();
    if (tick % 17 != 0) continue;
    marked.clear();
    marks.take(marked);
    made += bone.update(marked).size();
    skin.update(marked);
    ++frames;
    const bool look = tick % 1000 == 0;
    EXPECT_EQ(look ? look_at(bone).open : 0u, 0u) << tick;
  }
  marked.clear();
  marks.take(marked);
  bone.update(marked);
  skin.update(marked);
  EXPECT_EQ(differing(bone, drill::LiveSurface(v, 2)), 0);
  EXPECT_EQ(differing(skin, drill::LiveSurface(v, 1)), 0);
  const Closed is = look_at(bone);
  EXPECT_EQ(is.open, 0u);
  EXPECT_GT(is.triangles, 3000u);
  EXPECT_GT(made, frames);
  std::printf("  %zu triangles, %.1f bricks a frame\n", is.triangles, double(made) / double(frames));
}

// Beside a thread that drills: closed in every frame, and exact when it stops.
TEST(LiveSurface, BesideADrillingThreadNoCrackOpens) {
  voxel::HapticVolume v = layers(48, 0.5);
  drill::DirtyBricks marks(v.voxels);
  drill::Drill drill(v, of_layers(), ball(2), {}, &marks);
  drill::LiveSurface bone(v, 2);
  std::atomic<bool> stop{false};
  std::thread thread([&] {
    std::mt19937_64 rng(6);
    Vec3 at = v.voxels.to_world_mm({24, 24, 30}), to = at;
    for (int tick = 0; !stop; ++tick) {
      if (tick % 100 == 0) to = v.voxels.to_world_mm({uniform(rng, 4, 44), uniform(rng, 4, 44), uniform(rng, 16, 32)});
      at += (to - at) * 0.03;
      cut(drill, centred(at, 2), 0.001);
    }
  });
  std::vector<std::size_t> marked;
  std::size_t made = 0, open = 0;
  // A busy machine's drill does little in thirty frames.
  for (int frame = 0; frame < 30 || (made <= 50 && frame < 30000); ++frame) {
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    marked.clear();
    marks.take(marked);
    made += bone.update(marked).size();
    open += look_at(bone).open;
  }
  stop = true;
  thread.join();
  marked.clear();
  marks.take(marked);
  bone.update(marked);
  EXPECT_EQ(open, 0u);
  EXPECT_GT(made, 50u);
  EXPECT_EQ(differing(bone, drill::LiveSurface(v, 2)), 0);
}

// Times of a stroke of 2 s, as CPU time; printed for the documents. The limits are for a machine that others share.
TEST(LiveSurface, TimesOfAStroke) {
  for (const auto& [radius, spacing] :
       {std::pair{1.5, 0.8}, std::pair{3.5, 0.8}, std::pair{3.5, 0.4}, std::pair{7.0, 0.4}}) {
    voxel::HapticVolume v = layers(spacing > 0.5 ? 70 : 130, spacing);
    drill::DirtyBricks marks(v.voxels);
    drill::Drill drill(v, of_layers(), ball(radius), {}, &marks);
    drill::LiveSurface bone(v, 2);
    std::vector<double> ticks, frames;
    std::vector<std::size_t> marked;
    double units = 0;
    for (int n = 0; n < 2000; ++n) {
      const double a = 0.002 * n;
      const Vec3 at = v.voxels.to_world_mm({0.5 * v.voxels.size[0] + 10 / spacing * std::cos(a),
                                            0.5 * v.voxels.size[1] + 10 / spacing * std::sin(a),
                                            0.62 * v.voxels.size[2] + 0.4 * radius / spacing});
      const double before = cpu_us();
      units += double(cut(drill, centred(at, radius), 0.001).units[2]);
      ticks.push_back(cpu_us() - before);
      if (n % 17 != 0) continue;
      marked.clear();
      const double begin = cpu_us();
      marks.take(marked);
      bone.update(marked);
      frames.push_back(cpu_us() - begin);
    }
    const auto p = [](std::vector<double> t, double share) {
      std::sort(t.begin(), t.end());
      return t[std::size_t(share * double(t.size() - 1))];
    };
    std::printf("  %4.1f mm at %.1f mm: tick p50 %.1f, p99 %.1f us; frame p50 %.0f, p99 %.0f us; %.0f mm3\n",
                2 * radius, spacing, p(ticks, 0.5), p(ticks, 0.99), p(frames, 0.5), p(frames, 0.99),
                mm3(v, std::int64_t(units)));
    EXPECT_GT(units, 0);
    EXPECT_LT(p(ticks, 0.5), spacing > 0.5 ? 1000 : 2000);
    EXPECT_LT(p(frames, 0.5), radius > 3.5 ? 25000 : 10000);
  }
}

// A mastoid's worth of drilling: 60 s of winding strokes with a burr of 2 mm. No open edge at any second, no voxel that
// rises, and at the end the surface is as one made anew.
TEST(LongLiveSurface, AMinuteAlongATemporalBonePath) {
  voxel::HapticVolume v = layers(100, 0.4);
  drill::DirtyBricks marks(v.voxels);
  drill::Drill drill(v, of_layers(), ball(1), {}, &marks);
  drill::LiveSurface bone(v, 2);
  grid::Grid<std::int16_t> before = v.voxels;
  std::vector<std::size_t> marked;
  std::size_t open = 0, risen = 0;
  double units = 0;
  for (int tick = 0; tick < 60000; ++tick) {
    const double t = 0.001 * tick;
    const Vec3 at = v.voxels.to_world_mm({50 + (10 + 0.4 * t) * std::cos(2.3 * t),
                                          50 + (10 + 0.4 * t) * std::sin(2.1 * t), 66 - 0.5 * t + 2 * std::sin(5 * t)});
    units += double(cut(drill, centred(at, 1), 0.001).units[2]);
    if (tick % 17 == 0) {
      marked.clear();
      marks.take(marked);
      bone.update(marked);
    }
    if (tick % 3000 != 0) continue;
    open += look_at(bone).open;
    for (std::size_t n = 0; n < before.voxels.size(); ++n) {
      const voxel::detail::RawVoxel was = voxel::detail::split(before.voxels[n]),
                                    is = voxel::detail::split(v.voxels.voxels[n]);
      risen += is.number == was.number && is.share > was.share;
    }
    before = v.voxels;
  }
  marked.clear();
  marks.take(marked);
  bone.update(marked);
  std::printf("  %.0f mm3 of bone\n", mm3(v, std::int64_t(units)));
  EXPECT_EQ(open, 0u);
  EXPECT_EQ(risen, 0u);
  EXPECT_EQ(differing(bone, drill::LiveSurface(v, 2)), 0);
  EXPECT_GT(units, 1e5);
}
