// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_cell.h"

#include <algorithm>
#include <cmath>

#include "voxel/raw_voxel.h"

namespace trephine::contact {
namespace {

constexpr double half_full = 0.5 * voxel::haptic_full;

double interpolate(const std::array<double, 8>& c, Vec3 p) {
  const double x0 = c[0] + p.x * (c[1] - c[0]), x1 = c[2] + p.x * (c[3] - c[2]);
  const double x2 = c[4] + p.x * (c[5] - c[4]), x3 = c[6] + p.x * (c[7] - c[6]);
  const double y0 = x0 + p.y * (x1 - x0), y1 = x2 + p.y * (x3 - x2);
  return y0 + p.z * (y1 - y0);
}

using Pair = double __attribute__((vector_size(16)));

Pair between(Pair a, Pair b, Pair t) { return a + t * (b - a); }
Pair both(double v) { return Pair{v, v}; }

// The function at the corners of the box between p and q: first by z, then by y; a pair holds the x of p and of q.
std::array<Pair, 4> at_box(const std::array<double, 8>& c, Vec3 p, Vec3 q) {
  const Pair x = {p.x, q.x};
  const Pair x0 = between(both(c[0]), both(c[1]), x), x1 = between(both(c[2]), both(c[3]), x);
  const Pair x2 = between(both(c[4]), both(c[5]), x), x3 = between(both(c[6]), both(c[7]), x);
  const Pair p0 = between(x0, x1, both(p.y)), p1 = between(x2, x3, both(p.y));
  const Pair q0 = between(x0, x1, both(q.y)), q1 = between(x2, x3, both(q.y));
  return {between(p0, p1, both(p.z)), between(q0, q1, both(p.z)), between(p0, p1, both(q.z)),
          between(q0, q1, both(q.z))};
}

// The trilinear function from p to q is a cubic. Its Bernstein coefficients are means of the box's corner values.
std::array<double, 4> along(const std::array<double, 8>& c, Vec3 p, Vec3 q) {
  const std::array<Pair, 4> v = at_box(c, p, q);
  return {v[0][0], (v[0][1] + v[1][0] + v[2][0]) / 3, (v[1][1] + v[2][1] + v[3][0]) / 3, v[3][1]};
}

double value_at(const std::array<double, 4>& b, double t) {
  const double s = 1 - t;
  return s * s * (s * b[0] + 3 * t * b[1]) + t * t * (3 * s * b[2] + t * b[3]);
}

// The only change of sign within [0, 1], by false position (Illinois); b[0] and b[3] must have different signs.
double only_root(const std::array<double, 4>& b) {
  double lo = 0, hi = 1, f_lo = b[0], f_hi = b[3];
  int side = 0;
  for (int n = 0; n < 60 && hi - lo > 1e-12; ++n) {
    const double t = n < 40 && f_hi != f_lo ? (lo * f_hi - hi * f_lo) / (f_hi - f_lo) : 0.5 * (lo + hi);
    const double f = value_at(b, t);
    if ((f >= 0) == (b[0] >= 0)) {
      if (std::abs(t - lo) < 1e-13) return t;
      lo = t, f_lo = f;
      if (side == 1) f_hi *= 0.5;
      side = 1;
    } else {
      if (std::abs(hi - t) < 1e-13) return t;
      hi = t, f_hi = f;
      if (side == 2) f_lo *= 0.5;
      side = 2;
    }
  }
  return 0.5 * (lo + hi);
}

// Appends the places in (lo, hi) where the sign changes.
void find_roots(const std::array<double, 4>& b, double lo, double hi, int depth, double* out, int& count) {
  int changes = 0;
  for (int n = 0; n < 3; ++n) changes += (b[std::size_t(n)] >= 0) != (b[std::size_t(n) + 1] >= 0);
  if (changes == 0 || count >= ContactCell::max_breaks - 8) return;
  if (changes == 1) {
    out[count++] = lo + (hi - lo) * only_root(b);
    return;
  }
  if (depth == 0) {
    out[count++] = 0.5 * (lo + hi);
    return;
  }
  const double a0 = 0.5 * (b[0] + b[1]), a1 = 0.5 * (b[1] + b[2]), a2 = 0.5 * (b[2] + b[3]);
  const double c0 = 0.5 * (a0 + a1), c1 = 0.5 * (a1 + a2), d = 0.5 * (c0 + c1), mid = 0.5 * (lo + hi);
  if (d == 0) out[count++] = mid;
  find_roots({b[0], a0, c0, d}, lo, mid, depth - 1, out, count);
  find_roots({d, c1, a2, b[3]}, mid, hi, depth - 1, out, count);
}

// For each set of solid corners: whether the other corners fall into parts that no edge of the cell joins. Only then
// can the surface between the corners leave an opening in a wall that the boxes of the voxels close.
std::array<bool, 256> find_parted() {
  std::array<bool, 256> parted{};
  for (int solid = 0; solid < 255; ++solid) {
    const int open = ~solid & 255;
    int seen = open & -open;
    for (int pass = 0; pass < 8; ++pass)
      for (int c = 0; c < 8; ++c)
        if (seen >> c & 1)
          for (int axis = 1; axis < 8; axis <<= 1)
            if (open >> (c ^ axis) & 1) seen |= 1 << (c ^ axis);
    parted[std::size_t(solid)] = seen != open;
  }
  return parted;
}
const std::array<bool, 256> parted = find_parted();

int nearest_corner(Vec3 p) { return (p.x >= 0.5 ? 1 : 0) | (p.y >= 0.5 ? 2 : 0) | (p.z >= 0.5 ? 4 : 0); }

}  // namespace

ContactCell::ContactCell(const FeltLattice& felt, int i, int j, int k, std::uint32_t touch) {
  const grid::Grid<std::int16_t>& v = felt.volume.voxels;
  hu_ = felt.volume.encoding == voxel::HapticEncoding::hu;
  if (i >= 0 && j >= 0 && k >= 0 && i + 1 < v.size[0] && j + 1 < v.size[1] && k + 1 < v.size[2]) {
    const std::int16_t* at = v.voxels.data() + v.index(i, j, k);
    const std::size_t row = std::size_t(v.size[0]), slice = row * std::size_t(v.size[1]);
    const std::size_t offset[8] = {0, 1, row, row + 1, slice, slice + 1, slice + row, slice + row + 1};
    for (std::size_t c = 0; c < 8; ++c) raw_[c] = voxel::detail::load_voxel(at[offset[c]]);
  } else {
    const std::int16_t beyond = hu_ ? std::int16_t(voxel::haptic_beyond_hu) : voxel::haptic_empty;
    for (int c = 0; c < 8; ++c) {
      const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
      raw_[std::size_t(c)] = v.contains(x, y, z) ? voxel::detail::load_voxel(v.at(x, y, z)) : beyond;
    }
  }
  bool same = true;
  int solid = 0;
  std::uint64_t here = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    entry_[c] = felt.table.of(raw_[c]);
    same = same && entry_[c] == entry_[0];
    here |= std::uint64_t{1} << entry_shape(entry_[c]);
    if (2 * entry_filled(entry_[c]) > voxel::haptic_full) solid |= 1 << c;
  }
  const std::uint32_t own = std::uint32_t(here >> 1);
  if (solid == 0 || own == 0) return;
  if (same && (entry_[0] & contact_pure)) {
    shape_ = entry_shape(entry_[0]);
    return;
  }
  uniform_ = false;
  boxes_ = parted[std::size_t(solid)];
  solid_ = solid == 255;
  if (hu_) {
    touched_ = (own & touch) != 0;
    if (touched_) find_windows(felt);
  } else {
    find_shapes(felt, i, j, k, own, touch);
  }
}

// Shapes are numbered in the order in which the corners, one after another, name them.
void ContactCell::find_shapes(const FeltLattice& felt, int i, int j, int k, std::uint32_t own, std::uint32_t touch) {
  std::uint32_t rest = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    filled_[c] = entry_filled(entry_[c]) - half_full;
    rest |= entry_[c] >> 24;
  }
  const std::uint32_t near = felt.blocks.near_block(i, j, k), but_one = near & (near - 1);
  if ((but_one & (but_one - 1)) == 0) {  // two at most: the rest belongs to the other one
    const std::uint32_t all = rest != 0 ? near : own;
    touched_ = (all & touch) != 0;
    if (!touched_) return;
    int first = 0;
    for (std::size_t c = 0; c < 8 && first == 0; ++c) first = entry_shape(entry_[c]);
    number_[0] = first;
    const std::uint32_t other = all & ~(std::uint32_t{1} << (first - 1));
    count_ = 1;
    if (other == 0) return;
    number_[1] = __builtin_ctz(other) + 1;
    count_ = 2;
    for (std::size_t c = 0; c < 8; ++c) {
      const bool of_first = entry_shape(entry_[c]) == first;
      own_[0][c] = of_first ? entry_share(entry_[c]) : entry_rest(entry_[c]);
      own_[1][c] = of_first ? entry_rest(entry_[c]) : entry_share(entry_[c]);
    }
    return;
  }
  std::uint64_t seen = 1;
  const auto add = [&](int number) {
    if (seen >> number & 1) return;
    seen |= std::uint64_t{1} << number;
    if (count_ < max_shapes) number_[std::size_t(count_++)] = number;
  };
  std::array<int, 8> second{};  // the shape to which the rest belongs
  for (std::size_t c = 0; c < 8; ++c) {
    add(entry_shape(entry_[c]));
    if (entry_rest(entry_[c]) == 0) continue;
    second[c] = felt.blocks.second_of(entry_shape(entry_[c]), i + int(c & 1), j + int(c >> 1 & 1), k + int(c >> 2));
    add(second[c]);
  }
  touched_ = (std::uint32_t(seen >> 1) & touch) != 0;
  if (count_ < 2 || !touched_) return;
  for (int n = 0; n < count_; ++n) {
    const int number = number_[std::size_t(n)];
    for (std::size_t c = 0; c < 8; ++c)
      own_[std::size_t(n)][c] = entry_shape(entry_[c]) == number ? entry_share(entry_[c])
                                : second[c] == number            ? entry_rest(entry_[c])
                                                                 : 0;
  }
}

void ContactCell::find_windows(const FeltLattice& felt) {
  for (const std::uint32_t e : entry_) {
    const int number = entry_shape(e);
    if (number == 0) continue;
    bool known = false;
    for (int n = 0; n < count_; ++n) known = known || number_[std::size_t(n)] == number;
    if (!known) number_[std::size_t(count_++)] = number;
  }
  std::sort(number_.begin(), number_.begin() + count_);
  // Where three windows meet, none may have half of a point: there the boxes decide.
  boxes_ = boxes_ || count_ > 2;
  for (int n = 0; n < count_; ++n) {
    const int number = number_[std::size_t(n)], low = felt.table.low_of(number), high = felt.table.high_of(number);
    int above = 0;
    for (int m = 0; m < count_ && count_ == 2; ++m)
      if (felt.table.low_of(number_[std::size_t(m)]) > high) above = number_[std::size_t(m)];
    const double top = felt.table.top_of(number, above);
    for (std::size_t c = 0; c < 8; ++c) {
      const double hu = raw_[c];
      own_[std::size_t(n)][c] = hu <= high ? hu - low : 0;
      top_[std::size_t(n)][c] = hu < low ? 0 : hu <= high ? top - hu : std::min(top - hu, -0.5);
    }
  }
}

int ContactCell::shape_at(Vec3 p) const {
  if (uniform_) return shape_;
  if (boxes_) {
    const std::uint32_t e = entry_[std::size_t(nearest_corner(p))];
    if (entry_shape(e) != 0 && entry_filled(e) > half_full) return entry_shape(e);
  }
  if (hu_) {
    for (int n = 0; n < count_; ++n)
      if (interpolate(own_[std::size_t(n)], p) >= 0 && interpolate(top_[std::size_t(n)], p) >= 0)
        return number_[std::size_t(n)];
    return 0;
  }
  if (interpolate(filled_, p) < 0) return 0;
  int best = 0;
  double most = -1;
  for (int n = 0; n < count_ && count_ > 1; ++n) {
    const double f = interpolate(own_[std::size_t(n)], p);
    if (f > most || (f == most && number_[std::size_t(n)] < number_[std::size_t(best)])) most = f, best = n;
  }
  return number_[std::size_t(best)];
}

Vec3 ContactCell::gradient(Vec3 p, int from, int into) const {
  if (uniform_ || boxes_) return {};
  const auto index_of = [&](int number) {
    for (int n = 0; n < count_; ++n)
      if (number_[std::size_t(n)] == number) return n;
    return -1;
  };
  const int b = index_of(into), a = index_of(from);
  Corners f = filled_;
  if (hu_) {
    if (a < 0 && b < 0) return {};
    f = own_[std::size_t(b < 0 ? a : b)];
    // At the upper end of the window the other function changes its sign.
    const Corners& o = top_[std::size_t(b < 0 ? a : b)];
    if (std::abs(interpolate(o, p)) < std::abs(interpolate(f, p)) * 1e-3) f = o;
    if (b < 0)
      for (double& v : f) v = -v;
  } else if (from != 0 && into != 0) {
    if (a < 0 || b < 0) return {};
    for (std::size_t c = 0; c < 8; ++c) f[c] = own_[std::size_t(b)][c] - own_[std::size_t(a)][c];
  } else if (into == 0) {
    for (double& v : f) v = -v;
  }
  const auto at = [&](double x, double y, double z) { return interpolate(f, {x, y, z}); };
  return {at(1, p.y, p.z) - at(0, p.y, p.z), at(p.x, 1, p.z) - at(p.x, 0, p.z), at(p.x, p.y, 1) - at(p.x, p.y, 0)};
}

int ContactCell::shape_along(Vec3 p, Vec3 q) const {
  if (hu_ || boxes_ || count_ > 2 || (count_ == 2 && !solid_)) return -1;
  Corners difference;
  for (std::size_t c = 0; c < 8 && count_ == 2; ++c) difference[c] = own_[1][c] - own_[0][c];
  const std::array<double, 4> b = along(count_ == 2 ? difference : filled_, p, q);
  constexpr double clear = 1e-6;  // far beyond rounding
  if (b[0] > clear && b[1] > clear && b[2] > clear && b[3] > clear) return number_[std::size_t(count_ - 1)];
  if (b[0] < -clear && b[1] < -clear && b[2] < -clear && b[3] < -clear) return count_ == 2 ? number_[0] : 0;
  return -1;
}

int ContactCell::breaks(Vec3 p, Vec3 q, double* out) const {
  int count = 0;
  // Where all corners have one sign, so has every point between them.
  const auto add = [&](const Corners& c) {
    int below = 0;
    for (const double v : c) below += v < 0;
    if (below != 0 && below != 8) find_roots(along(c, p, q), 0, 1, 40, out, count);
  };
  if (uniform_) return 0;
  if (hu_) {
    for (std::size_t n = 0; n < std::size_t(count_); ++n) {
      add(own_[n]);
      add(top_[n]);
    }
  } else {
    add(filled_);
    for (std::size_t n = 0; n < std::size_t(count_) && count_ > 1; ++n)
      for (std::size_t m = 0; m < n; ++m) {
        Corners difference;
        for (std::size_t c = 0; c < 8; ++c) difference[c] = own_[n][c] - own_[m][c];
        add(difference);
      }
  }
  if (boxes_)
    for (int a = 0; a < 3; ++a)
      if ((p[a] < 0.5) != (q[a] < 0.5)) out[count++] = std::clamp((0.5 - p[a]) / (q[a] - p[a]), 0.0, 1.0);
  std::sort(out, out + count);
  return count;
}

}  // namespace trephine::contact
