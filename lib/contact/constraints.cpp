// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/constraints.h"

#include <cmath>

namespace trephine::contact {
namespace {

constexpr double tolerance_mm = 1e-9;

// How far behind plane i the target lies.
double behind(const Plane& p, Vec3 x) { return dot(p.normal, p.point_mm - x); }

// Solves for the pressures of the planes whose bits are set; false where the planes do not determine the pressures.
bool pressures(const Plane* planes, int count, int set, Vec3 target, double* out) {
  int index[3], n = 0;
  for (int i = 0; i < count; ++i) {
    out[i] = 0;
    if (set >> i & 1) index[n++] = i;
  }
  double a[3][4];
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) a[r][c] = dot(planes[index[r]].normal, planes[index[c]].normal);
    a[r][n] = behind(planes[index[r]], target);
  }
  // The matrix is positive definite unless the normals are linearly dependent.
  for (int c = 0; c < n; ++c) {
    if (!(a[c][c] > 1e-4)) return false;
    for (int r = c + 1; r < n; ++r) {
      const double f = a[r][c] / a[c][c];
      for (int k = c; k <= n; ++k) a[r][k] -= f * a[c][k];
    }
  }
  for (int r = n - 1; r >= 0; --r) {
    double sum = a[r][n];
    for (int c = r + 1; c < n; ++c) sum -= a[r][c] * out[index[c]];
    out[index[r]] = sum / a[r][r];
  }
  return true;
}

}  // namespace

bool nearest_before(const Plane* planes, int count, Vec3 target, Nearest& out) {
  // Sets of few planes first. The first set that only pushes outwards and satisfies the others gives the nearest point.
  static constexpr int order[8] = {0, 1, 2, 4, 3, 5, 6, 7};
  for (const int set : order) {
    if (set >> count) continue;
    double pressure[3] = {0, 0, 0};
    if (!pressures(planes, count, set, target, pressure)) continue;
    Vec3 x = target;
    bool good = true;
    for (int i = 0; i < count; ++i) {
      good = good && pressure[i] >= 0;
      x += planes[i].normal * pressure[i];
    }
    for (int i = 0; i < count && good; ++i) good = behind(planes[i], x) <= tolerance_mm;
    if (!good) continue;
    out.point_mm = x;
    for (int i = 0; i < 3; ++i) out.pressure_mm[i] = i < count ? pressure[i] : 0;
    return true;
  }
  return false;
}

}  // namespace trephine::contact
