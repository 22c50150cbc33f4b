// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "render/gl_object.h"
#include "render/surface_buffer.h"
#include "scene/camera.h"
#include "scene/scene.h"
#include "scene/tool_solid.h"

namespace trephine::render {

/// The tool's shadow [Williams1978]: how far it lies from the tool says how deep the tip is. The tool as the key light
/// sees it, in a map that is a narrow strip along the tool, so that it is fine everywhere and costs next to nothing to
/// draw.
class ToolShadow {
 public:
  ToolShadow();
  void set_tool(const scene::Solid& solid);
  /// Draws the map with so many samples (RenderQuality::shadow_taps), and leaves its framebuffer bound; or nothing,
  /// where the picture has no shadow.
  void cast(const SolidBuffer& tool, const scene::EyeView& eye, const scene::SceneState& state, Vec3 centre_mm,
            int taps);
  bool casts_any() const { return casts_; }
  /// For a surface on which it falls.
  void receive(const GlProgram& surface) const;

 private:
  GlProgram program_;
  GlObject frame_, map_;
  double radius_mm_ = 0, low_mm_ = 0, high_mm_ = 0;  // a cylinder about the tool's axis that holds it
  bool casts_ = false;                               // in this picture
  int taps_ = 0;
  scene::Mat4 to_shadow_;
  float step_[2] = {0, 0};
};

}  // namespace trephine::render
