// SPDX-License-Identifier: GPL-3.0-or-later
// What is drawn on planes: caps of a cut, slices of the CT in the scene and in a corner.
#include <algorithm>
#include <cmath>

#include "haptics/tool.h"
#include "render/renderer_impl.h"

namespace trephine::render {

// Where more back than front faces are passed on the way to the eye, the plane lies within the solid. Shapes within
// others come later, at the same depth.
void Renderer::Impl::draw_caps(const scene::EyeView& eye, const scene::SceneState& state) {
  const Mat3 frame = haptics::frame_along(normalized(state.cut->normal));
  const Vec3 normal = frame.column[2], at = relative(state.cut->point_mm);
  const Vec3 middle = normal * dot(normal, at), across = frame.column[0] * radius_mm,
             along = frame.column[1] * radius_mm;
  const float light = 0.35f + 0.6f * float(std::abs(dot(normal, eye.toward)));
  glEnable(GL_STENCIL_TEST);
  for (std::size_t n = 0; n < items.size() && n < state.opacity.size(); ++n) {
    if (state.opacity[n] <= 0) continue;
    begin_surface(eye, state);
    use_surface(n, state, 1);
    if (items[n].incised && !walls.empty()) set_balls(*surface, false);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDisable(GL_DEPTH_TEST);
    glStencilFunc(GL_ALWAYS, 0, 255);
    glStencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    draw_surface(n, Sight::Faces::both);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_CLIP_DISTANCE0);
    glStencilFunc(GL_NOTEQUAL, 0, 255);
    glStencilOp(GL_ZERO, GL_ZERO, GL_ZERO);
    planes.use(eye, centre_mm, noise);
    const std::array<float, 3>& c = items[n].colour_rgb;
    planes.shader().set("tint", linear_of(c[0]), linear_of(c[1]), linear_of(c[2]));
    planes.shader().set("ct_share", planes.has_ct() && state.cut_shows_ct ? 0.8f : 0.f);
    planes.shader().set("only_ct", 0);
    planes.shader().set("light", light);
    planes.shader().set("low", float(state.ct_low_hu));
    planes.shader().set("high", float(state.ct_high_hu));
    set_balls(planes.shader(), items[n].incised);
    planes.draw(middle, across, along);
    glDepthFunc(GL_LESS);
    glEnable(GL_CLIP_DISTANCE0);
  }
  glDisable(GL_STENCIL_TEST);
}

void Renderer::Impl::draw_ct_planes(const scene::EyeView& eye, const scene::SceneState& state) {
  if (!planes.has_ct() || state.ct_planes.empty()) return;
  planes.use(eye, centre_mm, noise);
  planes.shader().set("tint", 0.f, 0.f, 0.f);
  planes.shader().set("ct_share", 1.f);
  planes.shader().set("only_ct", 1);
  planes.shader().set("light", 1.f);
  planes.shader().set("low", float(state.ct_low_hu));
  planes.shader().set("high", float(state.ct_high_hu));
  set_balls(planes.shader(), false);
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const scene::CtPlane& p : state.ct_planes) {
    const Vec3 normal = axes[p.axis];
    planes.draw(normal * dot(normal, relative(p.point_mm)), axes[(p.axis + 1) % 3] * radius_mm,
                axes[(p.axis + 2) % 3] * radius_mm);
  }
}

void Renderer::draw_inset(const scene::CtPlane& at, const scene::SceneState& state, int x, int y, int size,
                          double half_mm) {
  Impl& r = *impl_;
  if (!r.planes.has_ct() || size < 8) return;
  const Vec3 left{1, 0, 0}, back{0, 1, 0}, head{0, 0, 1};
  const Vec3 right = at.axis == 0 ? -back : left, up = at.axis == 2 ? -back : head, middle = r.relative(at.point_mm);
  scene::Mat4 flat;
  flat.m.fill(0);
  for (int c = 0; c < 3; ++c) {
    flat.at(0, c) = float(right[c] / half_mm);
    flat.at(1, c) = float(up[c] / half_mm);
  }
  flat.at(0, 3) = float(-dot(right, middle) / half_mm);
  flat.at(1, 3) = float(-dot(up, middle) / half_mm);
  flat.at(3, 3) = 1;
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_SCISSOR_TEST);
  const auto fill = [&](int fx, int fy, int w, int h, float red, float green, float blue) {
    glScissor(fx, fy, w, h);
    glClearColor(red, green, blue, 1);
    glClear(GL_COLOR_BUFFER_BIT);
  };
  fill(x, y, size, size, 0, 0, 0);
  glViewport(x, y, size, size);
  r.planes.use(scene::EyeView(), r.centre_mm, r.noise);
  r.planes.shader().set("to_camera", flat);
  r.planes.shader().set("projection", scene::Mat4());
  r.planes.shader().set("tint", 0.f, 0.f, 0.f);
  r.planes.shader().set("ct_share", 1.f);
  r.planes.shader().set("only_ct", 0);
  r.planes.shader().set("encode", 1);
  r.planes.shader().set("light", 1.f);
  r.planes.shader().set("low", float(state.ct_low_hu));
  r.planes.shader().set("high", float(state.ct_high_hu));
  r.set_balls(r.planes.shader(), false);
  r.planes.draw(middle, right * half_mm, up * half_mm);
  fill(x + size / 2, y, 1, size, 0.9f, 0.62f, 0);
  fill(x, y + size / 2, size, 1, 0.9f, 0.62f, 0);
  glDisable(GL_SCISSOR_TEST);
  check_gl("a slice");
}

}  // namespace trephine::render
