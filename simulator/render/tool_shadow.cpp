// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/tool_shadow.h"

#include <algorithm>
#include <cmath>

#include "haptics/tool.h"
#include "render/shaders.h"

namespace trephine::render {
namespace {

constexpr int map_across = 128, map_along = 1024;
constexpr double margin_mm = 1, bias_mm = 0.2, soft_mm = 0.35;

}  // namespace

ToolShadow::ToolShadow() : program_(shaders::shadow_vertex, shaders::box_fragment) {
  map_ = make_texture();
  glBindTexture(GL_TEXTURE_2D, map_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, map_across, map_along, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
               nullptr);
  for (const GLenum what : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, what, GL_CLAMP_TO_BORDER);
  const float lit[] = {1, 1, 1, 1};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  frame_ = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map_, 0);
  glDrawBuffer(GL_NONE);
  check_gl("the shadow");
}

void ToolShadow::set_tool(const scene::Solid& solid) {
  radius_mm_ = low_mm_ = high_mm_ = 0;
  for (const scene::SolidVertex& v : solid.vertices) {
    radius_mm_ = std::max(radius_mm_, double(std::hypot(v.position_mm[0], v.position_mm[1])));
    low_mm_ = std::min(low_mm_, double(v.position_mm[2]));
    high_mm_ = std::max(high_mm_, double(v.position_mm[2]));
  }
}

// Draws the map, and leaves its framebuffer bound.
void ToolShadow::cast(const SolidBuffer& tool, const scene::EyeView& eye, const scene::SceneState& state,
                      Vec3 centre_mm, int shadow_taps) {
  taps_ = shadow_taps;
  casts_ = state.tool_shown && taps_ > 0 && high_mm_ > low_mm_;
  if (!casts_) return;
  const std::array<float, 3>& key = shaders::key_light;
  const Vec3 light = normalized(eye.right * key[0] + eye.up * key[1] + eye.toward * key[2]);
  const Vec3 axis = normalized(state.axis), tip = state.tip_mm - centre_mm;
  Vec3 along = axis - light * dot(axis, light);
  along = norm(along) > 1e-3 ? normalized(along) : haptics::frame_along(light).column[0];
  const Vec3 across = cross(along, light);
  // The box of the tool's cylinder along these three.
  const auto reach = [&](Vec3 direction, double& low, double& high) {
    const double a = dot(direction, tip + axis * low_mm_), b = dot(direction, tip + axis * high_mm_);
    low = std::min(a, b) - radius_mm_ - margin_mm;
    high = std::max(a, b) + radius_mm_ + margin_mm;
  };
  const Vec3 rows[3] = {across, along, -light};
  scene::Mat4 to_light;
  to_shadow_ = scene::Mat4();
  double size[3];
  for (int r = 0; r < 3; ++r) {
    double low = 0, high = 1;
    reach(rows[r], low, high);
    size[r] = high - low;
    for (int c = 0; c < 3; ++c) {
      to_light.at(r, c) = float(2 * rows[r][c] / size[r]);
      to_shadow_.at(r, c) = float(rows[r][c] / size[r]);
    }
    to_light.at(r, 3) = float(-2 * low / size[r] - 1);
    to_shadow_.at(r, 3) = float(-low / size[r]);
  }
  to_shadow_.at(2, 3) -= float(bias_mm / size[2]);
  // On a processor every texel that is read is dear: it has one sample, and an edge of a texel.
  const GLint filter = taps_ > 1 ? GL_LINEAR : GL_NEAREST;
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, map_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glActiveTexture(GL_TEXTURE0);
  step_[0] = float(soft_mm / size[0]);
  step_[1] = float(soft_mm / size[1]);

  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, map_across, map_along);
  glClear(GL_DEPTH_BUFFER_BIT);
  glDisable(GL_CULL_FACE);
  program_.use();
  program_.set("model", scene::affine(haptics::frame_along(state.axis), tip));
  program_.set("to_light", to_light);
  tool.draw();
}

void ToolShadow::receive(const GlProgram& p) const {
  p.set("shadow", 2);
  p.set("shadow_taps", std::clamp(taps_, 1, 5));
  p.set("to_shadow", to_shadow_);
  p.set("shadow_step", step_[0], step_[1]);
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, map_);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace trephine::render
