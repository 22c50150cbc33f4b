// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_normal.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "contact/contact_cell.h"
#include "contact/crossing.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {

namespace {

// The gradient, in a voxel's own units, of the linear function that fits the 4 x 4 x 4 values best. A voxel counts by
// its nearness to the point (1 2 1 along each axis, interpolated to it, so that the result is continuous) and by how
// far it is from empty and from full. At those two values the ramp ends, and a difference taken across its end leans
// towards the axes, by up to 3 degrees on a plane. Where all voxels are empty or full, as in a mask, they count alike.
//
// Normals are half of what a tick costs, so four columns of one y and z are summed at a time, and then two sums: by the
// same operations in the same order as one by one.
using Four = float __attribute__((vector_size(16)));
using Two = double __attribute__((vector_size(16)));

Vec3 fitted_gradient(const float (*v)[16], Vec3 f, double full) {
  float near[3][4];
  for (int a = 0; a < 3; ++a) {
    const float t = float(f[a]), u = 1 - t;
    const float w[4] = {0.25f * u, 0.5f * u + 0.25f * t, 0.25f * u + 0.5f * t, 0.25f * t};
    std::copy(w, w + 4, near[a]);
  }
  const Four near_y{near[1][0], near[1][1], near[1][2], near[1][3]};
  const float scale = float(1 / full);
  // By z and x, along y. `part`: of each column that lies on a ramp.
  Four filled[4][4], weight[4][4];
  float on_ramp = 0;
  for (int z = 0; z < 4; ++z) {
    const Four across = near[2][z] * near_y;
    Four part{};
    for (int x = 0; x < 4; ++x) {
      Four o;
      std::memcpy(&o, v[x] + 4 * z, sizeof o);
      o *= scale;
      const Four w = near[0][x] * across;
      filled[z][x] = o;
      weight[z][x] = w;
      part += w * 4.f * o * (1.f - o);
    }
    for (int y = 0; y < 4; ++y) on_ramp += part[y];
  }
  // What a voxel that is empty or full counts: little where enough others lie on a ramp.
  const float least = 0.02f + 2 * std::max(0.0f, 1 - on_ramp / 0.6f);
  // Sums of the weights w, and of the weights times value, s; all coordinates are counted from the middle.
  Two m_x{}, y_xy{}, z_xz{}, o_ox{}, oy_oz{}, yy_zz{}, yz_xx{};
  for (int z = 0; z < 4; ++z) {
    Four w0{}, w1{}, w2{}, s0{}, s1{};
    for (int x = 0; x < 4; ++x) {
      const float at = float(x) - 1.5f;
      const Four o = filled[z][x], w = weight[z][x] * (least + 4.f * o * (1.f - o));
      w0 += w;
      w1 += w * at;
      w2 += w * at * at;
      s0 += w * o;
      s1 += w * o * at;
    }
    const double bz = z - 1.5;
    for (int y = 0; y < 4; ++y) {
      const double by = y - 1.5, w = double(w0[y]), s = double(s0[y]);
      const Two w_wx{w, double(w1[y])}, beside{by, bz};
      m_x += w_wx;
      y_xy += w_wx * by;
      z_xz += w_wx * bz;
      o_ox += Two{s, double(s1[y])};
      oy_oz += s * beside;
      yy_zz += w * beside * beside;
      yz_xx += Two{w * by * bz, double(w2[y])};
    }
  }
  const double m = m_x[0];
  if (!(m > 0)) return {};
  const double x = m_x[1] / m, y = y_xy[0] / m, z = z_xz[0] / m, o = o_ox[0] / m;
  const double xx = yz_xx[1] / m - x * x, yy = yy_zz[0] / m - y * y, zz = yy_zz[1] / m - z * z;
  const double xy = y_xy[1] / m - x * y, xz = z_xz[1] / m - x * z, yz = yz_xx[0] / m - y * z;
  const Vec3 b{o_ox[1] / m - o * x, oy_oz[0] / m - o * y, oy_oz[1] / m - o * z};
  // All 64 voxels count, so the matrix is positive definite. Cramer's rule without its determinant, which is positive.
  return {b.x * (yy * zz - yz * yz) + b.y * (xz * yz - xy * zz) + b.z * (xy * yz - xz * yy),
          b.x * (xz * yz - xy * zz) + b.y * (xx * zz - xz * xz) + b.z * (xy * xz - xx * yz),
          b.x * (xy * yz - xz * yy) + b.y * (xy * xz - xx * yz) + b.z * (xx * yy - xy * xy)};
}

// What each of the 4 x 4 x 4 voxels from `begin` on holds of `into` (or of `from`, where `into` is 0); x is the first
// index. False where they are not all in the lattice, and for the encoding `hu`.
bool shares_around(const FeltLattice& felt, const int* begin, int from, int into, float (*v)[16]) {
  const grid::Grid<std::int16_t>& voxels = felt.volume.voxels;
  for (int a = 0; a < 3; ++a)
    if (begin[a] < 0 || begin[a] + 4 > voxels.size[std::size_t(a)]) return false;
  if (felt.volume.encoding == voxel::HapticEncoding::hu) return false;
  const std::size_t row_step = std::size_t(voxels.size[0]), slice_step = row_step * std::size_t(voxels.size[1]);
  const std::int16_t* const first = voxels.voxels.data() + voxels.index(begin[0], begin[1], begin[2]);
  std::uint32_t e[4][16];
  for (std::size_t z = 0; z < 4; ++z)
    for (std::size_t y = 0; y < 4; ++y) {
      const std::int16_t* row = first + z * slice_step + y * row_step;
      for (std::size_t x = 0; x < 4; ++x) e[x][4 * z + y] = felt.table.of(voxel::detail::load_voxel(row[x]));
    }
  if (from == 0 || into == 0) {  // no question of whose
    for (int x = 0; x < 4; ++x)
      for (int n = 0; n < 16; ++n) v[x][n] = float(entry_filled(e[x][n]));
    return true;
  }
  // What another shape's voxel leaves: this one's, where there are no others.
  std::uint32_t near = 0;
  for (int n = 0; n < 8; ++n)
    near |= felt.blocks.near_block(begin[0] + 3 * (n & 1), begin[1] + 3 * (n >> 1 & 1), begin[2] + 3 * (n >> 2));
  const std::uint32_t others = near & ~(std::uint32_t{1} << (into - 1));
  const bool two = (others & (others - 1)) == 0;
  const int ours = two && others != near ? ~0 : 0;
  for (int x = 0; x < 4; ++x)
    for (int n = 0; n < 16; ++n) {
      const int is_into = -int(entry_shape(e[x][n]) == into);
      v[x][n] = float((entry_share(e[x][n]) & is_into) | (entry_rest(e[x][n]) & ours & ~is_into));
    }
  if (two || others == near) return true;
  for (int x = 0; x < 4; ++x)
    for (int n = 0; n < 16; ++n) {
      const int own = entry_shape(e[x][n]), rest = entry_rest(e[x][n]);
      if (rest != 0 && own != into &&
          felt.blocks.second_of(own, begin[0] + x, begin[1] + (n & 3), begin[2] + (n >> 2)) == into)
        v[x][n] = float(rest);
    }
  return true;
}

// The same voxel by voxel, whatever there is; of HU, by the low end of the upper of two windows.
double share_around(const FeltLattice& felt, int i, int j, int k, int from, int into) {
  const int number = into != 0 ? into : from;
  const bool hu = felt.volume.encoding == voxel::HapticEncoding::hu, inside = felt.volume.voxels.contains(i, j, k);
  const int raw = inside ? voxel::detail::load_voxel(felt.volume.voxels.at(i, j, k))
                  : hu   ? voxel::haptic_beyond_hu
                         : voxel::haptic_empty;
  const std::uint32_t e = felt.table.of(std::int16_t(raw));
  if (!hu) {
    if (from == 0 || into == 0) return entry_filled(e);
    if (entry_shape(e) == number) return entry_share(e);
    return entry_rest(e) != 0 && felt.blocks.second_of(entry_shape(e), i, j, k) == number ? entry_rest(e) : 0;
  }
  if (from == 0 || into == 0) {
    if (e != 0 && e != contact_gap && entry_shape(e) != number) return 1;
    if (raw > felt.table.high_of(number)) return 0;
  }
  const bool of_lower = from != 0 && into != 0 && felt.table.low_of(from) > felt.table.low_of(into);
  const int low = felt.table.low_of(of_lower ? from : number);
  const double half = std::max(1, low + 1000);
  const double share = std::clamp(0.5 + (raw - low) / (2 * half), 0.0, 1.0);
  return of_lower ? 1 - share : share;
}

}  // namespace

Vec3 fitted_normal(const FeltLattice& felt, Vec3 world_mm, int from, int into) {
  if (!detail::usable(world_mm) || from == into) return {};
  const grid::Lattice& l = felt.volume.voxels;
  const Vec3 index = felt.to_index(world_mm);
  int begin[3];
  Vec3 f;
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -1 && index[a] <= l.size[std::size_t(a)])) return {};
    const int cell = int(std::floor(index[a]));
    f[a] = index[a] - cell;
    begin[a] = cell - 1;
  }
  float v[4][16];
  if (!shares_around(felt, begin, from, into, v))
    for (int n = 0; n < 16; ++n)
      for (int x = 0; x < 4; ++x)
        v[x][n] = float(share_around(felt, begin[0] + x, begin[1] + (n & 3), begin[2] + (n >> 2), from, into));
  Vec3 g = fitted_gradient(v, f, felt.volume.encoding == voxel::HapticEncoding::hu ? 1 : voxel::haptic_full);
  g = l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z};
  const double length = norm(g);
  if (!(length > 1e-9)) return {};
  return g / (into != 0 ? -length : length);
}

Vec3 exact_normal(const FeltLattice& felt, const Contact& contact, Vec3 way) {
  if (!contact.hit || felt.boxes()) return {};
  const grid::Lattice& l = felt.volume.voxels;
  const Vec3 index = felt.to_index(contact.point_mm), ahead = index + normalized(felt.index_of_world * way) * 1e-7;
  const int i = int(std::floor(ahead.x)), j = int(std::floor(ahead.y)), k = int(std::floor(ahead.z));
  const Vec3 g = ContactCell(felt, i, j, k).gradient(detail::within_cell(index, i, j, k), contact.from, contact.into);
  return -normalized(l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z});
}

Vec3 normal_of(const FeltLattice& felt, const Contact& c, Vec3 way) {
  const Vec3 forward = normalized(way);
  Vec3 n = fitted_normal(felt, c.point_mm, c.from, c.into);
  // The fit is smoother than the surface. Where its normal points along the way, it is turned to lie across the way.
  const double ahead = dot(n, forward);
  if (n == Vec3{} || ahead > 0.999)
    n = -forward;
  else if (ahead > -1e-3)
    n = normalized(n - forward * (ahead + 1e-3));
  return n;
}

}  // namespace trephine::contact
