// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "voxel/cell_walk.h"
#include "voxel/contact_cell.h"
#include "voxel/raw_voxel.h"

namespace trephine {
namespace {

constexpr double farthest_mm = 1e9;

bool usable(Vec3 p) {
  return std::abs(p.x) <= farthest_mm && std::abs(p.y) <= farthest_mm && std::abs(p.z) <= farthest_mm;  // not for NaN
}

Vec3 between(Vec3 p, Vec3 q, double t) { return p + (q - p) * t; }

Vec3 within_cell(Vec3 p, int i, int j, int k) {
  return {std::clamp(p.x - i, 0.0, 1.0), std::clamp(p.y - j, 0.0, 1.0), std::clamp(p.z - k, 0.0, 1.0)};
}

}  // namespace

// The part of a segment that lies in the lattice's box, in voxel indices.
struct ContactVolume::Segment {
  Vec3 begin, end;
  double t0 = 0, t1 = 1;  // where that part begins and ends on the whole
};

struct ContactVolume::Crossing {
  bool hit = false, passed = false;
  double t = 1;  // of the part
  int from = 0, into = 0;
  bool change(int now, double at, const TouchableFaces& faces);
};

namespace {

// The face that stops a segment which crosses over.
bool stops(int from, int into, const TouchableFaces& faces) {
  return (into != 0 && (faces.front >> into & 1)) || (from != 0 && (faces.back >> from & 1));
}

}  // namespace

ContactVolume::ContactVolume(HapticVolume& volume, ContactParams params)
    : volume_(volume), params_(params), table_(65536, 0) {
  const Lattice& l = volume.voxels;
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    blocks_[a] = std::max(0, (l.size[a] - 1) >> block_bits);
    count *= std::size_t(blocks_[a]);
  }
  block_shape_.assign(count, mixed_block);
  if (params.surface == ContactParams::Surface::subvoxel) {
    block_cells_.assign(2 * count, ~std::uint64_t{0});
    block_names_.assign(count, 0);
  }
  block_near_.assign(count, all_shapes);
  smallest_side_mm_ = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      to_index_.column[std::size_t(b)][a] = l.direction.column[std::size_t(a)][b] / l.spacing_mm[a];
  if (volume.encoding == HapticEncoding::hu) {
    lowest_ = std::numeric_limits<int>::max();
    for (const HapticShape& s : volume.shapes) lowest_ = std::min<int>(lowest_, s.window_low);
    for (int raw = -32768; raw <= 32767; ++raw) table_[std::uint16_t(raw)] = raw < lowest_ ? 0 : contact_gap;
    for (const HapticShape& s : volume.shapes) {
      low_of_[s.number] = s.window_low;
      for (int raw = s.window_low; raw <= s.window_high; ++raw)
        table_[std::uint16_t(raw)] = std::uint32_t(haptic_full << 8 | contact_pure | s.number);
    }
    note_blocks(whole_box(l));
    return;
  }
  for (const HapticShape& s : volume.shapes)
    for (int raw = s.window_low; raw <= s.window_high; ++raw) {
      const detail::RawVoxel v = detail::split(std::int16_t(raw));
      if (v.number != s.number) continue;
      const int rest = v.bare ? 0 : haptic_full - v.share, pure = v.share == haptic_full ? contact_pure : 0;
      table_[std::uint16_t(raw)] = std::uint32_t(rest) << 24 | std::uint32_t(v.share) << 16 |
                                   std::uint32_t(v.share + rest) << 8 | std::uint32_t(pure | v.number);
    }
  settle(whole_box(l));
  keep_seconds();
}

Vec3 ContactVolume::to_index(Vec3 world_mm) const { return to_index_ * (world_mm - volume_.voxels.origin_mm); }

int ContactVolume::shape_of_uniform_cell(std::size_t block, int i, int j, int k) const {
  constexpr int last = (1 << block_bits) - 1;
  const int cell = (i & last) + ((j & last) << block_bits) + ((k & last) << 2 * block_bits);
  const std::uint64_t cells = __atomic_load_n(&block_cells_[2 * block + std::size_t(cell >> 5)], __ATOMIC_ACQUIRE);
  const int kind = int(cells >> 2 * (cell & 31) & 3);
  if (kind == 0 || kind == 3) return kind == 0 ? 0 : -1;
  return __atomic_load_n(&block_names_[block], __ATOMIC_RELAXED) >> (kind == 1 ? 0 : 8) & 255;
}

int ContactVolume::shape_of_voxel(int i, int j, int k) const {
  if (!volume_.voxels.contains(i, j, k)) return 0;
  const std::uint32_t e = table_[std::uint16_t(detail::load_voxel(volume_.voxels.at(i, j, k)))];
  return 2 * entry_filled(e) > haptic_full ? entry_shape(e) : 0;
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
  const int block = shape_of_block(i, j, k);
  if (block != mixed_block) return block;
  const int bi = i >> block_bits, bj = j >> block_bits, bk = k >> block_bits;
  const int uniform = has_block(bi, bj, bk) ? shape_of_uniform_cell(block_at(bi, bj, bk), i, j, k) : -1;
  return uniform >= 0 ? uniform : ContactCell(*this, i, j, k).shape_at(within_cell(index, i, j, k));
}

int ContactVolume::shape_at(Vec3 world_mm) const { return usable(world_mm) ? shape_of(to_index(world_mm)) : 0; }

// Keeps what lies in the lattice's box grown by one voxel, beyond which nothing is; false where nothing is left.
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

// Whether both ends, and so all between them, lie in one block that is of that shape alone.
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

// Notes that the shape changes at t; true where the walk ends there.
bool ContactVolume::Crossing::change(int now, double at, const TouchableFaces& faces) {
  from = into;
  into = now;
  t = at;
  hit = stops(from, now, faces);
  passed = passed || !hit;
  return hit;
}

// The part of a segment, from t0 to t1, that lies in a cell of more than one shape.
bool ContactVolume::walk_cell(const ContactCell& cell, const Segment& s, const int* at, double t0, double t1,
                              const TouchableFaces& faces, Crossing& c) const {
  const Vec3 p = within_cell(between(s.begin, s.end, t0), at[0], at[1], at[2]);
  const Vec3 q = within_cell(between(s.begin, s.end, t1), at[0], at[1], at[2]);
  const int all = cell.shape_along(p, q);
  if (all >= 0) return all != c.into && c.change(all, t0, faces);
  double breaks[ContactCell::max_breaks + 1];
  int count = cell.breaks(p, q, breaks);
  breaks[count++] = 1;
  double before = 0;
  for (int n = 0; n < count; ++n) {
    const int now = cell.shape_at(between(p, q, 0.5 * (before + breaks[n])));
    if (now != c.into && c.change(now, t0 + (t1 - t0) * before, faces)) return true;
    before = breaks[n];
  }
  return false;
}

// The whole way where it lies in one cell; false where it does not.
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

ContactVolume::Crossing ContactVolume::walk_cells(const Segment& s, int shape, const TouchableFaces& faces) const {
  Crossing c;
  c.from = c.into = shape;
  // Where nothing is that can stop the way, and what it passed need not be known any more, cells are left out: which
  // shape the last of them ends in is found out where it matters.
  const std::uint32_t touch = std::uint32_t((faces.front | faces.back) >> 1);
  struct {
    int at[3];
    double t0, t1;
    bool open = false;
  } left;
  const auto touches = [&](int number) { return number != 0 && (touch >> (number - 1) & 1); };
  const auto look_back = [&] {
    if (left.open) c.into = end_of_cell(s, left.at, left.t0, left.t1);
    left.open = false;
  };
  const auto enter = [&](int number, double t) {
    if (touches(number)) look_back();
    if (left.open) c.into = number;
    left.open = false;
    return number != c.into && c.change(number, t, faces);
  };
  int block_of[3] = {0, 0, 0}, block = unknown_block;
  std::size_t block_index = 0;
  std::uint32_t near = 0;
  walk_over_cells<block_bits>(s.begin, s.end, [&](int i, int j, int k, double t0, double t1) {
    const int bi = i >> block_bits, bj = j >> block_bits, bk = k >> block_bits;
    if (block == unknown_block || ((bi ^ block_of[0]) | (bj ^ block_of[1]) | (bk ^ block_of[2])) != 0) {
      block_of[0] = bi, block_of[1] = bj, block_of[2] = bk;
      block = outer_block;
      near = all_shapes;
      if (has_block(bi, bj, bk)) {
        block_index = block_at(bi, bj, bk);
        block = __atomic_load_n(&block_shape_[block_index], __ATOMIC_RELAXED);
        if (block == mixed_block) near = __atomic_load_n(&block_near_[block_index], __ATOMIC_RELAXED);
      }
    }
    if (block < mixed_block) return enter(block, t0) ? WalkStep::end : WalkStep::block;
    if (block == mixed_block) {
      const int uniform = shape_of_uniform_cell(block_index, i, j, k);
      if (uniform >= 0) return enter(uniform, t0) ? WalkStep::end : WalkStep::cell;
    }
    const bool may_leave = c.passed && (left.open || !touches(c.into));
    if (may_leave && (near & touch) == 0) {
      left = {{i, j, k}, t0, t1, true};
      return WalkStep::cell;
    }
    const ContactCell cell(*this, i, j, k, may_leave ? touch : all_shapes);
    if (cell.uniform()) return enter(cell.shape(), t0) ? WalkStep::end : WalkStep::cell;
    if (!cell.touched()) {
      left = {{i, j, k}, t0, t1, true};
      return WalkStep::cell;
    }
    look_back();
    const int at[3] = {i, j, k};
    return walk_cell(cell, s, at, t0, t1, faces, c) ? WalkStep::end : WalkStep::cell;
  });
  look_back();
  return c;
}

// The shape in which the way leaves that cell.
int ContactVolume::end_of_cell(const Segment& s, const int* at, double t0, double t1) const {
  const ContactCell cell(*this, at[0], at[1], at[2]);
  Crossing c;
  if (cell.uniform())
    c.into = cell.shape();
  else
    walk_cell(cell, s, at, t0, t1, {0, 0}, c);
  return c.into;
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

Vec3 ContactVolume::normal_of(const Contact& c, Vec3 way) const {
  const Vec3 forward = normalized(way);
  Vec3 n = normal_at(c.point_mm, c.from, c.into);
  // The differences are smoother than the surface: where they point along the way, the normal is turned across it.
  const double ahead = dot(n, forward);
  if (n == Vec3{} || ahead > 0.999)
    n = -forward;
  else if (ahead > -1e-3)
    n = normalized(n - forward * (ahead + 1e-3));
  return n;
}

// What rises at the voxels of the 4 x 4 x 4 from `begin` on towards `into`, or, where that is nothing, towards `from`,
// x the first index. False where they are not all in the lattice, or `hu`.
bool ContactVolume::shares_around(const int* begin, int from, int into, double (*v)[16]) const {
  const Grid<std::int16_t>& voxels = volume_.voxels;
  for (int a = 0; a < 3; ++a)
    if (begin[a] < 0 || begin[a] + 4 > voxels.size[std::size_t(a)]) return false;
  if (volume_.encoding == HapticEncoding::hu) return false;
  const std::size_t row_step = std::size_t(voxels.size[0]), slice_step = row_step * std::size_t(voxels.size[1]);
  const std::int16_t* const first = voxels.voxels.data() + voxels.index(begin[0], begin[1], begin[2]);
  std::uint32_t e[4][16];
  for (std::size_t z = 0; z < 4; ++z)
    for (std::size_t y = 0; y < 4; ++y) {
      const std::int16_t* row = first + z * slice_step + y * row_step;
      for (std::size_t x = 0; x < 4; ++x) e[x][4 * z + y] = table_[std::uint16_t(detail::load_voxel(row[x]))];
    }
  if (from == 0 || into == 0) {  // no question of whose
    for (int x = 0; x < 4; ++x)
      for (int n = 0; n < 16; ++n) v[x][n] = entry_filled(e[x][n]);
    return true;
  }
  // What another shape's voxel leaves: this one's, where there are no others.
  std::uint32_t near = 0;
  for (int n = 0; n < 8; ++n)
    near |= near_block(begin[0] + 3 * (n & 1), begin[1] + 3 * (n >> 1 & 1), begin[2] + 3 * (n >> 2));
  const std::uint32_t others = near & ~(std::uint32_t{1} << (into - 1));
  const bool two = (others & (others - 1)) == 0;
  const int ours = two && others != near ? ~0 : 0;
  for (int x = 0; x < 4; ++x)
    for (int n = 0; n < 16; ++n)
      v[x][n] = entry_shape(e[x][n]) == into ? entry_share(e[x][n]) : entry_rest(e[x][n]) & ours;
  if (two || others == near) return true;
  for (int x = 0; x < 4; ++x)
    for (int n = 0; n < 16; ++n) {
      const int own = entry_shape(e[x][n]), rest = entry_rest(e[x][n]);
      if (rest != 0 && own != into && second_of(own, begin[0] + x, begin[1] + (n & 3), begin[2] + (n >> 2)) == into)
        v[x][n] = rest;
    }
  return true;
}

// The same voxel by voxel, whatever there is; of HU, those of air and of the shape.
double ContactVolume::share_around(int i, int j, int k, int from, int into) const {
  const int number = into != 0 ? into : from;
  const bool hu = volume_.encoding == HapticEncoding::hu, inside = volume_.voxels.contains(i, j, k);
  const int raw = inside ? detail::load_voxel(volume_.voxels.at(i, j, k)) : hu ? haptic_beyond_hu : haptic_empty;
  const std::uint32_t e = table_[std::uint16_t(raw)];
  if (!hu) {
    if (from == 0 || into == 0) return entry_filled(e);
    if (entry_shape(e) == number) return entry_share(e);
    return entry_rest(e) != 0 && second_of(entry_shape(e), i, j, k) == number ? entry_rest(e) : 0;
  }
  const double half = std::max(1, low_of_[number] + 1000);
  if (entry_shape(e) == number || (e == 0 && (from == 0 || into == 0)))
    return std::clamp(0.5 + (raw - low_of_[number]) / (2 * half), 0.0, 1.0);
  return (from == 0 || into == 0) && e != 0 && e != contact_gap ? 1 : 0;
}

Vec3 ContactVolume::normal_at(Vec3 world_mm, int from, int into) const {
  if (!usable(world_mm) || from == into) return {};
  const Lattice& l = volume_.voxels;
  const Vec3 index = to_index(world_mm);
  int begin[3];
  Vec3 f;
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -1 && index[a] <= l.size[std::size_t(a)])) return {};
    const int cell = int(std::floor(index[a]));
    f[a] = index[a] - cell;
    begin[a] = cell - 1;
  }
  double v[4][16];
  if (!shares_around(begin, from, into, v))
    for (int n = 0; n < 16; ++n)
      for (int x = 0; x < 4; ++x)
        v[x][n] = share_around(begin[0] + x, begin[1] + (n & 3), begin[2] + (n >> 2), from, into);
  // Along an axis: differences two voxels apart, and the weights 1 2 1, both interpolated to the point.
  double change[3][4], smooth[3][4];
  for (int a = 0; a < 3; ++a) {
    const double t = f[a], u = 1 - t;
    const double d[4] = {-u, -t, u, t}, w[4] = {0.25 * u, 0.5 * u + 0.25 * t, 0.25 * u + 0.5 * t, 0.25 * t};
    std::copy(d, d + 4, change[a]);
    std::copy(w, w + 4, smooth[a]);
  }
  double gx[16], gy[16], gz[16];
  for (int n = 0; n < 16; ++n) {
    gx[n] = change[0][0] * v[0][n] + change[0][1] * v[1][n] + change[0][2] * v[2][n] + change[0][3] * v[3][n];
    gy[n] = smooth[0][0] * v[0][n] + smooth[0][1] * v[1][n] + smooth[0][2] * v[2][n] + smooth[0][3] * v[3][n];
  }
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y) {
      const int n = 4 * z + y;
      gx[n] = smooth[2][z] * smooth[1][y] * gx[n];
      gz[n] = change[2][z] * smooth[1][y] * gy[n];
      gy[n] = smooth[2][z] * change[1][y] * gy[n];
    }
  Vec3 g;
  for (int n = 0; n < 16; ++n) {
    g.x += gx[n];
    g.y += gy[n];
    g.z += gz[n];
  }
  g = l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z};
  const double length = norm(g);
  if (!(length > 1e-9)) return {};
  return g / (into != 0 ? -length : length);
}

Vec3 ContactVolume::exact_normal(const Contact& contact, Vec3 way) const {
  if (!contact.hit || params_.surface == ContactParams::Surface::nearest) return {};
  const Lattice& l = volume_.voxels;
  const Vec3 index = to_index(contact.point_mm), ahead = index + normalized(to_index_ * way) * 1e-7;
  const int i = int(std::floor(ahead.x)), j = int(std::floor(ahead.y)), k = int(std::floor(ahead.z));
  const Vec3 g = ContactCell(*this, i, j, k).gradient(within_cell(index, i, j, k), contact.from, contact.into);
  return -normalized(l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z});
}

}  // namespace trephine
