// SPDX-License-Identifier: GPL-3.0-or-later
// Normals of what a ContactVolume holds.
#include <algorithm>
#include <cmath>

#include "contact/contact.h"
#include "contact/contact_cell.h"
#include "contact/contact_way.h"
#include "voxel/raw_voxel.h"

namespace trephine {

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
  const Vec3 g = ContactCell(*this, i, j, k).gradient(detail::within_cell(index, i, j, k), contact.from, contact.into);
  return -normalized(l.direction * Vec3{g.x / l.spacing_mm.x, g.y / l.spacing_mm.y, g.z / l.spacing_mm.z});
}

}  // namespace trephine
