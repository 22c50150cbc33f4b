// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "render/drawn_surface.h"
#include "render/gl_object.h"
#include "scene/bone_dust.h"
#include "scene/scene.h"

namespace trephine::render {

/// The powder, water and blood of a picture as a texture, and which chunks of a surface lie about them.
class DustTexture {
 public:
  /// Takes those of the picture, and whether there are any.
  void take(const scene::SceneState& state, Vec3 centre_mm);
  bool any() const { return there_; }
  /// For a surface that may be covered with them.
  void set(const GlProgram& surface) const;
  /// By chunk of a surface, whether it lies about the dust, and whether it lies elsewhere; neither where it is not
  /// `seen` (may be null).
  void part(const PlacedChunks& placed, const std::vector<std::uint8_t>* seen);
  const std::vector<std::uint8_t>& near() const { return near_it_; }
  const std::vector<std::uint8_t>& elsewhere() const { return far_from_it_; }

 private:
  GlObject texture_;
  std::uint64_t version_ = 0;  // of what it holds
  const scene::BoneDust* of_ = nullptr;
  bool there_ = false;  // in this picture
  scene::Mat4 to_dust_;
  Vec3 middle_mm_;  // from the scene's centre
  std::vector<std::uint8_t> near_it_, far_from_it_;
};

}  // namespace trephine::render
