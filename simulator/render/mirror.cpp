// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/mirror.h"

#include "render/gl_object.h"

namespace trephine::render {

void mirror_place(Mirror how, int width, int height, double& x, double& y) {
  if (how == Mirror::left_right) x = width - x;
  if (how == Mirror::up_down) y = height - y;
}

struct MirroredScreen::Impl {
  int width = 0, height = 0;
  GlObject frame, colour;
};

MirroredScreen::MirroredScreen() : impl_(new Impl) {}
MirroredScreen::~MirroredScreen() = default;

void MirroredScreen::flip(Mirror how, int width, int height) {
  if (how == Mirror::none) return;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDrawBuffer(GL_BACK);
  glReadBuffer(GL_BACK);
  flip_bound(how, width, height);
}

void MirroredScreen::flip_bound(Mirror how, int width, int height) {
  if (how == Mirror::none) return;
  GLint bound = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
  if (impl_->width != width || impl_->height != height) {
    impl_->colour = make_renderbuffer();
    glBindRenderbuffer(GL_RENDERBUFFER, impl_->colour);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    impl_->frame = make_framebuffer();
    glBindFramebuffer(GL_FRAMEBUFFER, impl_->frame);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, impl_->colour);
    impl_->width = width;
    impl_->height = height;
  }
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, impl_->frame);
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->frame);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(bound));
  const bool sideways = how == Mirror::left_right;
  glBlitFramebuffer(0, 0, width, height, sideways ? width : 0, sideways ? 0 : height, sideways ? 0 : width,
                    sideways ? height : 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, GLuint(bound));
  check_gl("the mirrored picture");
}

}  // namespace trephine::render
