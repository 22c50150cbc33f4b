// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/scan_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/parallel.h"

namespace trephine::segmentation {
namespace {

constexpr double look_mm = 2, circle_voxels = 2;
constexpr float padding_below_hu = -1100;

/// Distances from a slice's middle, in the slice.
struct Circle {
  double u0, v0, du, dv, radius_mm, slack_mm;

  explicit Circle(const grid::Lattice& l)
      : u0(0.5 * (l.size[0] - 1)), v0(0.5 * (l.size[1] - 1)), du(l.spacing_mm[0]), dv(l.spacing_mm[1]) {
    radius_mm = 0.5 * std::min(l.size[0] * du, l.size[1] * dv);
    slack_mm = circle_voxels * std::max(du, dv);
  }
  double distance_mm(int i, int j) const { return std::hypot((i - u0) * du, (j - v0) * dv); }
  bool crossed(int i, int j, int to_i, int to_j) const {
    return distance_mm(i, j) <= radius_mm + slack_mm && distance_mm(to_i, to_j) >= radius_mm - slack_mm;
  }
};

}  // namespace

double scan_edge_ratio(const mask::HuView& hu, const grid::Field& field) {
  const grid::Lattice& whole = hu.lattice();
  const grid::Box box = grid::place_in(field, whole);
  const Circle circle(whole);
  const int steps[2] = {std::max(1, int(std::lround(look_mm / whole.spacing_mm[0]))),
                        std::max(1, int(std::lround(look_mm / whole.spacing_mm[1])))};
  const double face_mm2[2] = {whole.spacing_mm[1], whole.spacing_mm[0]};  // for each mm of slice
  const auto inside = [&](int i, int j, int k) {                          // of the volume's indices
    i -= box.begin[0], j -= box.begin[1];
    return i >= 0 && j >= 0 && i < field.size[0] && j < field.size[1] && field.at(i, j, k) > 0;
  };
  const auto at_edge = [&](int i, int j, int k, int to_i, int to_j) {
    if (to_i < 0 || to_j < 0 || to_i >= whole.size[0] || to_j >= whole.size[1]) return true;
    return hu(to_i, to_j, k) < padding_below_hu || circle.crossed(i, j, to_i, to_j);
  };
  std::vector<std::array<std::int64_t, 4>> faces(field.size[2], {0, 0, 0, 0});  // all, at the edge: by axis
  parallel_for(0, field.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = box.begin[1]; j < box.begin[1] + field.size[1]; ++j)
        for (int i = box.begin[0]; i < box.begin[0] + field.size[0]; ++i) {
          if (!inside(i, j, k)) continue;
          for (int axis = 0; axis < 2; ++axis)
            for (int sign = -1; sign <= 1; sign += 2) {
              const int di = axis == 0 ? sign : 0, dj = axis == 1 ? sign : 0;
              if (inside(i + di, j + dj, k)) continue;
              ++faces[k][axis];
              faces[k][2 + axis] += at_edge(i, j, k + box.begin[2], i + di * steps[axis], j + dj * steps[axis]) ? 1 : 0;
            }
        }
  });
  double all = 0, cut = 0;
  for (const auto& slice : faces)
    for (int axis = 0; axis < 2; ++axis) {
      all += double(slice[axis]) * face_mm2[axis];
      cut += double(slice[2 + axis]) * face_mm2[axis];
    }
  return all > 0 ? cut / all : 0;
}

}  // namespace trephine::segmentation
