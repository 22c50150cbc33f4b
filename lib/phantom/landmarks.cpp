// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/landmarks.h"

#include "phantom/model.h"

namespace trephine::phantom {
namespace {

/// Where the ray enters the skin: marched in from outside, then bisected.
Vec3 enter_skin(const Head& head, Vec3 from, Vec3 direction) {
  double t = 0;
  while (t < 300 && head.implicit_mm(Anatomy::skin, from + direction * t) > 0) t += 0.25;
  double low = t - 0.25, high = t;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (head.implicit_mm(Anatomy::skin, from + direction * middle) > 0 ? low : high) = middle;
  }
  return from + direction * high;
}

/// The midline's world x at a model height, as the warp leaves x = 0 in place: always 0.
Vec3 midline_profile(const Head& head, const Model& model, double z, double side) {
  const Vec3 from = model.to_world({0, side * 160, z});
  return enter_skin(head, from, {0, -side, 0});
}

}  // namespace

Vec3 walk_on_skin_mm(const Head& head, Vec3 start, Vec3 plane, Vec3 ahead, double length_mm) {
  Vec3 x = start, direction = ahead, normal;
  plane = normalized(plane);
  for (double walked = 0; walked < length_mm - 1e-9;) {
    head.implicit_mm(Anatomy::skin, x, normal);
    Vec3 tangent = normalized(cross(plane, normal));
    if (dot(tangent, direction) < 0) tangent = -tangent;
    Vec3 y = x + tangent * std::min(0.25, length_mm - walked);
    for (int i = 0; i < 4; ++i) {
      const double f = head.implicit_mm(Anatomy::skin, y, normal);
      const Vec3 g = normal - plane * dot(normal, plane);
      y += g * (-f / std::max(1e-9, dot(g, g)));
    }
    const double moved = norm(y - x);
    if (!(moved > 1e-9)) break;
    walked += moved;
    direction = tangent;
    x = y;
  }
  return x;
}

Landmarks find_landmarks(const Head& head, const Model& model) {
  // Nasion: the profile's deepest point between brow and nose, by ternary-like scanning in 0.1 mm.
  Vec3 nasion{0, -1e3, 0};
  for (double z = 20; z <= 40; z += 0.1) {
    const Vec3 p = midline_profile(head, model, z, -1);
    if (p.y > nasion.y) nasion = p;
  }
  // Inion: the farthest point to the back around the protuberance.
  Vec3 inion{0, -1e3, 0};
  for (double z = 2; z <= 20; z += 0.1) {
    const Vec3 p = midline_profile(head, model, z, 1);
    const double tilt = 0.35;  // the occiput slants: the protuberance is a maximum against the slant
    if (p.y - tilt * p.z > inion.y - tilt * inion.z) inion = p;
  }
  Landmarks out{{"nasion", nasion}, {"inion", inion}};
  for (int side = 1; side >= -1; side -= 2) {
    const Vec3 from = model.to_world({side * 120.0, -3, 0});
    out.emplace_back(side > 0 ? "tragus_left" : "tragus_right", enter_skin(head, from, {-1.0 * side, 0, 0}));
  }
  const Vec3 up = walk_on_skin_mm(head, nasion, {1, 0, 0}, {0, 0, 1}, 110);
  Vec3 out_of_skin;
  head.implicit_mm(Anatomy::skin, up, out_of_skin);
  const Vec3 along_midline = cross({1, 0, 0}, out_of_skin);  // the lateral walk goes square to the midline
  for (int side = 1; side >= -1; side -= 2)
    out.emplace_back(side > 0 ? "kocher_left" : "kocher_right",
                     walk_on_skin_mm(head, up, along_midline, {1.0 * side, 0, 0}, 27.5));
  for (int side = 1; side >= -1; side -= 2) {
    const Vec3 middle = (model.monro_top.at + model.monro_bottom.at) * 0.5;
    // Model coordinates before the ventricles' own shift: invert that by iteration, it is a contraction.
    const Vec3 target{side * middle.x, middle.y, middle.z};
    Vec3 m = target;
    for (int i = 0; i < 60; ++i) {
      const PointD s = model.shifted(PointD{m.x, m.y, m.z});
      m = m + (target - Vec3{s.x, s.y, s.z});
    }
    out.emplace_back(side > 0 ? "monro_left" : "monro_right", model.to_world(m));
  }
  return out;
}

}  // namespace trephine::phantom
