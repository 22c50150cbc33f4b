// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/cutter.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "base/text.h"
#include "boolean/cutter_shape.h"
#include "meshing/validity.h"
#include "surface/bounds.h"

namespace trephine::boolean {
namespace {

constexpr double least_mm = 1e-3, most_mm = 1e4, furthest_mm = 1e6;

[[noreturn]] void refuse(ExitCode code, const std::string& field, const std::string& what) {
  throw Error(code, "", field, what);
}

void check_length(ExitCode code, const char* field, double v, bool may_be_zero = false) {
  if (may_be_zero && v == 0) return;
  if (!(v >= least_mm && v <= most_mm))
    refuse(code, field,
           to_text(v) + " mm, must be " + (may_be_zero ? "0, or " : "") + to_text(least_mm) + " to " +
               to_text(most_mm) + " mm");
}

void check_unit(ExitCode code, const char* field, Vec3 v) {
  if (!is_finite(v) || std::abs(norm(v) - 1) > 1e-6)
    refuse(code, field, "must be of length 1, is of " + to_text(norm(v)));
}

void check_axis(const Cutter& c, ExitCode code) {
  check_unit(code, "direction", c.direction);
  check_length(code, "radius_mm", c.radius_mm);
  check_length(code, "above_mm", c.above_mm, true);
  check_length(code, "depth_mm", c.depth_mm);
  if (c.kind != Cutter::Kind::cone) return;
  check_length(code, "end_radius_mm", c.end_radius_mm, true);
  const double top = start_radius_mm(c);
  if (!(top >= least_mm && top <= most_mm))
    refuse(code, "above_mm",
           "the cone's radius there is " + to_text(top) + " mm, must be " + to_text(least_mm) + " to " +
               to_text(most_mm) + " mm");
}

void check_mesh_cutter(const Cutter& c, ExitCode code) {
  if (!c.mesh) refuse(code, "mesh", "none is given");
  try {
    meshing::require_valid(*c.mesh);
  } catch (const Error& e) {
    if (e.code() == ExitCode::internal) throw;
    refuse(code, "mesh", (e.field().empty() ? "" : e.field() + ": ") + e.what());
  }
}

void add(surface::Bounds& b, Vec3 centre, Vec3 half) { surface::include(b, {centre - half, centre + half}); }

/// Half the extent of a disc along each axis.
Vec3 disc(Vec3 normal, double radius) {
  Vec3 h;
  for (int a = 0; a < 3; ++a) h[a] = radius * std::sqrt(std::max(0.0, 1 - normal[a] * normal[a]));
  return h;
}

}  // namespace

double start_radius_mm(const Cutter& c) {
  if (c.kind != Cutter::Kind::cone) return c.radius_mm;
  return c.radius_mm - (c.end_radius_mm - c.radius_mm) * (c.above_mm / c.depth_mm);
}

double far_radius_mm(const Cutter& c) { return c.kind == Cutter::Kind::cone ? c.end_radius_mm : c.radius_mm; }

Mat3 frame_of(const Cutter& c) {
  const Vec3 w = normalized(c.direction);
  Vec3 u = c.across - w * dot(c.across, w);
  if (c.kind != Cutter::Kind::ellipsoid) {
    int least = 0;
    for (int a = 1; a < 3; ++a)
      if (std::abs(w[a]) < std::abs(w[least])) least = a;
    Vec3 e;
    e[least] = 1;
    u = e - w * dot(e, w);
  }
  u = normalized(u);
  return {{u, cross(w, u), w}};
}

std::array<double, 3> semi_axes_mm(const Cutter& c) {
  if (c.kind == Cutter::Kind::sphere) return {c.radius_mm, c.radius_mm, c.radius_mm};
  return c.radii_mm;
}

void check_cutter(const Cutter& c, ExitCode code) {
  if (c.kind == Cutter::Kind::mesh) return check_mesh_cutter(c, code);
  if (!is_finite(c.position_mm) || norm(c.position_mm) > furthest_mm)
    refuse(code, "position_mm", "must be finite and within " + to_text(furthest_mm) + " mm");
  switch (c.kind) {
    case Cutter::Kind::sphere:
      return check_length(code, "radius_mm", c.radius_mm);
    case Cutter::Kind::ellipsoid:
      check_unit(code, "direction", c.direction);
      check_unit(code, "across", c.across);
      if (std::abs(dot(c.direction, c.across)) > 1e-6) refuse(code, "across", "must be perpendicular to direction");
      for (const double r : c.radii_mm) check_length(code, "radii_mm", r);
      return;
    default:
      return check_axis(c, code);
  }
}

surface::Bounds bounds_of(const Cutter& c) {
  surface::Bounds b;
  switch (c.kind) {
    case Cutter::Kind::mesh:
      return surface::bounds_of(*c.mesh);
    case Cutter::Kind::sphere:
    case Cutter::Kind::ellipsoid: {
      const Mat3 f = frame_of(c);
      const auto r = semi_axes_mm(c);
      Vec3 half;
      for (int a = 0; a < 3; ++a)
        half[a] = std::sqrt(std::pow(f.column[0][a] * r[0], 2) + std::pow(f.column[1][a] * r[1], 2) +
                            std::pow(f.column[2][a] * r[2], 2));
      if (c.kind == Cutter::Kind::sphere) half = {r[0], r[0], r[0]};
      add(b, c.position_mm, half);
      return b;
    }
    default: {
      const Vec3 w = normalized(c.direction);
      add(b, c.position_mm - w * c.above_mm, disc(w, start_radius_mm(c)));
      add(b, c.position_mm + w * c.depth_mm, disc(w, far_radius_mm(c)));
      return b;
    }
  }
}

double volume_mm3(const Cutter& c) {
  switch (c.kind) {
    case Cutter::Kind::mesh:
      return surface::volume_mm3(*c.mesh);
    case Cutter::Kind::sphere:
    case Cutter::Kind::ellipsoid: {
      const auto r = semi_axes_mm(c);
      return 4 * pi / 3 * r[0] * r[1] * r[2];
    }
    default: {
      const double a = start_radius_mm(c), b = far_radius_mm(c);
      return pi / 3 * (c.above_mm + c.depth_mm) * (a * a + a * b + b * b);
    }
  }
}

}  // namespace trephine::boolean
