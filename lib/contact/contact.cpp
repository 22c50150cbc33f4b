// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/cell_walk.h"
#include "contact/contact_cell.h"
#include "contact/contact_way.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {

using detail::between;
using detail::usable;
using detail::within_cell;

ContactVolume::ContactVolume(voxel::HapticVolume& volume, ContactParams params)
    : volume_(volume), params_(params), table_(65536, 0) {
  const grid::Lattice& l = volume.voxels;
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks_[a] = std::max(0, (l.size[a] - 1) >> block_bits);
    count *= std::size_t(blocks_[a]);
  }
  block_state_.assign(count, mixed_block);
  if (params.surface == ContactParams::Surface::subvoxel) {
    block_cells_.assign(2 * count, ~std::uint64_t{0});
    block_names_.assign(count, 0);
  }
  block_near_.assign(count, all_shapes);
  smallest_side_mm_ = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      to_index_.column[std::size_t(b)][a] = l.direction.column[std::size_t(a)][b] / l.spacing_mm[a];
  if (volume.encoding == voxel::HapticEncoding::hu) {
    lowest_ = std::numeric_limits<int>::max();
    for (const voxel::HapticShape& s : volume.shapes) lowest_ = std::min<int>(lowest_, s.window_low);
    for (int raw = -32768; raw <= 32767; ++raw) table_[std::uint16_t(raw)] = raw < lowest_ ? 0 : contact_gap;
    for (const voxel::HapticShape& s : volume.shapes) {
      low_of_[s.number] = s.window_low;
      for (int raw = s.window_low; raw <= s.window_high; ++raw)
        table_[std::uint16_t(raw)] = std::uint32_t(voxel::haptic_full << 8 | contact_pure | s.number);
    }
    note_blocks(grid::whole_box(l));
    return;
  }
  for (const voxel::HapticShape& s : volume.shapes)
    for (int raw = s.window_low; raw <= s.window_high; ++raw) {
      const voxel::detail::RawVoxel v = voxel::detail::split(std::int16_t(raw));
      if (v.number != s.number) continue;
      const int rest = v.bare ? 0 : voxel::haptic_full - v.share,
                pure = v.share == voxel::haptic_full ? contact_pure : 0;
      table_[std::uint16_t(raw)] = std::uint32_t(rest) << 24 | std::uint32_t(v.share) << 16 |
                                   std::uint32_t(v.share + rest) << 8 | std::uint32_t(pure | v.number);
    }
  settle(grid::whole_box(l));
  keep_second_shapes();
}

Vec3 ContactVolume::to_index(Vec3 world_mm) const { return to_index_ * (world_mm - volume_.voxels.origin_mm); }

int ContactVolume::shape_of_uniform_cell(std::size_t block, int i, int j, int k) const {
  constexpr int last = (1 << block_bits) - 1;
  const int cell = (i & last) + ((j & last) << block_bits) + ((k & last) << 2 * block_bits);
  const std::uint64_t cells = __atomic_load_n(&block_cells_[2 * block + std::size_t(cell >> 5)], __ATOMIC_RELAXED);
  const int kind = int(cells >> 2 * (cell & 31) & 3);
  if (kind == 0 || kind == 3) return kind == 0 ? 0 : -1;
  return __atomic_load_n(&block_names_[block], __ATOMIC_RELAXED) >> (kind == 1 ? 0 : 8) & 255;
}

int ContactVolume::shape_of_voxel(int i, int j, int k) const {
  if (!volume_.voxels.contains(i, j, k)) return 0;
  const std::uint32_t e = table_[std::uint16_t(voxel::detail::load_voxel(volume_.voxels.at(i, j, k)))];
  return 2 * entry_filled(e) > voxel::haptic_full ? entry_shape(e) : 0;
}

int ContactVolume::shape_of(Vec3 index) const {
  const auto& size = volume_.voxels.size;
  for (int a = 0; a < 3; ++a)
    if (!(index[a] >= -1 && index[a] <= size[std::size_t(a)])) return 0;
  if (params_.surface == ContactParams::Surface::nearest) {
    const int i = int(std::floor(index.x + 0.5)), j = int(std::floor(index.y + 0.5)),
              k = int(std::floor(index.z + 0.5));
    const int block = shape_of_block(i, j, k);
    return block != mixed_block ? block : shape_of_voxel(i, j, k);
  }
  const int i = int(std::floor(index.x)), j = int(std::floor(index.y)), k = int(std::floor(index.z));
  if (const std::size_t block = block_of(i, j, k); block != no_block) {
    const std::uint32_t state = state_of_block(block);
    if (shape_in(state) != mixed_block) return shape_in(state);
    const int uniform = state & details_known ? shape_of_uniform_cell(block, i, j, k) : -1;
    if (uniform >= 0) return uniform;
  }
  return ContactCell(*this, i, j, k).shape_at(within_cell(index, i, j, k));
}

int ContactVolume::shape_at(Vec3 world_mm) const { return usable(world_mm) ? shape_of(to_index(world_mm)) : 0; }

// Cuts the segment to the lattice's box grown by one voxel, beyond which all is empty; false where nothing is left.
bool ContactVolume::clip(Segment& s) const {
  const Vec3 p = s.begin, q = s.end;
  bool within = true;
  for (int a = 0; a < 3; ++a) {
    const double high = volume_.voxels.size[std::size_t(a)];
    within = within && p[a] >= -1 && q[a] >= -1 && p[a] <= high && q[a] <= high;
  }
  if (within) return true;
  double t0 = 0, t1 = 1;
  for (int a = 0; a < 3; ++a) {
    const double low = -1, high = volume_.voxels.size[std::size_t(a)], d = q[a] - p[a];
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
    const double high = volume_.voxels.size[std::size_t(a)];
    if (t0 > 0) s.begin[a] = std::clamp(p[a] + (q[a] - p[a]) * t0, -1.0, high);
    if (t1 < 1) s.end[a] = std::clamp(p[a] + (q[a] - p[a]) * t1, -1.0, high);
  }
  s.t0 = t0;
  s.t1 = t1;
  return true;
}

// Whether both ends, and so the whole way, lie in one block that holds only that shape.
bool ContactVolume::within_block(const Segment& s, int shape, ContactBox* box) const {
  const double half = params_.surface == ContactParams::Surface::nearest ? 0.5 : 0;
  int first[3];
  for (int a = 0; a < 3; ++a) {
    const double p = s.begin[a] + half, q = s.end[a] + half;
    if (!(p >= 0 && q >= 0 && p < 1 << 30 && q < 1 << 30)) return false;
    first[a] = int(p) >> block_bits;
    if (first[a] != int(q) >> block_bits) return false;
  }
  constexpr int side = 1 << block_bits;
  if (shape_of_block(first[0] * side, first[1] * side, first[2] * side) != shape) return false;
  if (box) {
    box->low = Vec3{double(first[0]), double(first[1]), double(first[2])} * side - Vec3{half, half, half};
    box->high = box->low + Vec3{side, side, side};
  }
  return true;
}

// Walks a way that lies in one cell; false, and nothing is done, where it does not.
bool ContactVolume::within_cell_of(const Segment& s, int shape, const TouchableFaces& faces, Crossing& c,
                                   ContactBox* box) const {
  int at[3];
  for (int a = 0; a < 3; ++a) {
    const double cell = std::floor(s.begin[a]);
    if (!(s.end[a] >= cell && s.end[a] < cell + 1 && std::abs(cell) < 1 << 30)) return false;
    at[a] = int(cell);
  }
  c.from = c.into = shape;
  const ContactCell cell(*this, at[0], at[1], at[2]);
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

ContactVolume::Crossing ContactVolume::walk_voxels(const Segment& s, int shape, const TouchableFaces& faces) const {
  Crossing c;
  c.from = c.into = shape;
  const Vec3 half{0.5, 0.5, 0.5};
  walk_over_cells<block_bits>(s.begin + half, s.end + half, [&](int i, int j, int k, double t0, double) {
    const int block = shape_of_block(i, j, k);
    const int now = block != mixed_block ? block : shape_of_voxel(i, j, k);
    if (now != c.into && c.change(now, t0, faces)) return WalkStep::end;
    return block != mixed_block ? WalkStep::block : WalkStep::cell;
  });
  return c;
}

ContactVolume::Crossing ContactVolume::walk_steps(const Segment& s, int shape, const TouchableFaces& faces) const {
  Crossing c;
  c.from = c.into = shape;
  const Vec3 d = s.end - s.begin, spacing = volume_.voxels.spacing_mm;
  const double length_mm = norm({d.x * spacing.x, d.y * spacing.y, d.z * spacing.z});
  const int steps = std::max(1, int(std::ceil(length_mm / (params_.step_ratio * smallest_side_mm_))));
  for (int n = 0; n <= steps; ++n) {
    const double t = double(n) / steps;
    const int now = shape_of(between(s.begin, s.end, t));
    if (now == c.into) continue;
    if (!c.change(now, t, faces)) continue;
    // The change lies behind the sample before; halving finds it.
    double low = double(std::max(0, n - 1)) / steps;
    for (int halving = 0; halving < 30 && low < c.t; ++halving) {
      const double middle = 0.5 * (low + c.t);
      (shape_of(between(s.begin, s.end, middle)) == c.from ? low : c.t) = middle;
    }
    break;
  }
  return c;
}

Contact ContactVolume::intersect(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces) const {
  Contact out = cross(start_mm, end_mm, start_shape, faces);
  if (out.hit) out.normal = normal_of(out, end_mm - start_mm);
  return out;
}

Contact ContactVolume::cross(Vec3 start_mm, Vec3 end_mm, int start_shape, const TouchableFaces& faces,
                             ContactBox* known) const {
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
  s.begin = to_index(start_mm);
  s.end = to_index(end_mm);
  if (known && known->holds(s.begin) && known->holds(s.end)) return out;
  if (within_block(s, start_shape, known)) return out;
  const bool exact = params_.walk == ContactParams::Walk::exact;
  const bool boxes = params_.surface == ContactParams::Surface::nearest;
  Crossing c;
  int shape = start_shape;
  if (!exact || boxes || !within_cell_of(s, shape, faces, c, known)) {
    if (!clip(s)) {
      out.from = out.into = 0;
      out.passed = start_shape != 0;
      return out;
    }
    if (s.t0 > 0) shape = 0;
    c = !exact ? walk_steps(s, shape, faces) : boxes ? walk_voxels(s, shape, faces) : walk_cells(s, shape, faces);
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
