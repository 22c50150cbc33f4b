// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/camera.h"

#include <algorithm>
#include <cmath>

#include "base/degree.h"
#include "base/error.h"
#include "picture/stroke.h"
#include "surface/bounds.h"

namespace trephine::picture::detail {
namespace {

constexpr Rgb ink{0.16, 0.19, 0.23}, halo{1, 1, 1};

struct Axes {
  Vec3 toward, up;
};

Axes axes_of(View view) {
  const Vec3 left{1, 0, 0}, front{0, -1, 0}, top{0, 0, 1};
  switch (view) {
    case View::front:
      return {front, top};
    case View::back:
      return {-front, top};
    case View::left:
      return {left, top};
    case View::right:
      return {-left, top};
    case View::top:
      return {top, front};
    case View::bottom:
      return {-top, front};
    case View::oblique_left:
      return {left * 0.68 + front * 0.82 + top * 0.36, top};
    case View::oblique_right:
      return {left * -0.68 + front * 0.82 + top * 0.36, top};
  }
  return {front, top};
}

bool is_oblique(View v) { return v == View::oblique_left || v == View::oblique_right; }

template <class F>
void for_each_point(const std::vector<SurfaceView>& surfaces, const RenderParams& params, F&& f) {
  if (!params.frame) {
    for (const auto& s : surfaces)
      for (std::size_t i = 0; i < s.mesh->points_mm.size(); ++i) f(s.mesh->world_mm(i));
    return;
  }
  for (const Vec3 corner : surface::corners_of(*params.frame)) f(corner);
}

// The letter of the patient's side that a direction points to.
std::string_view letter_of(Vec3 d) {
  const double a[3] = {std::abs(d.x), std::abs(d.y), std::abs(d.z)};
  if (a[0] >= a[1] && a[0] >= a[2]) return d.x > 0 ? "L" : "R";
  if (a[1] >= a[2]) return d.y > 0 ? "P" : "A";
  return d.z > 0 ? "S" : "I";
}

// The three axes as the camera sees them; those that point away from it come first.
void draw_axes(Image& image, const Camera& camera, double text_px) {
  const double reach = text_px * 2.2, x0 = text_px * 4, y0 = image.height - text_px * 4;
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}};
  const std::array<Rgb, 3> colours{Rgb{0.80, 0.22, 0.20}, Rgb{0.16, 0.55, 0.28}, Rgb{0.16, 0.38, 0.78}};
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return dot(axes[a], camera.toward) < dot(axes[b], camera.toward); });
  StrokeMask line(image.width, image.height);
  for (const int a : order) {
    const double dx = dot(axes[a], camera.right), dy = -dot(axes[a], camera.up);
    line.clear();
    line.add_segment(x0, y0, x0 + dx * reach, y0 + dy * reach, std::max(2.0, text_px * 0.2));
    line.blend(image, colours[a]);
    const std::string_view letter = letter_of(axes[a]);
    draw_text(image, x0 + dx * (reach + text_px) - text_width(letter, text_px) * 0.4,
              y0 + dy * (reach + text_px) - text_px / 2, letter, text_px, colours[a], halo);
  }
}

}  // namespace

Camera camera_for(const std::vector<SurfaceView>& surfaces, const RenderParams& params) {
  Camera c;
  const Axes axes = axes_of(params.view);
  c.toward = normalized(axes.toward);
  c.right = normalized(cross(axes.up, c.toward));
  c.up = cross(c.toward, c.right);

  surface::Bounds b;
  bool any = false;
  for_each_point(surfaces, params, [&](Vec3 p) {
    any = true;
    surface::include(b, p);
  });
  if (!any) b = {{-1, -1, -1}, {1, 1, 1}};
  if (!is_finite(b.min_mm) || !is_finite(b.max_mm)) throw Error(ExitCode::bad_input, "", "frame", "is not finite");
  c.target_mm = (b.min_mm + b.max_mm) / 2;
  const double radius = std::max(1e-6, norm(b.max_mm - b.min_mm) / 2);
  if (params.field_of_view_deg > 0) {
    c.distance_mm = radius / std::sin(std::clamp(params.field_of_view_deg, 1.0, 120.0) / 2 * degree);
  }

  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  const auto widen = [&](Vec3 world) {
    const Vec3 p = c.to_camera(world);
    // A point outside the given frame may lie behind the eye; a point within it cannot.
    const double m = c.magnification(p.z);
    x0 = std::min(x0, p.x * m);
    x1 = std::max(x1, p.x * m);
    y0 = std::min(y0, p.y * m);
    y1 = std::max(y1, p.y * m);
  };
  if (any)
    for_each_point(surfaces, params, widen);
  else
    x0 = y0 = -1, x1 = y1 = 1;
  const double margin = params.marks ? 0.86 : 0.94;
  const double w = std::max(1e-9, x1 - x0), h = std::max(1e-9, y1 - y0);
  c.px_per_mm = std::min(params.width * margin / w, params.height * margin / h);
  c.center_x = params.width / 2.0 - (x0 + x1) / 2 * c.px_per_mm;
  c.center_y = params.height / 2.0 + (y0 + y1) / 2 * c.px_per_mm;
  return c;
}

void draw_marks(Image& image, const Camera& camera, const RenderParams& params) {
  const double text_px = std::clamp(std::min(params.width, params.height) * 0.021, 7.0, 28.0);
  if (!params.title.empty()) draw_text(image, text_px, text_px, params.title, text_px * 1.1, ink, halo);
  if (!params.marks) return;
  if (is_oblique(params.view))
    draw_axes(image, camera, text_px);
  else
    draw_edge_letters(image, letter_of(-camera.right), letter_of(camera.right), letter_of(camera.up),
                      letter_of(-camera.up), text_px * 1.2, ink, halo);
  draw_scale_bar(image, 1 / camera.px_per_mm, params.width * 0.25, text_px * 0.9, ink, halo);
}

}  // namespace trephine::picture::detail
