// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/second_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "phantom/random.h"

namespace trephine::phantom {
namespace {

constexpr Vec3 middle{0, -10, 35};        ///< of the head
constexpr Vec3 extent_mm{200, 230, 240};  ///< of what is scanned

/// Brightness of tissues in T1-weighted MR by their HU of tissue.cpp: white matter 1000, fat above it, then grey
/// matter, muscle and CSF, cortical bone next to nothing, as any textbook has their order. No figure of a scanner is
/// meant.
constexpr std::pair<double, double> t1_of_hu[] = {
    {-1000, 0}, {-900, 15}, {-90, 1250}, {8, 250},   {12, 220},  {20, 600},  {29, 1000}, {35, 850},
    {37, 720},  {40, 780},  {50, 700},   {55, 620},  {68, 900},  {75, 500},  {190, 400}, {250, 300},
    {320, 80},  {330, 700}, {550, 850},  {1050, 80}, {1400, 60}, {2200, 40}, {6000, 0}};

double t1_of(double hu) {
  double value = 0, nearest = 1e9;
  for (const auto& [tissue, t1] : t1_of_hu)
    if (std::fabs(hu - tissue) < nearest) nearest = std::fabs(hu - tissue), value = t1;
  return value;
}

double value_at(const Head& head, Vec3 p, double voxel_mm, bool mr) {
  const auto of = [&](const Head::Sample& s) { return mr ? t1_of(s.hu) : s.hu; };
  const Head::Sample whole = head.sample(p, 1e-6);
  if (whole.clearance_mm > 0.87 * voxel_mm) return of(whole);
  double sum = 0;
  const double q = voxel_mm / 4;
  for (const double z : {-q, q})
    for (const double y : {-q, q})
      for (const double x : {-q, q}) sum += of(head.sample(p + Vec3{x, y, z}, 1e-6));
  return sum / 8;
}

/// From 1 - ratio to 1 + ratio, over about a head.
double bias_at(Vec3 p, const SecondScanParams& s) {
  const auto seed = static_cast<std::uint64_t>(s.scan_seed);
  double sum = 0;
  for (int n = 0; n < 3; ++n) {
    const auto u = [&](std::uint64_t i) { return uniform(seed, 40 + static_cast<std::uint64_t>(n), i); };
    const Vec3 way{u(0), u(1), u(2)};
    sum += std::sin(dot(p, normalized(way)) / 55 + 3 * u(3));
  }
  return 1 + s.bias_ratio * sum / 3;
}

grid::Lattice sagittal_box(const SecondScanParams& s) {
  grid::Lattice l;
  l.direction = {{Vec3{0, 1, 0}, Vec3{0, 0, -1}, Vec3{-1, 0, 0}}};
  const double along[3] = {extent_mm.y, extent_mm.z, extent_mm.x};
  for (int a = 0; a < 3; ++a) l.size[a] = std::max(8, static_cast<int>(std::lround(along[a] / s.voxel_mm)));
  l.spacing_mm = {s.voxel_mm, s.voxel_mm, s.voxel_mm};
  const auto seed = static_cast<std::uint64_t>(s.scan_seed);
  const Vec3 chance{uniform(seed, 30, 0), uniform(seed, 30, 1), uniform(seed, 30, 2)};
  const Vec3 half{(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0};
  l.origin_mm = middle + chance * (s.voxel_mm / 2) - l.direction * (half * s.voxel_mm);
  return l;
}

}  // namespace

Second second_scan(const Head& first, const SecondScanParams& s, const Progress& progress) {
  HeadParams params = first.params();
  if (s.contrast == SecondScan::cta) {
    if (params.level != Level::hard)
      throw Error(ExitCode::usage, "", "second_scan", "cta needs the level hard, whose heads have vessels");
    params.hard.contrast = true;
  }
  const Head head = s.contrast == SecondScan::cta ? Head(params) : first;
  const grid::Lattice rest = sagittal_box(s);
  const auto vec = [](const std::array<double, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
  Second out;
  out.truth = itk::rigid_map(vec(s.turn_deg), vec(s.shift_mm), middle);
  grid::Lattice moved = rest;
  moved.origin_mm = out.truth(rest.origin_mm);
  for (int a = 0; a < 3; ++a) moved.direction.column[a] = out.truth.matrix * rest.direction.column[a];
  out.volume = grid::Grid<std::int16_t>(moved);
  const bool mr = s.contrast == SecondScan::mr;
  const auto seed = static_cast<std::uint64_t>(s.scan_seed);
  parallel_for(0, rest.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      progress.report(double(k) / rest.size[2]);
      for (int j = 0; j < rest.size[1]; ++j)
        for (int i = 0; i < rest.size[0]; ++i) {
          const Vec3 p = rest.to_world_mm({double(i), double(j), double(k)});
          double v = value_at(head, p, s.voxel_mm, mr);
          float a = 0, b = 0;
          normal_pair(seed, 50, rest.index(i, j, k), a, b);
          const double noise = 1000 * s.noise_ratio;
          v = mr ? std::hypot(v * bias_at(p, s) + noise * a, noise * b) : v + noise * a;
          out.volume.at(i, j, k) = static_cast<std::int16_t>(std::lround(std::clamp(v, -32000.0, 32000.0)));
        }
    }
  });
  return out;
}

void write_second_scan(const std::filesystem::path& folder, const Second& second) {
  make_output_folder(folder);
  grid::write_nrrd(folder / "scan.nrrd", grid::HuVolume(second.volume), {});
  write_file(folder / "truth.tfm", itk::encode_tfm(second.truth));
}

}  // namespace trephine::phantom
