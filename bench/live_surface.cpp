// SPDX-License-Identifier: GPL-3.0-or-later
// bench_live_surface [CASE]: times of the surface that follows a drill, of a case's drillable shapes or of a synthetic
// head of 256^3 voxels of 0.8 mm: the whole surface once, and strokes of 2 s at 20 mm/s with balls of 3 to 14 mm. CPU
// time of the thread, but for the whole surface, which is made on all threads.
//
// Then, where the system has OpenGL 4.3: who draws, and what a frame costs by the clock, until the driver has finished,
// when 1, 4 and 9 burrs of 7 mm cut in it: triangles made by the processor and uploaded, beside those that a compute
// shader makes. Frames of both are made in turn, of the same volume.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>

#include "base/error.h"
#include "cases/load_case.h"
#include "drill/drill.h"
#include "drill/live_surface.h"
#ifdef BENCH_RENDER
#include "render/context.h"
#include "render/surface_maker.h"
#endif

using namespace trephine;

namespace {

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e6 + double(t.tv_nsec) * 1e-3;
}

// A bumpy shell of bone, 8 mm thick.
voxel::HapticVolume synthetic() {
  voxel::HapticVolume v;
  grid::Lattice l;
  l.size = {256, 256, 256};
  l.spacing_mm = {0.8, 0.8, 0.8};
  v.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  v.shapes = {voxel::occupancy_shape("bone", 1)};
  for (int k = 0; k < 256; ++k)
    for (int j = 0; j < 256; ++j)
      for (int i = 0; i < 256; ++i) {
        const Vec3 p = Vec3{i - 127.5, j - 127.5, k - 127.5} * 0.8;
        const double r = norm(p) + 1.5 * std::sin(0.3 * p.x) + std::cos(0.5 * p.y + 0.2 * p.z);
        const int share = int(std::lround(255 * std::clamp(0.5 + (4 - std::abs(r - 84)) / 1.6, 0.0, 1.0)));
        if (share > 0) v.voxels.at(i, j, k) = std::int16_t(1300 + share);
      }
  return v;
}

double quantile(std::vector<double> t, double share) {
  std::sort(t.begin(), t.end());
  return t[std::size_t(share * double(t.size() - 1))];
}

const char* name_of(const voxel::HapticVolume& v, int number) {
  for (const voxel::HapticShape& s : v.shapes)
    if (s.number == number) return s.name.c_str();
  return "";
}

#ifdef BENCH_RENDER
double clock_ms(const std::function<void()>& what) {
  render::wait_for_driver();
  const auto begin = std::chrono::steady_clock::now();
  what();
  render::wait_for_driver();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

// Places on the surface, spread over it, each with its direction outwards.
struct Place {
  Vec3 at, out;
};
std::vector<Place> places_on(const voxel::HapticVolume& v, int number, std::size_t wanted) {
  const drill::LiveSurface s(v, number);
  std::vector<std::size_t> bricks;
  for (std::size_t b = 0; b < s.layout().count(); ++b)
    if (!s.brick(b).vertices.empty()) bricks.push_back(b);
  std::vector<Place> out;
  for (std::size_t n = 0; n < wanted && !bricks.empty(); ++n) {
    const drill::LiveVertex& p = s.brick(bricks[(2 * n + 1) * bricks.size() / (2 * wanted)]).vertices.front();
    const grid::Lattice& l = v.voxels;
    out.push_back({l.origin_mm + l.direction * Vec3{p.position_mm[0], p.position_mm[1], p.position_mm[2]},
                   normalized(l.direction * Vec3{p.normal[0], p.normal[1], p.normal[2]})});
  }
  return out;
}

void draw_beside(const voxel::HapticVolume& whole, int number, const drill::DrillShapes& shapes) {
  std::unique_ptr<render::OffscreenContext> context;
  try {
    context = std::make_unique<render::OffscreenContext>();
    std::printf("  drawn by %s\n", render::driver_facts().renderer.c_str());
  } catch (const Error& e) {
    std::printf("  no OpenGL: %s\n", e.what());
    return;
  }
  for (const std::size_t burrs : {1, 4, 9}) {
    voxel::HapticVolume v = whole;
    drill::DirtyBricks marks(v.voxels);
    drill::Cutter cutter;
    cutter.radius_mm = 3.5;
    const std::vector<Place> places = places_on(v, number, burrs);
    std::vector<std::unique_ptr<drill::Drill>> drills;
    for (std::size_t n = 0; n < places.size(); ++n)
      drills.push_back(std::make_unique<drill::Drill>(v, shapes, cutter, drill::DrillParams{}, &marks));
    std::unique_ptr<render::SurfaceMaker> makers[2];
    const double whole_ms[2] = {clock_ms([&] { makers[0] = render::processor_maker(v, number, {}); }),
                                clock_ms([&] { makers[1] = render::compute_maker(v, number, {}); })};
    std::vector<double> frames[2];
    std::vector<std::size_t> marked;
    std::size_t made = 0;
    for (int frame = 0; frame < 60; ++frame) {
      for (int tick = 17 * frame; tick < 17 * frame + 17; ++tick)
        for (std::size_t n = 0; n < drills.size(); ++n) {
          drill::ToolPose pose;
          const Place& p = places[n];
          const Vec3 along = normalized(cross(p.out, std::abs(p.out.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
          pose.tip_mm = p.at + along * (0.02 * tick) - p.out * (0.001 * tick) - pose.frame.column[2] * cutter.radius_mm;
          drills[n]->cut_way(pose, pose.tip_mm + along * 0.02, 0, 0.001);
        }
      marked.clear();
      marks.take(marked);
      for (int who = 0; who < 2; ++who) frames[who].push_back(clock_ms([&] { made += makers[who]->update(marked); }));
    }
    std::printf(
        "  %zu burrs, %.1f bricks a frame: processor p50 %.2f, p99 %.2f ms; graphics p50 %.2f, p99 %.2f ms; "
        "whole %.0f and %.0f ms\n",
        burrs, double(made) / 120, quantile(frames[0], 0.5), quantile(frames[0], 0.99), quantile(frames[1], 0.5),
        quantile(frames[1], 0.99), whole_ms[0], whole_ms[1]);
  }
}
#else
void draw_beside(const HapticVolume&, int, const DrillShapes&) {}
#endif

void run(const voxel::HapticVolume& whole, int number, const drill::DrillShapes& shapes) {
  const auto begin = std::chrono::steady_clock::now();
  const drill::LiveSurface first(whole, number);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
  std::printf("%s: whole surface %.0f ms, %zu triangles\n", name_of(whole, number), took.count(), first.triangles());
  // A place on the surface, and two ways along it.
  const grid::Lattice& l = whole.voxels;
  std::size_t brick = first.layout().count() / 2;
  while (brick + 1 < first.layout().count() && first.brick(brick).vertices.empty()) ++brick;
  if (first.brick(brick).vertices.empty()) return;
  const drill::LiveVertex& at = first.brick(brick).vertices.front();
  const Vec3 start = l.origin_mm + l.direction * Vec3{at.position_mm[0], at.position_mm[1], at.position_mm[2]};
  const Vec3 out = normalized(l.direction * Vec3{at.normal[0], at.normal[1], at.normal[2]});
  const Vec3 along = normalized(cross(out, std::abs(out.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  for (const double diameter : {3.0, 5.0, 7.0, 14.0}) {
    voxel::HapticVolume v = whole;
    drill::DirtyBricks marks(v.voxels);
    drill::LiveSurface live(v, number);
    drill::Cutter cutter;
    cutter.radius_mm = 0.5 * diameter;
    drill::Drill drill(v, shapes, cutter, {}, &marks);
    std::vector<double> ticks, frames;
    std::vector<std::size_t> marked;
    std::size_t made = 0;
    drill::ToolPose pose;
    for (int n = 0; n < 2000; ++n) {
      const double way = 0.02 * (n < 1000 ? n : 2000 - n);
      pose.tip_mm = start + along * way - out * (0.001 * n) - pose.frame.column[2] * cutter.radius_mm;
      const double before = cpu_us();
      drill.cut_way(pose, pose.tip_mm, 0, 0.001);
      ticks.push_back(cpu_us() - before);
      if (n % 17 != 0) continue;
      marked.clear();
      const double frame = cpu_us();
      marks.take(marked);
      made += live.update(marked).size();
      frames.push_back(cpu_us() - frame);
    }
    std::printf("  ball %4.1f mm: tick p50 %.1f, p99 %.1f us; frame p50 %.0f, p99 %.0f us, %.1f bricks\n", diameter,
                quantile(ticks, 0.5), quantile(ticks, 0.99), quantile(frames, 0.5), quantile(frames, 0.99),
                double(made) / double(frames.size()));
  }
  draw_beside(whole, number, shapes);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2) {
      drill::DrillShapes shapes;
      shapes[1] = {true, 0.1};
      run(synthetic(), 1, shapes);
      return 0;
    }
    const cases::LoadedCase c = cases::load_case(argv[1]);
    for (const cases::CaseShape& s : c.manifest.haptic.shapes) {
      if (!s.cuttable || !(s.material.removal_energy_j_per_mm3 > 0)) continue;
      drill::DrillShapes shapes;
      shapes[std::size_t(s.number)] = {true, s.material.removal_energy_j_per_mm3};
      run(c.haptic, s.number, shapes);
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 70;
  }
}
