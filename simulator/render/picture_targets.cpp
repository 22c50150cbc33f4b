// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture_targets.h"

#include <algorithm>
#include <cstdint>

#include "render/context.h"
#include "render/memory.h"
#include "render/shaders.h"

namespace trephine::render {
namespace {

// Whether the driver copies the picture's bytes as they are, sRGB into a framebuffer that does not know of it. OpenGL
// says so, and some drivers were known not to.
bool copies_bytes() {
  const GlObject from = make_framebuffer(), to = make_framebuffer();
  const GlObject source = make_renderbuffer(), target = make_renderbuffer();
  glBindRenderbuffer(GL_RENDERBUFFER, source);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_SRGB8_ALPHA8, 1, 1);
  glBindRenderbuffer(GL_RENDERBUFFER, target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
  glBindFramebuffer(GL_FRAMEBUFFER, to);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  glBindFramebuffer(GL_FRAMEBUFFER, from);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, source);
  glEnable(GL_FRAMEBUFFER_SRGB);
  const float half_lit[] = {0.5f, 0.5f, 0.5f, 1};
  glClearBufferfv(GL_COLOR, 0, half_lit);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  glBlitFramebuffer(0, 0, 1, 1, 0, 0, 1, 1, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, to);
  std::uint8_t pixel[4] = {};
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  return pixel[0] >= 187 && pixel[0] <= 189;  // 0.5 as sRGB
}

}  // namespace

PictureTargets::PictureTargets()
    : openness_(shaders::screen_vertex, shaders::openness_fragment),
      smoothing_(shaders::screen_vertex, shaders::smooth_fragment),
      darkening_(shaders::screen_vertex, shaders::darken_fragment),
      presenting_(shaders::screen_vertex, shaders::present_fragment),
      empty_array_(make_vertex_array()) {
  copies_ = copies_bytes();
}

void PictureTargets::set_samples(int count) {
  const int may = std::clamp(count, 1, driver_facts().max_samples);
  if (may != samples_) width_ = 0;
  samples_ = may;
}

std::size_t PictureTargets::bytes() const { return picture_bytes(width_, height_, samples_); }

void PictureTargets::resolve(GLbitfield what, KeptFences& kept) const {
  if (samples_ <= 1) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, many_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, one_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, what, GL_NEAREST);
  kept.after_pass();
  glBindFramebuffer(GL_FRAMEBUFFER, one_);
}

void PictureTargets::make(int w, int h) {
  if (w == width_ && h == height_) return;
  width_ = w;
  height_ = h;
  const auto texture = [](GLenum format, int tw, int th, GLenum layout, GLenum type, GLint how) {
    GlObject t = make_texture();
    glBindTexture(GL_TEXTURE_2D, t);
    glTexImage2D(GL_TEXTURE_2D, 0, GLint(format), tw, th, 0, layout, type, nullptr);
    set_filter(GL_TEXTURE_2D, how, GL_CLAMP_TO_EDGE);
    return t;
  };
  one_ = make_framebuffer();
  one_colour_ = texture(GL_SRGB8_ALPHA8, w, h, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR);
  one_depth_ = texture(GL_DEPTH24_STENCIL8, w, h, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, one_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, one_colour_, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D, one_depth_, 0);
  check_framebuffer();
  half_ = make_framebuffer();
  half_open_ = texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, half_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, half_open_, 0);
  check_framebuffer();
  half_too_ = make_framebuffer();
  half_smooth_ = texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE, GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, half_too_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, half_smooth_, 0);
  check_framebuffer();
  if (samples_ > 1) {
    many_ = make_framebuffer();
    many_colour_ = make_renderbuffer();
    many_depth_ = make_renderbuffer();
    glBindRenderbuffer(GL_RENDERBUFFER, many_colour_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_SRGB8_ALPHA8, w, h);
    glBindRenderbuffer(GL_RENDERBUFFER, many_depth_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, GL_DEPTH24_STENCIL8, w, h);
    glBindFramebuffer(GL_FRAMEBUFFER, many_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, many_colour_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, many_depth_);
    check_framebuffer();
  }
  check_gl("the picture");
}

void PictureTargets::darken(const scene::EyeView& eye, double occlusion_mm, KeptFences& kept) {
  kept.after_pass();
  resolve(GL_DEPTH_BUFFER_BIT, kept);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CLIP_DISTANCE0);
  glBindFramebuffer(GL_FRAMEBUFFER, half_);
  glViewport(0, 0, (width_ + 1) / 2, (height_ + 1) / 2);
  openness_.use();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, one_depth_);
  openness_.set("depth", 0);
  openness_.set("frustum", float(eye.left), float(eye.right_edge), float(eye.bottom), float(eye.top));
  openness_.set("planes", float(eye.near_mm), float(eye.far_mm));
  openness_.set("radius_mm", float(occlusion_mm));
  openness_.set("px_per_tan", float(height_ / (eye.top - eye.bottom)));
  glBindVertexArray(empty_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  kept.after_pass();
  glBindFramebuffer(GL_FRAMEBUFFER, half_too_);
  smoothing_.use();
  glBindTexture(GL_TEXTURE_2D, half_open_);
  smoothing_.set("open", 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  kept.after_pass();
  glBindFramebuffer(GL_FRAMEBUFFER, frame());
  glViewport(0, 0, width_, height_);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_SRC_COLOR);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  darkening_.use();
  glBindTexture(GL_TEXTURE_2D, half_smooth_);
  darkening_.set("open", 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void PictureTargets::present(int x, int y, int w, int h, int mask) const {
  if (mask == 7 && copies_) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, one_);
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(0, 0, width_, height_, x, y, x + w, y + h, GL_COLOR_BUFFER_BIT,
                      width_ == w && height_ == h ? GL_NEAREST : GL_LINEAR);
    GLint target = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(target));
    check_gl("the picture's copy");
    return;
  }
  glViewport(x, y, w, h);
  glDisable(GL_DEPTH_TEST);
  glColorMask(mask & 1, mask >> 1 & 1, mask >> 2 & 1, GL_TRUE);
  presenting_.use();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, one_colour_);
  presenting_.set("picture", 0);
  glBindVertexArray(empty_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  check_gl("the picture's copy");
}

}  // namespace trephine::render
