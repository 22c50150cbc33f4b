// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "render/gl_object.h"
#include "render/kept_fences.h"
#include "scene/camera.h"

namespace trephine::render {

/// What a picture is drawn into: with several samples a pixel, then as one with colour and depth as textures, and at
/// half its size for the darkening of creases.
class PictureTargets {
 public:
  PictureTargets();
  /// Makes them anew where size or samples changed. Throws Error 74 where the driver refuses the size.
  void make(int width, int height);
  void set_samples(int count);
  /// What a picture is drawn into first.
  GLuint frame() const { return samples_ > 1 ? many_ : one_; }
  /// From several samples to the picture's own, which is then bound.
  void resolve(GLbitfield what, KeptFences& kept) const;
  /// Darkens what is near behind something, within that distance; leaves frame() bound.
  void darken(const scene::EyeView& eye, double occlusion_mm, KeptFences& kept);
  /// Of the picture itself, after resolve(GL_DEPTH_BUFFER_BIT).
  GLuint depth() const { return one_depth_; }
  /// See Renderer::present.
  void present(int x, int y, int width, int height, int mask) const;
  std::size_t bytes() const;

 private:
  bool copies_ = false;  // present() may copy bytes
  int samples_ = 1, width_ = 0, height_ = 0;
  GlProgram openness_, smoothing_, darkening_, presenting_;
  GlObject empty_array_;
  GlObject many_, many_colour_, many_depth_, one_, one_colour_, one_depth_, half_, half_open_, half_too_, half_smooth_;
};

}  // namespace trephine::render
