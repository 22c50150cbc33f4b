// SPDX-License-Identifier: GPL-3.0-or-later
// The haptic volume's times on surfaces of real size, in one run:
//   bench_voxel SKIN.vtp SKULL.vtp BRAIN.vtp VENTRICLES.vtp [spacing_mm [voxels a side [OUT.nrrd]]]
// (trephine run --keep leaves them as <anatomy>.contour.vtp). Times are wall clock, so run it on an idle machine.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>

#include "../tests/report_of.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "meshio/vtp.h"
#include "voxel/cut.h"
#include "voxel/decode.h"
#include "voxel/haptic_file.h"
#include "voxel/mismatch.h"
#include "voxel/voxelize.h"

using namespace trephine;

namespace {

double timed(const std::function<void()>& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void row(const char* name, double seconds) { std::printf("%-34s %9.3f s\n", name, seconds); }

// Of this thread, so that other processes matter less.
double cpu_timed(const std::function<void()>& f) {
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  };
  const double start = now();
  f();
  return now() - start;
}

// Mean CPU time of a sample, over points within `near_mm` of the shape's surface, or anywhere.
void time_decoder(const voxel::HapticVolume& volume, const surface::TriMesh* surface) {
  std::mt19937_64 rng(1);
  const auto uniform = [&](double a, double b) { return a + (b - a) * double(rng() >> 11) * 0x1p-53; };
  const grid::Lattice& l = volume.voxels;
  std::vector<Vec3> points(1 << 20);
  for (Vec3& p : points) {
    do {
      if (!surface) {
        p = l.to_world_mm({uniform(0, l.size[0]), uniform(0, l.size[1]), uniform(0, l.size[2])});
      } else {
        const Vec3 near{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        p = surface->world_mm(rng() % surface->points_mm.size()) + near;
      }
      const Vec3 i = l.to_index(p);
      if (i.x > 0 && i.y > 0 && i.z > 0 && i.x < l.size[0] - 1 && i.y < l.size[1] - 1 && i.z < l.size[2] - 1) break;
    } while (true);
  }
  const voxel::HapticDecoder decoder(volume);
  double sum = 0;
  const auto per_sample = [&](const char* name, const std::function<void(Vec3)>& f) {
    const double s = cpu_timed([&] {
      for (const Vec3 p : points) f(p);
    });
    std::printf("%-34s %9.0f ns  (%s)\n", name, 1e9 * s / double(points.size()),
                surface ? "random, within 1 mm of the skull" : "random, anywhere");
  };
  per_sample("nearest", [&](Vec3 p) { sum += decoder.nearest(2, p); });
  per_sample("trilinear", [&](Vec3 p) { sum += decoder.trilinear(2, p); });
  per_sample("gradient", [&](Vec3 p) { sum += decoder.gradient(2, p).x; });
  // As a servo loop walks: 16 samples at steps of 0.1 mm.
  const double s = cpu_timed([&] {
    for (std::size_t n = 0; n < points.size(); n += 16)
      for (int step = 0; step < 16; ++step) sum += decoder.trilinear(2, points[n] + Vec3{0.1 * step, 0, 0});
  });
  std::printf("%-34s %9.0f ns  (checksum %.6g)\n", "trilinear along a path", 1e9 * s / double(points.size()), sum);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 5) {
    std::fprintf(stderr,
                 "bench_voxel SKIN.vtp SKULL.vtp BRAIN.vtp VENTRICLES.vtp [spacing_mm [voxels a side [OUT.nrrd]]]\n");
    return 64;
  }
  std::vector<surface::TriMesh> mesh;
  for (int n = 1; n <= 4; ++n) mesh.push_back(meshio::read_vtp(argv[n]));
  const double spacing = argc > 5 ? std::atof(argv[5]) : 0.8;
  const int side = argc > 6 ? std::atoi(argv[6]) : 256;
  const surface::TriMesh &skin = mesh[0], &skull = mesh[1], &brain = mesh[2], &ventricles = mesh[3];
  const surface::Bounds b = surface::bounds_of(brain);
  grid::Lattice l;
  l.size = {side, side, side};
  l.spacing_mm = {spacing, spacing, spacing};
  l.origin_mm = (b.min_mm + b.max_mm) * 0.5 - Vec3{1, 1, 1} * (0.5 * spacing * (side - 1));

  Report report;
  voxel::HapticVolume v;
  const std::vector<voxel::VoxelizeShape> list{
      {"ventricles", &ventricles}, {"skull", &skull}, {"brain", &brain}, {"skin", &skin, &brain, 5}};
  for (const int threads : {1, 0}) {
    set_thread_count(threads);
    const double s = timed([&] { v = value_of(report = {}, voxel::voxelize(l, list)); });
    row(threads == 1 ? "voxelize, 4 shapes, one thread" : "voxelize, 4 shapes", s);
  }
  for (const auto& f : report.figures) std::printf("  %-30s %s\n", f.first.c_str(), to_text(f.second).c_str());
  row("check_haptic_volume", timed([&] { voxel::check_haptic_volume(v); }));
  std::string bytes;
  row("encode_haptic", timed([&] { bytes = voxel::encode_haptic(v); }));
  row("decode_haptic, checked", timed([&] { voxel::decode_haptic(bytes); }));
  time_decoder(v, &skull);
  time_decoder(v, nullptr);
  for (std::size_t n = 0; n < list.size(); ++n) {
    voxel::Mismatch m;
    const double s = timed([&] { m = voxel::measure_mismatch(*list[n].surface, v, v.shapes[n]); });
    std::printf("mismatch of %-22s %9.3f s  bias %+.4f  RMS %.4f  p99 %.4f  max %.3f mm  missed %.4f of %d\n",
                list[n].name.c_str(), s, m.bias_mm, m.rms_mm, m.p99_mm, m.max_mm, m.missed_ratio, int(m.samples));
  }
  if (argc > 7) voxel::write_haptic(argv[7], v);
  const Vec3 at{(b.min_mm.x + b.max_mm.x) / 2 + 30, (b.min_mm.y + b.max_mm.y) / 2, b.max_mm.z};
  const auto hole = [&](Vec3 p) {
    const double across = std::hypot(p.x - at.x, p.y - at.y) - 7, along = std::abs(p.z - at.z) - 20;
    return std::max(across, along);
  };
  const surface::Bounds bounds{at - Vec3{7, 7, 20}, at + Vec3{7, 7, 20}};
  row("cut_volume, burr hole of 14 mm", timed([&] {
        value_of(report = {}, voxel::cut_volume(v, hole, bounds, {2, 4}));
      }));
  for (const auto& f : report.figures) std::printf("  %-30s %s\n", f.first.c_str(), to_text(f.second).c_str());
  return 0;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_voxel").c_str());
  return static_cast<int>(e.code());
}
