// SPDX-License-Identifier: GPL-3.0-or-later
// Normals of what a ContactVolume holds.
#include <algorithm>
#include <cmath>

#include "contact/contact.h"
#include "contact/contact_cell.h"
#include "contact/contact_way.h"
#include "voxel/raw_voxel.h"

namespace trephine {

namespace {

// The gradient, in a voxel's own units, of the linear function that fits the 4 x 4 x 4 values best. A voxel counts by
// its nearness to the point (1 2 1 along each axis, interpolated to it, so that the result is continuous) and by how
// far it is from empty and from full. At those two values the ramp ends, and a difference taken across its end leans
// towards the axes, by up to 3 degrees on a plane. Where all voxels are empty or full, as in a mask, they count alike.
Vec3 fitted_gradient(const double (*v)[16], Vec3 f, double full) {
  float near[3][4];
  for (int a = 0; a < 3; ++a) {
    const float t = float(f[a]), u = 1 - t;
    const float w[4] = {0.25f * u, 0.5f * u + 0.25f * t, 0.25f * u + 0.5f * t, 0.25f * t};
    std::copy(w, w + 4, near[a]);
  }
  float across[16];
  for (int n = 0; n < 16; ++n) across[n] = near[2][n >> 2] * near[1][n & 3];
  const float scale = float(1 / full);
  float part[16] = {};  // the share of each column that lies on a ramp
  for (int x = 0; x < 4; ++x)
    for (int n = 0; n < 16; ++n) {
      const float o = float(v[x][n]) * scale;
      part[n] += near[0][x] * across[n] * 4 * o * (1 - o);
    }
  float on_ramp = 0;
  for (const float p : part) on_ramp += p;
  // The weight of a voxel that is empty or full: small where enough others lie on a ramp.
  const float least = 0.02f + 2 * std::max(0.0f, 1 - on_ramp / 0.6f);
  // Sums of the weights, and of the weights times value, over columns of one y and z; x is counted from the middle.
  float w0[16] = {}, w1[16] = {}, w2[16] = {}, s0[16] = {}, s1[16] = {};
  for (int x = 0; x < 4; ++x) {
    const float at = float(x) - 1.5f;
    for (int n = 0; n < 16; ++n) {
      const float o = float(v[x][n]) * scale, w = near[0][x] * across[n] * (least + 4 * o * (1 - o));
      w0[n] += w;
      w1[n] += w * at;
      w2[n] += w * at * at;
      s0[n] += w * o;
      s1[n] += w * o * at;
    }
  }
  double m = 0, x = 0, y = 0, z = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0, o = 0, ox = 0, oy = 0, oz = 0;
  for (int n = 0; n < 16; ++n) {
    const double by = (n & 3) - 1.5, bz = (n >> 2) - 1.5, w = double(w0[n]), wx = double(w1[n]), s = double(s0[n]);
    m += w;
    x += wx;
    y += w * by;
    z += w * bz;
    xx += double(w2[n]);
    yy += w * by * by;
    zz += w * bz * bz;
    xy += wx * by;
    xz += wx * bz;
    yz += w * by * bz;
    o += s;
    ox += double(s1[n]);
    oy += s * by;
    oz += s * bz;
  }
  if (!(m > 0)) return {};
  for (double* sum : {&x, &y, &z, &xx, &yy, &zz, &xy, &xz, &yz, &o, &ox, &oy, &oz}) *sum /= m;
  xx -= x * x, yy -= y * y, zz -= z * z;
  xy -= x * y, xz -= x * z, yz -= y * z;
  const Vec3 b{ox - o * x, oy - o * y, oz - o * z};
  // All 64 voxels count, so the matrix is positive definite. Cramer's rule without its determinant, which is positive.
  return {b.x * (yy * zz - yz * yz) + b.y * (xz * yz - xy * zz) + b.z * (xy * yz - xz * yy),
          b.x * (xz * yz - xy * zz) + b.y * (xx * zz - xz * xz) + b.z * (xy * xz - xx * yz),
          b.x * (xy * yz - xz * yy) + b.y * (xy * xz - xx * yz) + b.z * (xx * yy - xy * xy)};
}

}  // namespace

Vec3 ContactVolume::normal_of(const Contact& c, Vec3 way) const {
  const Vec3 forward = normalized(way);
  Vec3 n = normal_at(c.point_mm, c.from, c.into);
  // The fit is smoother than the surface. Where its normal points along the way, it is turned to lie across the way.
  const double ahead = dot(n, forward);
  if (n == Vec3{} || ahead > 0.999)
    n = -forward;
  else if (ahead > -1e-3)
    n = normalized(n - forward * (ahead + 1e-3));
  return n;
}

// What each of the 4 x 4 x 4 voxels from `begin` on holds of `into` (or of `from`, where `into` is 0); x is the first
// index. False where they are not all in the lattice, and for the encoding `hu`.
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
  if (from == 0 || into == 0) {  // a surface to the air: to which shape a share belongs is no matter
    for (int x = 0; x < 4; ++x)
      for (int n = 0; n < 16; ++n) v[x][n] = entry_filled(e[x][n]);
    return true;
  }
  // The rest of another shape's voxel belongs to this shape where there is no third one.
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

// The same for one voxel, which may lie outside of the lattice; with `hu`, from the HU of air and of the shape.
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
  if (!detail::usable(world_mm) || from == into) return {};
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
  Vec3 g = fitted_gradient(v, f, volume_.encoding == HapticEncoding::hu ? 1 : haptic_full);
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
  const Vec3 g = ContactCell(*this, i, j, k).gradient(detail::within_cell(index, i, j, k), contact.from, contact.into);
  return -normalized(l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z});
}

}  // namespace trephine
