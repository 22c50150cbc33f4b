// SPDX-License-Identifier: GPL-3.0-or-later
// A head's CT and its second scan somewhere else, with the truth between them.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "itk/registration.h"
#include "phantom/random.h"
#include "phantom_heads.h"

namespace trephine {

/// A head's CT in seconds: without the scanner's kernel.
inline grid::HuVolume quick_ct(const phantom::Head& head, double voxel_mm) {
  phantom::SecondScanParams p;
  p.contrast = phantom::SecondScan::ct;
  p.voxel_mm = voxel_mm;
  p.noise_ratio = 0.012;
  p.scan_seed = 99;
  return phantom::second_scan(head, p).volume;
}

/// A head's CT as the scanner's model makes it.
inline grid::HuVolume head_ct(const phantom::Head& head, double voxel_mm, double noise_hu) {
  const int slices = static_cast<int>(190 / voxel_mm);
  return phantom::volume_of(phantom::scan(
      head, phantom_heads::scan_of(static_cast<int>(240 / voxel_mm), slices, noise_hu, slices * voxel_mm)));
}

/// The scan as if the patient had lain otherwise: turned and shifted by `by`.
inline phantom::Second moved(const phantom::Second& rest, const itk::LinearMap& by) {
  phantom::Second out = rest;
  out.volume.origin_mm = by(rest.volume.origin_mm);
  for (int a = 0; a < 3; ++a) out.volume.direction.column[a] = by.matrix * rest.volume.direction.column[a];
  out.truth = itk::then(rest.truth, by);
  return out;
}

/// An offset of up to so much, in a random direction and about a random axis.
inline itk::LinearMap random_offset(std::uint64_t number, double most_mm, double max_deg) {
  using phantom::uniform;
  const auto direction = [&](std::uint64_t stream) {
    Vec3 d{uniform(number, stream, 0), uniform(number, stream, 1), uniform(number, stream, 2)};
    return normalized(d);
  };
  const double mm = most_mm * std::cbrt(0.5 + 0.5 * uniform(number, 3, 0)),
               deg = max_deg * std::cbrt(0.5 + 0.5 * uniform(number, 4, 0));
  // The axis and angle as the composition of three turns would not keep the angle: so a rotation about one axis.
  const Vec3 axis = direction(1);
  const double a = deg * 0.017453292519943295, c = std::cos(a), s = std::sin(a);
  itk::LinearMap turn;
  for (int k = 0; k < 3; ++k) {
    Vec3 e{};
    e[k] = 1;
    turn.matrix.column[k] = e * c + cross(axis, e) * s + axis * (dot(axis, e) * (1 - c));
  }
  const Vec3 middle{0, -10, 42};
  turn.offset_mm = middle - turn.matrix * middle + direction(2) * mm;
  return turn;
}

/// Places that a ventriculostomy needs: corners about the ventricles, both foramina of Monro, Kocher's points.
inline std::vector<Vec3> targets(const phantom::Head& head) {
  std::vector<Vec3> all;
  for (const auto& [name, at] : head.landmarks())
    if (name.find("kocher") == 0 || name.find("monro") == 0) all.push_back(at);
  for (const double x : {-25.0, 25.0})
    for (const double y : {-40.0, 45.0})
      for (const double z : {20.0, 60.0}) all.push_back({x, y, z});
  return all;
}

inline double target_error_mm(const itk::LinearMap& found, const itk::LinearMap& truth,
                              const std::vector<Vec3>& places) {
  double most = 0;
  for (const Vec3& p : places) most = std::max(most, norm(found(p) - truth(p)));
  return most;
}

}  // namespace trephine
