// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/fluoroscope.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"

namespace trephine::fluoro {
namespace {

constexpr float min_of_patient = 0.05f;  // less is air
constexpr double bright_quantile = 0.995;
constexpr double bright_grey = 200;  // of that share of the patient: metal must stand out before dense bone

// Pixels beyond which a rod is not seen.
struct PixelBox {
  double left = -1e9, right = 1e9, top = -1e9, bottom = 1e9;
  bool holds(int x, int y) const { return x >= left && x <= right && y >= top && y <= bottom; }
};

// About the corners of a box about the rod; everything where one of them is not well before the source.
PixelBox box_of(const MetalRod& rod, const CArm& arm) {
  constexpr double min_before_mm = 20;
  PixelBox box{1e9, -1e9, 1e9, -1e9};
  const Vec3 axis = normalized(rod.tail_mm - rod.tip_mm);
  const Vec3 across = normalized(cross(axis, std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
  const Vec3 up = cross(axis, across);
  for (const Vec3 end : {rod.tip_mm, rod.tail_mm})
    for (const double a : {-0.5, 0.5})
      for (const double b : {-0.5, 0.5}) {
        const Vec3 corner = end + (across * a + up * b) * rod.diameter_mm;
        if (!(arm.before_source_mm(corner) > min_before_mm)) return {};
        const auto at = arm.project(corner);
        box.left = std::min(box.left, at[0] - 1.5);
        box.right = std::max(box.right, at[0] + 0.5);
        box.top = std::min(box.top, at[1] - 1.5);
        box.bottom = std::max(box.bottom, at[1] + 0.5);
      }
  return box;
}

}  // namespace

void require_ct(const grid::Grid<std::int16_t>& ct) {
  if (ct.voxels.empty())
    throw Error(ExitCode::bad_input, "", "ct", "the case has no CT: its scene must ask for it (ct: {})");
}

FluoroVolume::FluoroVolume(const grid::Grid<std::int16_t>& ct) : lattice_(ct), water_(ct.voxels.size()) {
  require_ct(ct);
  for (std::size_t n = 0; n < water_.size(); ++n) water_[n] = std::uint16_t(std::max(0, int(ct.voxels[n]) + 1000));
}

Vec3 FluoroVolume::centre_mm() const {
  const auto& s = lattice_.size;
  return lattice_.to_world_mm({0.5 * (s[0] - 1), 0.5 * (s[1] - 1), 0.5 * (s[2] - 1)});
}

double FluoroVolume::along(const CArm::Ray& ray) const {
  const Vec3 from = lattice_.to_index(ray.from_mm), way = lattice_.to_index(ray.from_mm + ray.direction) - from;
  int main = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(way[a]) > std::abs(way[main])) main = a;
  const int first = main == 0 ? 1 : 0, second = main == 2 ? 1 : 2;
  const std::size_t stride[3] = {1, std::size_t(lattice_.size[0]),
                                 std::size_t(lattice_.size[0]) * std::size_t(lattice_.size[1])};
  const int slices = lattice_.size[std::size_t(main)];
  const int nu = lattice_.size[std::size_t(first)], nv = lattice_.size[std::size_t(second)];
  // Position in each slice: u0 + k du, v0 + k dv. Slice k stands for what lies from k - 1/2 to k + 1/2.
  const double du = way[first] / way[main], dv = way[second] / way[main];
  const double u0 = from[first] - from[main] * du, v0 = from[second] - from[main] * dv;
  double low = 0, high = slices - 1;
  const auto clip = [&](double p, double d, int n) {
    if (std::abs(d) < 1e-12) {
      if (p < -0.5 || p > n - 0.5) high = -1;
      return;
    }
    const double a = (-0.5 - p) / d, b = (n - 0.5 - p) / d;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  };
  clip(u0, du, nu);
  clip(v0, dv, nv);
  if (!(low <= high)) return 0;  // the ray misses the volume
  double sum = 0;
  const int end = int(std::floor(high + 1e-9));
  for (int k = int(std::ceil(low - 1e-9)); k <= end; ++k) {
    const float u = float(std::clamp(u0 + k * du, 0.0, double(nu - 1)));
    const float v = float(std::clamp(v0 + k * dv, 0.0, double(nv - 1)));
    const int i = std::min(int(u), std::max(0, nu - 2)), j = std::min(int(v), std::max(0, nv - 2));
    const float fu = u - float(i), fv = v - float(j);
    const std::uint16_t* p = water_.data() + std::size_t(k) * stride[main] + std::size_t(i) * stride[first] +
                             std::size_t(j) * stride[second];
    const std::size_t nu1 = nu > 1 ? stride[first] : 0, nv1 = nv > 1 ? stride[second] : 0;
    const float a = float(p[0]) + (float(p[nu1]) - float(p[0])) * fu;
    const float b = float(p[nv1]) + (float(p[nv1 + nu1]) - float(p[nv1])) * fu;
    sum += double(a + (b - a) * fv);
  }
  // The length of the ray from slice to slice.
  return sum * 1e-3 * water_per_mm / std::abs(way[main]);
}

FluoroIntegrals FluoroVolume::integrals(const CArm& arm) const {
  FluoroIntegrals out;
  out.size = arm.size();
  out.integral.resize(std::size_t(out.size) * std::size_t(out.size));
  parallel_for(0, out.size, 1, [&](std::int64_t from, std::int64_t to) { integrate(arm, int(from), int(to), out); });
  return out;
}

void FluoroVolume::integrate(const CArm& arm, int first_row, int end_row, FluoroIntegrals& out) const {
  for (int y = first_row; y < end_row; ++y)
    for (int x = 0; x < out.size; ++x)
      out.integral[std::size_t(y) * std::size_t(out.size) + std::size_t(x)] = float(along(arm.ray(x + 0.5, y + 0.5)));
}

double bright_of(const FluoroIntegrals& patient) {
  std::vector<float> body;
  for (const float v : patient.integral)
    if (v > min_of_patient) body.push_back(v);
  return body.empty() ? 1 : double(value_at_rank(body, std::size_t(bright_quantile * double(body.size() - 1))));
}

FluoroPicture picture_of(const FluoroIntegrals& patient, double bright, const CArm& arm,
                         const std::vector<MetalRod>& metal) {
  FluoroPicture out;
  out.size = patient.size;
  out.grey.resize(patient.integral.size());
  std::vector<PixelBox> boxes;
  for (const MetalRod& rod : metal) boxes.push_back(box_of(rod, arm));
  for (int y = 0; y < out.size; ++y)
    for (int x = 0; x < out.size; ++x) {
      const std::size_t n = std::size_t(y) * std::size_t(out.size) + std::size_t(x);
      double v = double(patient.integral[n]);
      for (std::size_t r = 0; r < metal.size(); ++r)
        if (boxes[r].holds(x, y)) v += metal_per_mm * chord_mm(metal[r], arm.ray(x + 0.5, y + 0.5));
      out.grey[n] = std::uint8_t(std::lround(std::clamp(bright_grey * v / bright, 0.0, 255.0)));
    }
  return out;
}

const KeptFluoro& Fluoroscope::patient(const CArmParams& arm, int size) {
  if (const KeptFluoro* kept = memory_.find(arm, size)) return *kept;
  KeptFluoro k{arm, volume_.integrals(CArm(arm, size)), 1};
  k.bright = bright_of(k.integrals);
  return memory_.keep(std::move(k));
}

FluoroPicture Fluoroscope::picture(const CArmParams& params, int size, const std::vector<MetalRod>& metal) {
  const KeptFluoro& k = patient(params, size);
  return picture_of(k.integrals, k.bright, CArm(params, size), metal);
}

}  // namespace trephine::fluoro
