// SPDX-License-Identifier: GPL-3.0-or-later
// How a way is followed through a haptic volume.
#include "contact/crossing.h"

#include "contact/cell_walk.h"
#include "contact/contact_cell.h"

namespace trephine::contact {

using detail::between;
using detail::usable;

namespace {

// Cuts the segment to the lattice's box grown by one voxel, beyond which all is empty; false where nothing is left.
bool clip(const FeltLattice& felt, Segment& s) {
  const Vec3 p = s.begin, q = s.end;
  bool within = true;
  for (int a = 0; a < 3; ++a) {
    const double high = felt.volume.voxels.size[std::size_t(a)];
    within = within && p[a] >= -1 && q[a] >= -1 && p[a] <= high && q[a] <= high;
  }
  if (within) return true;
  double t0 = 0, t1 = 1;
  for (int a = 0; a < 3; ++a) {
    const double low = -1, high = felt.volume.voxels.size[std::size_t(a)], d = q[a] - p[a];
    if (d == 0) {
      if (p[a] < low || p[a] > high) return false;
      continue;
    }
    const double u = (low - p[a]) / d, v = (high - p[a]) / d;
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
  }
  if (!(t0 <= t1)) return false;
  for (int a = 0; a < 3; ++a) {
    const double high = felt.volume.voxels.size[std::size_t(a)];
    if (t0 > 0) s.begin[a] = std::clamp(p[a] + (q[a] - p[a]) * t0, -1.0, high);
    if (t1 < 1) s.end[a] = std::clamp(p[a] + (q[a] - p[a]) * t1, -1.0, high);
  }
  s.t0 = t0;
  s.t1 = t1;
  return true;
}

// Whether both ends, and so the whole way, lie in one block that holds only that shape.
bool within_block(const FeltLattice& felt, const Segment& s, int shape, ContactBox* box) {
  const double half = felt.boxes() ? 0.5 : 0;
  int first[3];
  for (int a = 0; a < 3; ++a) {
    const double p = s.begin[a] + half, q = s.end[a] + half;
    if (!(p >= 0 && q >= 0 && p < 1 << 30 && q < 1 << 30)) return false;
    first[a] = int(p) >> KnownBlocks::block_bits;
    if (first[a] != int(q) >> KnownBlocks::block_bits) return false;
  }
  constexpr int side = 1 << KnownBlocks::block_bits;
  if (felt.blocks.shape_of_block(first[0] * side, first[1] * side, first[2] * side) != shape) return false;
  if (box) {
    box->low = Vec3{double(first[0]), double(first[1]), double(first[2])} * side - Vec3{half, half, half};
    box->high = box->low + Vec3{side, side, side};
  }
  return true;
}

// Walks a way that lies in one cell; false, and nothing is done, where it does not.
bool within_cell_of(const FeltLattice& felt, const Segment& s, int shape, const TouchableFaces& faces, Crossing& c,
                    ContactBox* box) {
  int at[3];
  for (int a = 0; a < 3; ++a) {
    const double cell = std::floor(s.begin[a]);
    if (!(s.end[a] >= cell && s.end[a] < cell + 1 && std::abs(cell) < 1 << 30)) return false;
    at[a] = int(cell);
  }
  c.from = c.into = shape;
  const ContactCell cell(felt, at[0], at[1], at[2]);
  if (!cell.uniform()) {
    walk_cell(cell, s, at, 0, 1, faces, c);
    return true;
  }
  if (cell.shape() != shape) {
    c.change(cell.shape(), 0, faces);
  } else if (box) {
    box->low = {double(at[0]), double(at[1]), double(at[2])};
    box->high = box->low + Vec3{1, 1, 1};
  }
  return true;
}

Crossing walk_voxels(const FeltLattice& felt, const Segment& s, int shape, const TouchableFaces& faces) {
  Crossing c;
  c.from = c.into = shape;
  const Vec3 half{0.5, 0.5, 0.5};
  walk_over_cells<KnownBlocks::block_bits>(s.begin + half, s.end + half, [&](int i, int j, int k, double t0, double) {
    const int block = felt.blocks.shape_of_block(i, j, k);
    const int now = block != KnownBlocks::mixed_block ? block : felt.shape_of_voxel(i, j, k);
    if (now != c.into && c.change(now, t0, faces)) return WalkStep::end;
    return block != KnownBlocks::mixed_block ? WalkStep::block : WalkStep::cell;
  });
  return c;
}

Crossing walk_steps(const FeltLattice& felt, const Segment& s, int shape, const TouchableFaces& faces) {
  Crossing c;
  c.from = c.into = shape;
  const Vec3 d = s.end - s.begin, spacing = felt.volume.voxels.spacing_mm;
  const double length_mm = norm({d.x * spacing.x, d.y * spacing.y, d.z * spacing.z});
  const int steps = std::max(1, int(std::ceil(length_mm / (felt.params.step_ratio * felt.smallest_side_mm))));
  for (int n = 0; n <= steps; ++n) {
    const double t = double(n) / steps;
    const int now = felt.shape_of(between(s.begin, s.end, t));
    if (now == c.into) continue;
    if (!c.change(now, t, faces)) continue;
    // The change lies behind the sample before; halving finds it.
    double low = double(std::max(0, n - 1)) / steps;
    for (int halving = 0; halving < 30 && low < c.t; ++halving) {
      const double middle = 0.5 * (low + c.t);
      (felt.shape_of(between(s.begin, s.end, middle)) == c.from ? low : c.t) = middle;
    }
    break;
  }
  return c;
}

}  // namespace

Contact cross_segment(const FeltLattice& felt, Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces,
                      ContactBox* known) {
  Contact out;
  out.point_mm = end_mm;
  out.from = out.into = start_shape;
  if (!usable(start_mm) || !usable(end_mm)) {
    out.refused = true;
    out.from = out.into = 0;
    return out;
  }
  const Vec3 way = end_mm - start_mm;
  if (way == Vec3{}) return out;
  Segment s;
  s.begin = felt.to_index(start_mm);
  s.end = felt.to_index(end_mm);
  if (known && known->holds(s.begin) && known->holds(s.end)) return out;
  if (within_block(felt, s, start_shape, known)) return out;
  const bool exact = felt.params.walk == ContactParams::Walk::exact;
  const bool boxes = felt.boxes();
  Crossing c;
  int shape = start_shape;
  if (!exact || boxes || !within_cell_of(felt, s, shape, faces, c, known)) {
    if (!clip(felt, s)) {
      out.from = out.into = 0;
      out.passed = start_shape != 0;
      return out;
    }
    if (s.t0 > 0) shape = 0;
    c = !exact  ? walk_steps(felt, s, shape, faces)
        : boxes ? walk_voxels(felt, s, shape, faces)
                : walk_cells(felt, s, shape, faces);
  }
  out.passed = c.passed || shape != start_shape || (!c.hit && s.t1 < 1 && c.into != 0);
  if (!c.hit) {
    out.from = out.into = s.t1 < 1 ? 0 : c.into;
    return out;
  }
  out.hit = true;
  out.from = c.from;
  out.into = c.into;
  out.along = s.t0 + (s.t1 - s.t0) * c.t;
  out.point_mm = between(start_mm, end_mm, out.along);
  const bool front = c.into != 0 && (faces.front >> c.into & 1);
  out.face = front ? ContactFace::front : ContactFace::back;
  out.shape = front ? c.into : c.from;
  return out;
}

}  // namespace trephine::contact
