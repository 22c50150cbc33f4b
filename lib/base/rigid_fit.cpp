// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rigid_fit.h"

#include <algorithm>
#include <cmath>

#include "base/symmetric_eigen.h"

namespace trephine {
namespace {

constexpr double unknown_mm = 1e3;

Vec3 mean_of(const std::vector<Vec3>& points) {
  Vec3 sum;
  for (const Vec3 p : points) sum += p;
  return sum / double(points.size());
}

Mat3 rotation_of(const std::array<double, 4>& q) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  Mat3 m;
  m.column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  m.column[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  m.column[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  return m;
}

}  // namespace

RigidMap then(const RigidMap& first, const RigidMap& second) {
  RigidMap out;
  for (std::size_t k = 0; k < 3; ++k) out.turn.column[k] = second.turn * first.turn.column[k];
  out.offset_mm = second(first.offset_mm);
  return out;
}

RigidMap inverse(const RigidMap& map) {
  RigidMap out;
  for (int k = 0; k < 3; ++k)
    out.turn.column[std::size_t(k)] = {map.turn.column[0][k], map.turn.column[1][k], map.turn.column[2][k]};
  out.offset_mm = -(out.turn * map.offset_mm);
  return out;
}

std::array<double, 12> rows_of(const RigidMap& map) {
  std::array<double, 12> rows{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) rows[4 * a + k] = map.turn.column[k][int(a)];
    rows[4 * a + 3] = map.offset_mm[int(a)];
  }
  return rows;
}

RigidMap map_of(const std::array<double, 12>& rows) {
  RigidMap map;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) map.turn.column[k][int(a)] = rows[4 * a + k];
    map.offset_mm[int(a)] = rows[4 * a + 3];
  }
  return map;
}

bool is_rotation(const Mat3& m, double off) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = i; k < 3; ++k)
      if (!(std::abs(dot(m.column[i], m.column[k]) - (i == k ? 1 : 0)) <= off)) return false;
  return determinant(m) > 0;
}

RigidFit fit_rigid(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Vec3 a = mean_of(from), b = mean_of(to);
  double s[3][3] = {};
  for (std::size_t n = 0; n < from.size(); ++n) {
    const Vec3 p = from[n] - a, q = to[n] - b;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) s[i][j] += p[i] * q[j];
  }
  const SquareMatrix<4> m{{{s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
                           {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
                           {s[2][0] - s[0][2], s[0][1] + s[1][0], -s[0][0] + s[1][1] - s[2][2], s[1][2] + s[2][1]},
                           {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], -s[0][0] - s[1][1] + s[2][2]}}};
  RigidFit fit;
  fit.map.turn = rotation_of(symmetric_eigen<4>(m)[3].vector);
  fit.map.offset_mm = b - fit.map.turn * a;
  double squares = 0;
  for (std::size_t n = 0; n < from.size(); ++n) {
    const Vec3 off = fit.map(from[n]) - to[n];
    squares += dot(off, off);
  }
  fit.rms_mm = std::sqrt(squares / double(from.size()));
  return fit;
}

double target_error_mm(const std::vector<Vec3>& points, double rms_mm, Vec3 at) {
  const double n = double(points.size());
  if (points.size() < 3) return unknown_mm;
  const Vec3 middle = mean_of(points);
  SquareMatrix<3> spread{};
  for (const Vec3 p : points)
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) spread[std::size_t(i)][std::size_t(k)] += (p - middle)[i] * (p - middle)[k];
  const auto axes = symmetric_eigen<3>(spread);
  const Vec3 to = at - middle;
  const double all = axes[0].value + axes[1].value + axes[2].value;
  double sum = 0;
  for (const EigenPair<3>& axis : axes) {
    const double along = dot(to, {axis.vector[0], axis.vector[1], axis.vector[2]});
    const double marks_off = (all - axis.value) / n;
    if (!(marks_off > 1e-6)) return unknown_mm;
    sum += std::max(0.0, dot(to, to) - along * along) / marks_off;
  }
  const double localised = rms_mm * rms_mm * n / (n - 2);
  return std::sqrt(localised / n * (1 + sum / 3));
}

}  // namespace trephine
