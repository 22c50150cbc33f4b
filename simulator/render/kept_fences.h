// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "render/gl_object.h"

namespace trephine::render {

/// Keeps Mesa's llvmpipe from freeing a fence that its own thread has not let go of yet.
///
/// llvmpipe counts a fence as signalled a moment before the thread that signals it has unlocked the fence's mutex. A
/// caller that asks just then frees the fence, and the thread writes into freed memory, which may end the program on
/// a busy machine (measured in Mesa 22.3.6, src/gallium/drivers/llvmpipe/lp_fence.c; docs/developers/decisions.md). A
/// sync object of OpenGL holds the fence of the pass before it. So one is made after every pass, and it is deleted two
/// pictures later, when the thread has long finished work that came after it. Other drivers need none of this: with
/// `software` false nothing is done.
class KeptFences {
 public:
  explicit KeptFences(bool software) : software_(software) {}
  ~KeptFences();
  KeptFences(const KeptFences&) = delete;
  KeptFences& operator=(const KeptFences&) = delete;
  /// To be called where a pass ends, which is before another framebuffer is bound or read. Sends the pass off.
  void after_pass();
  /// To be called before the first pass of a picture. Waits for all that was drawn before it.
  void new_picture();

 private:
  bool software_;
  std::vector<GLsync> of_this_, of_last_;
};

}  // namespace trephine::render
