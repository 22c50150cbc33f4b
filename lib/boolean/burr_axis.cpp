// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/burr_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/rank.h"
#include "base/refusal.h"
#include "surface/ray_column.h"

namespace trephine::boolean::detail {
namespace {

constexpr double cells_mm = 3;                         ///< gaps in the bone that do not end it
constexpr double above_point_mm = 10, search_mm = 40;  ///< where along the axis the skull is looked for
constexpr double deeper_mm = 9, clearance_mm = 1, skin_clearance_mm = 2, bare_clearance_mm = 20;
constexpr double min_on_bone = 0.75, min_fit_mm = 3;

[[noreturn]] void refuse(const std::string& what, const Remedy& remedy) { throw refusal("", what, remedy); }

std::string text_of(Vec3 p) { return fmt::format("[{:.1f}, {:.1f}, {:.1f}]", p.x, p.y, p.z); }

/// The first bone behind `from`, where it begins before `to`.
std::optional<surface::detail::Span> first_bone(const surface::detail::RayColumn& skull, double u, double v,
                                                double from, double to) {
  for (const surface::detail::Span& s : skull.spans(u, v, cells_mm))
    if (s.leave > from) return s.enter <= to ? std::optional<surface::detail::Span>(s) : std::nullopt;
  return {};
}

surface::detail::Span bone_on_axis(const surface::detail::RayColumn& skull, Vec3 through_mm) {
  const auto bone = first_bone(skull, 0, 0, -above_point_mm, search_mm);
  if (!bone)
    refuse(fmt::format("the axis meets no skull within {} mm of {}", search_mm, text_of(through_mm)),
           {"choose another `position_mm` or `direction`"});
  return *bone;
}

struct Height {
  double u, v, t;
};

/// Least squares: t = a + b u + c v.
struct Plane {
  double a = 0, b = 0, c = 0;
  double beside(const Height& h) const { return std::fabs(h.t - (a + b * h.u + c * h.v)); }
};

std::optional<Plane> fit(const std::vector<Height>& heights) {
  double u = 0, v = 0, t = 0;
  for (const Height& h : heights) u += h.u, v += h.v, t += h.t;
  const double n = static_cast<double>(heights.size());
  if (n < 3) return {};
  u /= n, v /= n, t /= n;
  double uu = 0, uv = 0, vv = 0, ut = 0, vt = 0;
  for (const Height& h : heights) {
    const double du = h.u - u, dv = h.v - v, dt = h.t - t;
    uu += du * du, uv += du * dv, vv += dv * dv, ut += du * dt, vt += dv * dt;
  }
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-9 * (uu + vv) * (uu + vv))) return {};
  Plane p;
  p.b = (ut * vv - vt * uv) / det;
  p.c = (vt * uu - ut * uv) / det;
  p.a = t - p.b * u - p.c * v;
  return p;
}

/// The fit without what stands out from it.
std::optional<Plane> fit_trimmed(std::vector<Height> heights) {
  for (int round = 0; round < 4; ++round) {
    const auto plane = fit(heights);
    if (!plane) return {};
    std::vector<double> beside;
    for (const Height& h : heights) beside.push_back(plane->beside(h));
    const double limit = std::max(0.5, 3 * median_of(std::vector<double>(beside)));
    std::vector<Height> kept;
    for (std::size_t i = 0; i < heights.size(); ++i)
      if (beside[i] <= limit) kept.push_back(heights[i]);
    if (kept.size() == heights.size()) return plane;
    heights = std::move(kept);
  }
  return fit(heights);
}

}  // namespace

Vec3 perpendicular_to_skull(const surface::TriMesh& skull, Vec3 through_mm, Vec3 inwards, double radius_mm) {
  const double radius = std::max(radius_mm, min_fit_mm);
  Vec3 axis = inwards;
  for (int round = 0; round < 30; ++round) {
    const surface::detail::RayColumn column(skull, through_mm, axis, radius);
    const surface::detail::Span bone = bone_on_axis(column, through_mm);
    std::vector<Height> heights;
    for (const auto& s : surface::detail::disc_samples(300, 0)) {
      const double u = radius * s[0], v = radius * s[1];
      const auto hit = first_bone(column, u, v, bone.enter - above_point_mm - radius, bone.enter + search_mm);
      if (hit) heights.push_back({u, v, hit->enter});
    }
    const auto plane = fit_trimmed(heights);
    if (!plane)
      refuse("too little of the skull's outer surface lies about " + text_of(through_mm + axis * bone.enter),
             {"move the hole by `position_mm`, or give its `direction`"});
    const Vec3 next = normalized(axis - column.across() * plane->b - column.upwards() * plane->c);
    const double turned = norm(next - axis);
    // After that many rounds a rough surface makes it swing between two answers: their middle.
    axis = round < 15 ? next : normalized(next + axis);
    if (turned < 1e-4) break;
  }
  return axis;
}

HoleSection hole_section(const surface::TriMesh& skull, const surface::TriMesh* skin, Vec3 through_mm, Vec3 direction,
                         double radius_mm) {
  const surface::detail::RayColumn bone(skull, through_mm, direction, radius_mm * 1.01);
  const surface::detail::Span axis = bone_on_axis(bone, through_mm);
  HoleSection out;
  out.bone_enter_mm = out.bone_begin_mm = axis.enter;
  out.bone_leave_mm = axis.leave;
  double deepest = axis.leave;
  int met = 0;
  const auto samples = surface::detail::disc_samples(400, 96);
  std::vector<std::optional<surface::detail::Span>> bones;
  for (const auto& s : samples) {
    bones.push_back(first_bone(bone, radius_mm * s[0], radius_mm * s[1], axis.enter - above_point_mm - 2 * radius_mm,
                               axis.leave + deeper_mm));
    if (!bones.back()) continue;
    ++met;
    out.bone_begin_mm = std::min(out.bone_begin_mm, bones.back()->enter);
    deepest = std::max(deepest, bones.back()->leave);
  }
  out.on_bone_ratio = met / static_cast<double>(samples.size());
  if (out.on_bone_ratio < min_on_bone)
    refuse(fmt::format("only {:.0f} % of the hole at {} lie on the skull, at least {:.0f} %", 100 * out.on_bone_ratio,
                       text_of(through_mm + direction * axis.enter), 100 * min_on_bone),
           {"move it by `position_mm`, or make it smaller by `diameter_mm`"});
  if (deepest > axis.leave + deeper_mm)
    refuse(fmt::format("the bone within the hole ends {:.1f} mm deeper than on its axis, at most {} mm",
                       deepest - axis.leave, deeper_mm),
           {"make the hole smaller by `diameter_mm`, or its axis less oblique by `direction` or `toward`"});
  out.end_mm = deepest + clearance_mm;
  out.begin_mm = out.bone_begin_mm - bare_clearance_mm;
  out.skin_enter_mm = axis.enter;
  if (!skin) return out;

  // The soft tissue that covers the bone: not what lies beyond air above it (the ear's shell, a tube).
  const surface::detail::RayColumn cover(*skin, through_mm, direction, radius_mm * 1.01);
  const auto skin_above = [&](double u, double v, double bone_at) {
    double top = bone_at;
    for (const surface::detail::Span& s : cover.spans(u, v, 0))
      if (s.enter <= bone_at && s.leave >= bone_at) top = s.enter;
    return top;
  };
  out.skin_enter_mm = skin_above(0, 0, axis.enter);
  double top = std::min(out.skin_enter_mm, out.bone_begin_mm);
  for (std::size_t i = 0; i < samples.size(); ++i)
    top = std::min(
        top, skin_above(radius_mm * samples[i][0], radius_mm * samples[i][1], bones[i] ? bones[i]->enter : axis.enter));
  out.begin_mm = top - skin_clearance_mm;
  return out;
}

void check_within_scan(const Cutter& cutter, double from_mm, const std::vector<CutFace>& faces) {
  for (const CutFace& face : faces) {
    const double along = dot(face.normal, cutter.direction);
    const double reach = cutter.radius_mm * std::sqrt(std::max(0.0, 1 - along * along));
    const double left = std::min(face.inside_mm(cutter.position_mm + cutter.direction * from_mm),
                                 face.inside_mm(cutter.position_mm + cutter.direction * cutter.depth_mm)) -
                        reach;
    if (left < 0)
      refuse(fmt::format("the hole would leave the scanned volume by {:.1f} mm: the scan ends beside {}", -left,
                         text_of(cutter.position_mm)),
             {"move it by `position_mm`, or take a series with a wider field of view"});
  }
}

}  // namespace trephine::boolean::detail
