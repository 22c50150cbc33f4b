// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "grid/nifti.h"
#include "grid/nifti_place.h"
#include "grid/nrrd_header.h"

namespace trephine::grid {
namespace {

constexpr std::size_t header_bytes = 348, data_at = 352;
constexpr double max_rounding_mm = 0.005;  ///< beyond it the qform is left out, and the sform alone holds

template <class T>
void put(std::string& header, std::size_t at, T value) {
  std::memcpy(header.data() + at, &value, sizeof value);
}

template <class T>
struct Datatype;
template <>
struct Datatype<std::uint8_t> {
  static constexpr std::int16_t code = 2;
};
template <>
struct Datatype<std::int16_t> {
  static constexpr std::int16_t code = 4;
};
template <>
struct Datatype<float> {
  static constexpr std::int16_t code = 16;
};

/// The rotation's quaternion (a, b, c, d) with a >= 0 [the standard's nifti1.h], by the largest of its four parts.
std::array<double, 4> quaternion_of(const std::array<Vec3, 3>& c) {
  const double xx = c[0].x, yy = c[1].y, zz = c[2].z;
  const double four[4] = {1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz};
  int most = 0;
  for (int i = 1; i < 4; ++i)
    if (four[i] > four[most]) most = i;
  const double p = std::sqrt(four[most]) / 2, q = 0.25 / p;
  const double a = (c[1].z - c[2].y) * q, b = (c[2].x - c[0].z) * q, d = (c[0].y - c[1].x) * q;
  const double xy = (c[1].x + c[0].y) * q, xz = (c[2].x + c[0].z) * q, yz = (c[2].y + c[1].z) * q;
  std::array<double, 4> r{};
  if (most == 0) r = {p, a, b, d};
  if (most == 1) r = {a, p, xy, xz};
  if (most == 2) r = {b, xy, p, yz};
  if (most == 3) r = {d, xz, yz, p};
  if (r[0] < 0)
    for (double& v : r) v = -v;
  return r;
}

/// How far a corner of the volume moves where the rotation comes from b, c and d as the file holds them. The file does
/// not hold a: near a half turn it is the root of a small difference.
double rounding_mm(const std::array<Vec3, 3>& unit, const std::array<double, 3>& q, const Lattice& l) {
  const double b = q[0], c = q[1], d = q[2], a = std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d));
  const Vec3 columns[3] = {{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)},
                           {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)},
                           {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b}};
  double off = 0;
  for (int i = 0; i < 3; ++i)
    off += norm(columns[i] - unit[std::size_t(i)]) * l.spacing_mm[i] * (l.size[std::size_t(i)] - 1);
  return off;
}

void put_frame(std::string& header, const Lattice& l) {
  std::array<Vec3, 3> unit;  // the axes in RAS
  for (int a = 0; a < 3; ++a) {
    const Vec3 c = l.direction.column[std::size_t(a)];
    unit[std::size_t(a)] = {0 - c.x, 0 - c.y, c.z};
  }
  const Vec3 origin{0 - l.origin_mm.x, 0 - l.origin_mm.y, l.origin_mm.z};
  put(header, 280, detail::sform_of(l));
  for (int row = 0; row < 3; ++row) put(header, 268 + 4 * std::size_t(row), float(origin[row]));
  const bool mirrored = dot(cross(unit[0], unit[1]), unit[2]) < 0;
  if (mirrored) unit[2] = -unit[2];
  const auto q = quaternion_of(unit);
  std::array<double, 3> rounded{};
  for (std::size_t i = 0; i < 3; ++i) {
    put(header, 256 + 4 * i, float(q[i + 1]));
    rounded[i] = float(q[i + 1]);
  }
  put(header, 76, mirrored ? -1.f : 1.f);
  for (int a = 0; a < 3; ++a) put(header, 80 + 4 * std::size_t(a), float(l.spacing_mm[a]));
  put(header, 252, std::int16_t{rounding_mm(unit, rounded, l) <= max_rounding_mm});
  put(header, 254, std::int16_t{1});
}

/// Whether the place that single precision holds is read as the lattice's, to the last bit: of a volume of one voxel.
bool says_the_place(std::string bytes, const Lattice& l) {
  for (std::size_t a = 0; a < 3; ++a) put(bytes, 42 + 2 * a, std::int16_t{1});
  put(bytes, 70, Datatype<std::uint8_t>::code);
  put(bytes, 72, std::int16_t{8});
  put(bytes, 108, float(data_at));
  bytes += '\0';
  const Nifti one = decode_nifti(bytes);
  const Lattice& read = std::get<Mask>(one.grid);
  return read.spacing_mm == l.spacing_mm && read.origin_mm == l.origin_mm && read.direction == l.direction;
}

template <class T>
std::string encoded(const Grid<T>& grid, bool gzip) {
  std::string bytes(data_at, '\0');
  put(bytes, 0, std::int32_t(header_bytes));
  put(bytes, 40, std::int16_t{3});
  for (std::size_t a = 0; a < 3; ++a) {
    if (grid.size[a] < 1 || grid.size[a] > 32767)
      throw Error(ExitCode::bad_input, "", "dim",
                  std::to_string(grid.size[a]) + " voxels along one axis, NIfTI-1 has at most 32767");
    put(bytes, 42 + 2 * a, std::int16_t(grid.size[a]));
  }
  for (std::size_t a = 3; a < 7; ++a) put(bytes, 42 + 2 * a, std::int16_t{1});
  put(bytes, 70, Datatype<T>::code);
  put(bytes, 72, std::int16_t(8 * sizeof(T)));
  put(bytes, 112, 1.f);
  bytes[123] = 2;  // mm
  put_frame(bytes, grid);
  std::memcpy(bytes.data() + 344, "n+1", 4);
  if (!says_the_place(bytes, grid)) bytes.replace(header_bytes, 4, detail::place_extension(grid));
  put(bytes, 108, float(bytes.size()));
  bytes.append(reinterpret_cast<const char*>(grid.voxels.data()), grid.voxels.size() * sizeof(T));
  return gzip ? detail::gzip_compress(bytes) : bytes;
}

}  // namespace

std::string encode_nifti(const HuVolume& volume, bool gzip) {
  return std::visit([&](const auto& grid) { return encoded(grid, gzip); }, volume);
}
std::string encode_nifti(const Mask& mask, bool gzip) { return encoded(mask, gzip); }

}  // namespace trephine::grid
