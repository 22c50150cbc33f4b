// SPDX-License-Identifier: GPL-3.0-or-later
// The tool's shadow [Williams1978]: how far it lies from the tool says how deep the tip is. The map is a narrow strip
// along the tool, so that it is fine everywhere and costs next to nothing to draw.
#include <algorithm>
#include <cmath>

#include "haptics/tool.h"
#include "render/renderer_impl.h"

namespace trephine::render {
namespace {

constexpr int map_across = 128, map_along = 1024;
constexpr double margin_mm = 1, bias_mm = 0.2, soft_mm = 0.35;

}  // namespace

void Renderer::Impl::make_shadow_map() {
  shadow_map = make_texture();
  glBindTexture(GL_TEXTURE_2D, shadow_map);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, map_across, map_along, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
               nullptr);
  for (const GLenum what : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, what, GL_CLAMP_TO_BORDER);
  const float lit[] = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  shadow_frame = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadow_map, 0);
  glDrawBuffer(GL_NONE);
  check_gl("the shadow");
}

// Draws the map, and leaves its framebuffer bound.
void Renderer::Impl::cast_shadow(const scene::EyeView& eye, const scene::SceneState& state) {
  casts = state.tool_shown && quality.shadow_taps > 0 && tool_high_mm > tool_low_mm;
  if (!casts) return;
  const std::array<float, 3>& key = shaders::key_light;
  const Vec3 light = normalized(eye.right * key[0] + eye.up * key[1] + eye.toward * key[2]);
  const Vec3 axis = normalized(state.axis), tip = relative(state.tip_mm);
  Vec3 along = axis - light * dot(axis, light);
  along = norm(along) > 1e-3 ? normalized(along) : haptics::frame_along(light).column[0];
  const Vec3 across = cross(along, light);
  // The box of the tool's cylinder along these three.
  const auto reach = [&](Vec3 direction, double& low, double& high) {
    const double a = dot(direction, tip + axis * tool_low_mm), b = dot(direction, tip + axis * tool_high_mm);
    low = std::min(a, b) - tool_radius_mm - margin_mm;
    high = std::max(a, b) + tool_radius_mm + margin_mm;
  };
  const Vec3 rows[3] = {across, along, -light};
  scene::Mat4 to_light;
  to_shadow = scene::Mat4();
  double size[3];
  for (int r = 0; r < 3; ++r) {
    double low = 0, high = 1;
    reach(rows[r], low, high);
    size[r] = high - low;
    for (int c = 0; c < 3; ++c) {
      to_light.at(r, c) = float(2 * rows[r][c] / size[r]);
      to_shadow.at(r, c) = float(rows[r][c] / size[r]);
    }
    to_light.at(r, 3) = float(-2 * low / size[r] - 1);
    to_shadow.at(r, 3) = float(-low / size[r]);
  }
  to_shadow.at(2, 3) -= float(bias_mm / size[2]);
  // On a processor every texel that is read is dear: it has one sample, and an edge of a texel.
  const GLint filter = quality.shadow_taps > 1 ? GL_LINEAR : GL_NEAREST;
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, shadow_map);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glActiveTexture(GL_TEXTURE0);
  shadow_step[0] = float(soft_mm / size[0]);
  shadow_step[1] = float(soft_mm / size[1]);

  glBindFramebuffer(GL_FRAMEBUFFER, shadow_frame);
  glViewport(0, 0, map_across, map_along);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDisable(GL_CULL_FACE);
  shadow.use();
  shadow.set("model", scene::affine(haptics::frame_along(state.axis), tip));
  shadow.set("to_light", to_light);
  tool.draw();
}

void Renderer::Impl::receive_shadow(const GlProgram& p) const {
  p.set("shadow", 2);
  p.set("shadow_taps", std::clamp(quality.shadow_taps, 1, 5));
  p.set("to_shadow", to_shadow);
  p.set("shadow_step", shadow_step[0], shadow_step[1]);
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, shadow_map);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace trephine::render
