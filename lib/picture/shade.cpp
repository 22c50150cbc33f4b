// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/shade.h"

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace trephine::picture::detail {
namespace {

struct Direction {
  Direction(double x, double y, double z) : Direction(normalized(Vec3{x, y, z})) {}
  explicit Direction(Vec3 d) : x(float(d.x)), y(float(d.y)), z(float(d.z)) {}
  float x, y, z;
};

float at_least_0(float v) { return v > 0 ? v : 0; }

// By what a vector is multiplied to be of unit length; a zero vector stays zero.
float inverse_length(float squared) { return 1 / std::sqrt(squared > 1e-30f ? squared : 1e-30f); }

}  // namespace

void LitPoints::grow() {
  const std::size_t size = std::max<std::size_t>(256, 2 * count);
  for (int a = 0; a < 3; ++a) normal[a].resize(size), position[a].resize(size);
  diffuse.resize(size), shine.resize(size), grazing.resize(size);
}

void light(LitPoints& points, float eye_distance_mm) {
  static const Direction key(-0.45, 0.62, 0.64), fill(0.80, 0.05, 0.45), rim(0.25, 0.55, -0.80);
  const std::size_t n = points.count;
  float *nx = points.normal[0].data(), *ny = points.normal[1].data(), *nz = points.normal[2].data();
  const float *px = points.position[0].data(), *py = points.position[1].data(), *pz = points.position[2].data();
  float *diffuse = points.diffuse.data(), *shine = points.shine.data(), *grazing = points.grazing.data();
  const float near = eye_distance_mm > 0 ? 1 : 0;
  for (std::size_t i = 0; i < n; ++i) {
    const float of_normal = inverse_length(nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i]);
    const float x = nx[i] * of_normal, y = ny[i] * of_normal, z = nz[i] * of_normal;
    nx[i] = x, ny[i] = y, nz[i] = z;
    float ex = -px[i] * near, ey = -py[i] * near, ez = (eye_distance_mm - pz[i]) * near + (1 - near);
    const float of_eye = inverse_length(ex * ex + ey * ey + ez * ez);
    ex *= of_eye, ey *= of_eye, ez *= of_eye;
    diffuse[i] = 0.70f * at_least_0(x * key.x + y * key.y + z * key.z) +
                 0.30f * at_least_0(x * fill.x + y * fill.y + z * fill.z) +
                 0.12f * at_least_0(x * rim.x + y * rim.y + z * rim.z) + 0.26f + 0.08f * y;
    const float hx = key.x + ex, hy = key.y + ey, hz = key.z + ez;
    float s = at_least_0(x * hx + y * hy + z * hz) * inverse_length(hx * hx + hy * hy + hz * hz);
    s *= s, s *= s, s *= s, s *= s, s *= s;
    shine[i] = 0.10f * s;
    grazing[i] = 1 - std::abs(x * ex + y * ey + z * ez);
  }
}

}  // namespace trephine::picture::detail
