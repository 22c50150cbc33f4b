// SPDX-License-Identifier: GPL-3.0-or-later
#include "body/board.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/rank.h"

namespace trephine::body {
namespace {

constexpr double solid_hu = -500;  ///< halfway from air to plastic
constexpr double in_all = 0.97;    ///< of the slices
constexpr double min_length_mm = 60, min_face_mm = 100, min_end_mm = 15, max_thickness_mm = 60;
constexpr double straight_mm = 1.5, straight_voxels = 0.7;
constexpr double min_straight = 0.85;  ///< of the face
constexpr double min_offset_mm = 20;   ///< a board lies beside the body's middle

/// By how many voxels a line along the table (LPS z) is moved within each slice, from that in the middle one. Slices of
/// a tilted gantry cut the table aslant.
struct AlongTable {
  double i = 0, j = 0;  ///< for each slice
  int middle = 0;

  explicit AlongTable(const grid::Lattice& l) : middle(l.size[2] / 2) {
    const Vec3 way = transpose_times(l.direction, Vec3{0, 0, 1});
    if (std::abs(way.z) < 0.7) return;
    const double mm = l.spacing_mm.z / way.z;
    i = way.x * mm / l.spacing_mm.x, j = way.y * mm / l.spacing_mm.y;
  }
  int move_i(int k) const { return int(std::lround(i * (k - middle))); }
  int move_j(int k) const { return int(std::lround(j * (k - middle))); }
};

/// The places, as seen along the table, that are solid in nearly all slices: a lattice of one slice.
mask::BitMask lengthwise(const mask::BitMask& solid, const AlongTable& along) {
  const grid::Lattice& l = solid.lattice();
  grid::Lattice flat = l;
  flat.spacing_mm[2] *= flat.size[2];  // a cell is as deep as the scan is long
  flat.size[2] = 1;
  const int least = int(std::ceil(in_all * l.size[2]));
  return mask::make_mask(flat, [&](int j, int, std::uint8_t* row) {
    std::vector<int> count(std::size_t(l.size[0]));
    for (int k = 0; k < l.size[2]; ++k)
      for (int i = 0; i < l.size[0]; ++i)
        count[std::size_t(i)] += solid.at(i + along.move_i(k), j + along.move_j(k), k);
    for (int i = 0; i < l.size[0]; ++i) row[i] = count[std::size_t(i)] >= least;
  });
}

/// A stretch of the flat image across `axis`, for each place along the other axis: [from, to), empty where none.
struct Profile {
  int first = 0;
  std::vector<std::array<int, 2>> runs;
};

/// The runs of the component across `axis` that reach farthest to the end, or to the beginning.
Profile profile_of(const mask::BitMask& part, int axis, bool at_end) {
  const grid::Box box = part.bounds();
  const int along = 1 - axis;
  Profile p;
  p.first = box.begin[std::size_t(along)];
  for (int a = p.first; a < box.end[std::size_t(along)]; ++a) {
    const auto set = [&](int c) { return axis == 1 ? part.get(a, c, 0) : part.get(c, a, 0); };
    std::array<int, 2> run{0, 0};
    const int from = box.begin[std::size_t(axis)], to = box.end[std::size_t(axis)];
    if (at_end) {
      int c = to - 1;
      while (c >= from && !set(c)) --c;
      run[1] = c + 1;
      while (c >= from && set(c)) --c;
      run[0] = c + 1;
    } else {
      int c = from;
      while (c < to && !set(c)) ++c;
      run[0] = c;
      while (c < to && set(c)) ++c;
      run[1] = c;
    }
    p.runs.push_back(run);
  }
  return p;
}

/// Whether the faces that look at the body lie on a straight line; for one that is thin enough.
struct Line {
  double at = 0, slope = 0;
  bool straight = false;
};

Line face_of(const Profile& p, bool at_end, double max_run, double tolerance) {
  std::vector<std::array<double, 2>> points;
  for (std::size_t a = 0; a < p.runs.size(); ++a) {
    const auto& [from, to] = p.runs[a];
    if (to > from && to - from <= max_run) points.push_back({double(p.first) + double(a), at_end ? from : to - 1.0});
  }
  Line line;
  if (points.size() < 5) return line;
  // The median of slopes between the two halves, and of offsets: a few places where something lies on it do no harm.
  std::vector<double> slopes, offsets;
  const std::size_t half = points.size() / 2;
  for (std::size_t i = 0; i + half < points.size(); ++i)
    slopes.push_back((points[i + half][1] - points[i][1]) / (points[i + half][0] - points[i][0]));
  line.slope = median_of(slopes);
  for (const auto& [x, y] : points) offsets.push_back(y - line.slope * x);
  line.at = median_of(offsets);
  std::size_t near = 0;
  for (const auto& [x, y] : points) near += std::abs(y - line.at - line.slope * x) <= tolerance;
  line.straight = double(near) >= min_straight * double(points.size());
  return line;
}

struct Flat {
  mask::BitMask places;
  double thickness_mm = 0, width_mm = 0;
};

/// The board of which `part` (places solid in all slices) consists, or which lies beside and under a body in it.
Flat board_in(const mask::BitMask& part, int axis, bool at_end, const Progress& progress) {
  const grid::Lattice& l = part.lattice();
  const int along = 1 - axis;
  const double step = l.spacing_mm[axis], width_step = l.spacing_mm[along];
  mask::BitMask thin = part;
  const mask::BitMask thick = mask::eroded(part, max_thickness_mm / 2, progress);
  const bool with_body = thick.any();
  if (with_body) thin.remove(mask::dilated(thick, max_thickness_mm / 2 + 2 * std::max(step, width_step), progress));
  Flat none;
  if (!thin.any()) return none;
  Profile p = profile_of(thin, axis, at_end);
  for (std::size_t a = 0; a < p.runs.size(); ++a) {  // under the body it shows no face
    const int x = p.first + int(a), next = at_end ? p.runs[a][0] - 1 : p.runs[a][1];
    if (axis == 1 ? part.at(x, next, 0) : part.at(next, x, 0)) p.runs[a] = {0, 0};
  }
  const Line line = face_of(p, at_end, max_thickness_mm / step, std::max(straight_mm / step, straight_voxels));
  if (!line.straight) return none;
  std::size_t solid = 0;
  std::vector<int> thickness;
  int first = -1, last = -1;
  for (std::size_t a = 0; a < p.runs.size(); ++a) {
    const auto& [from, to] = p.runs[a];
    const double x = double(p.first) + double(a), face = line.at + line.slope * x;
    if (to <= from || std::abs((at_end ? from : to - 1) - face) > std::max(straight_mm / step, straight_voxels))
      continue;
    ++solid;
    thickness.push_back(to - from);
    if (first < 0) first = int(x);
    last = int(x);
  }
  if (thickness.empty()) return none;
  const int deep = median_of(thickness);
  Flat out;
  out.thickness_mm = deep * step;
  out.width_mm = (last - first + 1) * width_step;
  if (out.width_mm < min_face_mm || double(solid) * width_step < (with_body ? 2 * min_end_mm : 0.7 * min_face_mm))
    return none;
  out.places = mask::make_mask(l, [&](int j, int, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      const int x = axis == 1 ? i : j, c = axis == 1 ? j : i;
      const double face = std::floor(line.at + line.slope * x + 0.5);
      const double depth = at_end ? c - face : face - c;
      row[i] = x >= first && x <= last && depth >= 0 && depth < deep + 1;
    }
  });
  return out;
}

}  // namespace

Board find_board(const mask::HuView& hu, const Progress& progress) {
  const grid::Lattice& l = hu.lattice();
  Board board;
  if (l.size[2] * l.spacing_mm.z < min_length_mm || l.size[2] < 5) return board;
  const mask::BitMask solid = mask::above(hu, solid_hu);
  const AlongTable along(l);
  const mask::BitMask flat = lengthwise(solid, along);
  const mask::Components parts = mask::components(flat, true);
  const Vec3 middle = solid.lattice().to_index(mask::largest(mask::components(solid)).centre_mm());
  double best = 0;
  Flat found;
  for (std::size_t c = 0; c < parts.list.size(); ++c) {
    const grid::Box& box = parts.list[c].box;
    for (const int axis : {1, 0}) {
      if ((box.end[std::size_t(1 - axis)] - box.begin[std::size_t(1 - axis)]) * l.spacing_mm[1 - axis] < min_face_mm)
        continue;
      progress.check();
      std::vector<char> one(parts.list.size());
      one[c] = 1;
      for (const bool at_end : {true, false}) {
        Flat here = board_in(mask::select(parts, one), axis, at_end, progress);
        if (here.width_mm <= best) continue;
        const Vec3 at = l.to_index(here.places.centre_mm());
        const double offset = (at[axis] - middle[axis]) * l.spacing_mm[axis] * (at_end ? 1 : -1);
        if (offset < min_offset_mm) continue;
        best = here.width_mm;
        found = std::move(here);
        board.axis = axis;
        board.at_end = at_end;
      }
    }
  }
  if (best == 0) return board;
  board.thickness_mm = found.thickness_mm;
  board.width_mm = found.width_mm;
  board.voxels = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = found.places.at(i - along.move_i(k), j - along.move_j(k), 0);
  });
  return board;
}

}  // namespace trephine::body
