// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/mismatch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/decode.h"

namespace trephine {
namespace {

// A number's own two "random" ones, 0 to 1 (the finalizer of splitmix64).
double hashed(std::uint64_t n, std::uint64_t which) {
  std::uint64_t z = (2 * n + which + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

struct Sample {
  Vec3 at_mm, normal;
};

// One point in each of `count` equal pieces of the area, in the order of the triangles.
std::vector<Sample> samples_on(const TriMesh& mesh, std::size_t count) {
  std::vector<double> area_up_to(mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area_up_to[t] = area += norm(triangle_normal(mesh, t)) / 2;
  std::vector<Sample> samples;
  if (!(area > 0)) return samples;
  samples.reserve(count);
  std::size_t t = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = area * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    while (t + 1 < area_up_to.size() && area_up_to[t] < at) ++t;
    double u = hashed(i, 0), v = hashed(i, 1);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& c = mesh.triangles[t];
    const Vec3 a = mesh.world_mm(c[0]), b = mesh.world_mm(c[1]), d = mesh.world_mm(c[2]);
    samples.push_back({a + (b - a) * u + (d - a) * v, normalized(triangle_normal(mesh, t))});
  }
  return samples;
}

bool lies_within(const Lattice& lattice, Vec3 at_mm) {
  const Vec3 p = lattice.to_index(at_mm);
  for (int i = 0; i < 3; ++i)
    if (!(p[i] >= 1 && p[i] <= lattice.size[i] - 2)) return false;
  return true;
}

constexpr double not_found = 1e300;

// The offset along the normal, nearest to 0, at which the occupancy crosses 1/2.
double nearest_crossing(const HapticDecoder& decoder, int number, const Sample& s, double step_mm, double reach_mm) {
  const auto value = [&](double t) { return decoder.trilinear(number, s.at_mm + s.normal * t) - 0.5; };
  const auto refined = [&](double from, double to) {
    const bool inside_first = value(from) >= 0;
    for (int i = 0; i < 30; ++i) {
      const double middle = (from + to) / 2;
      ((value(middle) >= 0) == inside_first ? from : to) = middle;
    }
    return (from + to) / 2;
  };
  const bool inside = value(0) >= 0;
  bool out_before = inside, in_before = inside;
  for (int n = 1; (n - 1) * step_mm < reach_mm; ++n) {
    const double t = std::min(n * step_mm, reach_mm), before = (n - 1) * step_mm;
    const bool out = value(t) >= 0, in = value(-t) >= 0;
    double found = not_found;
    if (out != out_before) found = refined(before, t);
    if (in != in_before) {
      const double inwards = refined(-before, -t);
      if (std::abs(inwards) < std::abs(found)) found = inwards;
    }
    if (found != not_found) return found;
    out_before = out;
    in_before = in;
  }
  return not_found;
}

}  // namespace

Mismatch measure_mismatch(const TriMesh& displayed, const HapticVolume& volume, const HapticShape& shape,
                          const MismatchParams& params, const Progress& progress) {
  check_mesh(displayed);
  std::vector<Sample> samples = samples_on(displayed, static_cast<std::size_t>(params.sample_count));
  samples.erase(std::remove_if(samples.begin(), samples.end(),
                               [&](const Sample& s) { return !lies_within(volume.voxels, s.at_mm); }),
                samples.end());
  const HapticDecoder decoder(volume);
  const Vec3 spacing = volume.voxels.spacing_mm;
  const double step_mm = std::min({spacing.x, spacing.y, spacing.z}) / 2;
  std::vector<double> offset(samples.size());
  parallel_for(0, static_cast<std::int64_t>(samples.size()), 256, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i)
      offset[i] = nearest_crossing(decoder, shape.number, samples[i], step_mm, params.reach_mm);
  });
  progress.report(1);
  Mismatch m;
  m.samples = samples.size();
  offset.erase(std::remove(offset.begin(), offset.end(), not_found), offset.end());
  if (m.samples > 0) m.missed_ratio = 1 - static_cast<double>(offset.size()) / static_cast<double>(m.samples);
  if (offset.empty()) return m;
  for (const double d : offset) {
    m.bias_mm += d;
    m.rms_mm += d * d;
  }
  m.bias_mm /= static_cast<double>(offset.size());
  m.rms_mm = std::sqrt(m.rms_mm / static_cast<double>(offset.size()));
  for (double& d : offset) d = std::abs(d);
  std::sort(offset.begin(), offset.end());
  m.max_mm = offset.back();
  // Nearest rank: the smallest offset that at least 99 % of the points do not exceed.
  m.p99_mm = offset[(offset.size() * 99 + 99) / 100 - 1];
  return m;
}

}  // namespace trephine
