// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/kept_fences.h"

namespace trephine::render {
namespace {

void drop(std::vector<GLsync>& fences) {
  for (const GLsync fence : fences) glDeleteSync(fence);
  fences.clear();
}

}  // namespace

KeptFences::~KeptFences() {
  if (software_) glFinish();
  drop(of_last_);
  drop(of_this_);
}

void KeptFences::after_pass() {
  if (!software_) return;
  glFlush();  // the pass is sent off whole, or the sync object would hold the fence of a part of it
  of_this_.push_back(glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0));
}

// All that was sent off before has been drawn then. The thread may still hold the last of these fences, which is one of
// this picture, and none of the picture before it.
void KeptFences::new_picture() {
  if (!software_) return;
  after_pass();  // what the window and its panels drew since
  glFinish();
  drop(of_last_);
  of_last_.swap(of_this_);
}

}  // namespace trephine::render
