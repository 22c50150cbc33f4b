// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/between_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

/// The axes within a slice, and the step of the voxels along each of the three.
struct Plane {
  int axis, u, v;
  std::array<std::size_t, 3> step;
  Plane(const grid::Lattice& l, int axis_)
      : axis(axis_),
        u(axis_ == 0 ? 1 : 0),
        v(axis_ == 2 ? 1 : 2),
        step{1, std::size_t(l.size[0]), std::size_t(l.size[0]) * std::size_t(l.size[1])} {}
};

/// One painted slice: the signed distance to its outline in mm (positive inside) and the middle of what is painted, in
/// voxels of the slice.
struct Outline {
  int index = 0;
  grid::Grid<float> distance_mm;
  double middle_u = 0, middle_v = 0;

  /// Bilinear; beyond the lattice the value at its edge less the way to it, so that it is outside there.
  double at(double u, double v) const {
    const auto& [nu, nv, one] = distance_mm.size;
    const double cu = std::clamp(u, 0.0, double(nu - 1)), cv = std::clamp(v, 0.0, double(nv - 1));
    const int i = std::min(int(cu), std::max(0, nu - 2)), j = std::min(int(cv), std::max(0, nv - 2));
    const int i1 = std::min(i + 1, nu - 1), j1 = std::min(j + 1, nv - 1);
    const double x = cu - i, y = cv - j;
    const double inside = (distance_mm.at(i, j, 0) * (1 - x) + distance_mm.at(i1, j, 0) * x) * (1 - y) +
                          (distance_mm.at(i, j1, 0) * (1 - x) + distance_mm.at(i1, j1, 0) * x) * y;
    const double off = std::hypot((u - cu) * distance_mm.spacing_mm.x, (v - cv) * distance_mm.spacing_mm.y);
    return inside - off;
  }
};

/// A margin of one empty voxel all around lets a shape at the lattice's edge have an outline there too.
Outline outline_of(const grid::Mask& painted, std::uint8_t value, const Plane& plane, int index) {
  grid::Lattice slice;
  slice.size = {painted.size[std::size_t(plane.u)], painted.size[std::size_t(plane.v)], 1};
  slice.spacing_mm = {painted.spacing_mm[plane.u], painted.spacing_mm[plane.v], 1};
  const grid::Lattice padded = [&] {
    grid::Lattice l = slice;
    l.size[0] += 2;
    l.size[1] += 2;
    return l;
  }();
  BitMask inside(padded);
  Outline out;
  out.index = index;
  std::size_t count = 0;
  for (int v = 0; v < slice.size[1]; ++v)
    for (int u = 0; u < slice.size[0]; ++u)
      if (painted.voxels[std::size_t(index) * plane.step[std::size_t(plane.axis)] +
                         std::size_t(u) * plane.step[std::size_t(plane.u)] +
                         std::size_t(v) * plane.step[std::size_t(plane.v)]] == value) {
        inside.set(u + 1, v + 1, 0);
        out.middle_u += u;
        out.middle_v += v;
        ++count;
      }
  out.middle_u /= double(count);
  out.middle_v /= double(count);
  const grid::Grid<float> to_inside = distance_mm(inside);
  const grid::Grid<float> to_outside = distance_mm(inside.invert());
  out.distance_mm = grid::Grid<float>(slice);
  for (int v = 0; v < slice.size[1]; ++v)
    for (int u = 0; u < slice.size[0]; ++u)
      out.distance_mm.at(u, v, 0) = to_outside.at(u + 1, v + 1, 0) - to_inside.at(u + 1, v + 1, 0);
  return out;
}

bool is_painted(const grid::Mask& painted, std::uint8_t value, const Plane& plane, int index) {
  for (int v = 0; v < painted.size[std::size_t(plane.v)]; ++v) {
    const std::uint8_t* at = painted.voxels.data() + std::size_t(index) * plane.step[std::size_t(plane.axis)] +
                             std::size_t(v) * plane.step[std::size_t(plane.v)];
    for (int u = 0; u < painted.size[std::size_t(plane.u)]; ++u, at += plane.step[std::size_t(plane.u)])
      if (*at == value) return true;
  }
  return false;
}

void fill(grid::Mask& out, std::uint8_t value, const Plane& plane, const Outline& a, const Outline& b) {
  for (int index = a.index + 1; index < b.index; ++index) {
    const double t = double(index - a.index) / (b.index - a.index);
    const double move_u = b.middle_u - a.middle_u, move_v = b.middle_v - a.middle_v;
    for (int v = 0; v < out.size[std::size_t(plane.v)]; ++v)
      for (int u = 0; u < out.size[std::size_t(plane.u)]; ++u) {
        const double inside =
            (1 - t) * a.at(u - t * move_u, v - t * move_v) + t * b.at(u + (1 - t) * move_u, v + (1 - t) * move_v);
        std::uint8_t& voxel = out.voxels[std::size_t(index) * plane.step[std::size_t(plane.axis)] +
                                         std::size_t(u) * plane.step[std::size_t(plane.u)] +
                                         std::size_t(v) * plane.step[std::size_t(plane.v)]];
        if (inside > 0 && voxel == 0) voxel = value;
      }
  }
}

}  // namespace

grid::Mask between_slices(const grid::Mask& painted, std::uint8_t value, int axis, const Progress& progress) {
  if (axis < 0 || axis > 2) throw Error(ExitCode::usage, "", "axis", "must be 0, 1 or 2");
  const Plane plane(painted, axis);
  std::vector<int> slices;
  for (int i = 0; i < painted.size[std::size_t(axis)]; ++i)
    if (is_painted(painted, value, plane, i)) slices.push_back(i);
  bool gap = false;
  for (std::size_t n = 1; n < slices.size(); ++n) gap = gap || slices[n] - slices[n - 1] > 1;
  if (!gap)
    throw Error(ExitCode::usage, "", "slices",
                "no empty slice lies between two painted ones: paint the shape in every few slices first");
  grid::Mask out = painted;
  Outline before;
  for (std::size_t n = 0; n < slices.size(); ++n) {
    progress.report(double(n) / double(slices.size()));
    const bool after_gap = n > 0 && slices[n] - slices[n - 1] > 1;
    const bool before_gap = n + 1 < slices.size() && slices[n + 1] - slices[n] > 1;
    if (!after_gap && !before_gap) continue;
    Outline now = outline_of(painted, value, plane, slices[n]);
    if (after_gap) fill(out, value, plane, before, now);
    before = std::move(now);
  }
  return out;
}

}  // namespace trephine::mask
