// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

namespace trephine::render {

/// How a window is turned over: for a screen that is seen in a mirror.
enum class Mirror { none, left_right, up_down };
/// Where a place of the mirrored picture lies in the picture itself, and the other way: both in pixels from the upper
/// left corner.
void mirror_place(Mirror how, int width, int height, double& x, double& y);

/// Turns over what the window's back buffer holds, panels too. In the thread of the context.
class MirroredScreen {
 public:
  MirroredScreen();
  ~MirroredScreen();
  void flip(Mirror how, int width, int height);
  /// The same of the framebuffer that is bound for drawing and reading.
  void flip_bound(Mirror how, int width, int height);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trephine::render
