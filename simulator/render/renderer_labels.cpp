// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "haptics/tool.h"
#include "render/renderer_impl.h"

namespace trephine::render {
namespace {

GlObject buffer_of(GLenum format, GLenum attachment, int width, int height) {
  GlObject buffer = make_renderbuffer();
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorage(GL_RENDERBUFFER, format, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  return buffer;
}

// OpenGL reads rows from below.
template <class T>
std::vector<T> read_from_top(GLenum attachment, GLenum layout, GLenum type, int width, int height) {
  std::vector<T> below(std::size_t(width) * std::size_t(height)), above(below.size());
  glReadBuffer(attachment);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, layout, type, below.data());
  const std::size_t row = std::size_t(width);
  for (std::size_t y = 0; y < std::size_t(height); ++y)
    std::memcpy(above.data() + y * row, below.data() + (std::size_t(height) - 1 - y) * row, row * sizeof(T));
  return above;
}

}  // namespace

LabelPicture Renderer::Impl::draw_labels(const scene::EyeView& eye, const scene::SceneState& shown, int w, int h) {
  scene::SceneState state;
  state.opacity = shown.opacity;
  state.tool_shown = shown.tool_shown;
  state.tip_mm = shown.tip_mm;
  state.axis = shown.axis;
  state.second_shown = shown.second_shown;
  state.second_tip_mm = shown.second_tip_mm;
  state.second_axis = shown.second_axis;
  dust.take(state, centre_mm);

  const GlObject frame = make_framebuffer();
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  const GlObject distance = buffer_of(GL_R32F, GL_COLOR_ATTACHMENT0, w, h),
                 label = buffer_of(GL_R8UI, GL_COLOR_ATTACHMENT1, w, h),
                 depth = buffer_of(GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, w, h);
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both);
  check_framebuffer();
  glViewport(0, 0, w, h);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_BLEND);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const float nowhere[4] = {0, 0, 0, 0}, far[1] = {1};
  const GLuint nothing[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nowhere);
  glClearBufferuiv(GL_COLOR, 1, nothing);
  glClearBufferfv(GL_DEPTH, 0, far);

  sight = sight_of(eye, state, centre_mm);
  lists.clear();
  labelling = true;
  begin_surface(eye, state);
  const RenderQuality of_pictures = quality;
  quality.ask_hidden = false;  // a box that is asked for would be drawn with a colour
  draw_opaque(eye, state);
  quality = of_pictures;
  draw_walls(state);
  glEnable(GL_CULL_FACE);
  draw_tools(state);
  glDisable(GL_CULL_FACE);
  labelling = false;
  begun.reset();
  kept.after_pass();

  LabelPicture out{w, h, {}, {}};
  out.depth_mm = read_from_top<float>(GL_COLOR_ATTACHMENT0, GL_RED, GL_FLOAT, w, h);
  out.label = read_from_top<std::uint8_t>(GL_COLOR_ATTACHMENT1, GL_RED_INTEGER, GL_UNSIGNED_BYTE, w, h);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return out;
}

LabelPicture draw_labels(Renderer& renderer, const scene::EyeView& eye, const scene::SceneState& state, int width,
                         int height) {
  renderer.impl_->kept.new_picture();
  LabelPicture out = renderer.impl_->draw_labels(eye, state, width, height);
  check_gl("a picture of labels");
  return out;
}

}  // namespace trephine::render
