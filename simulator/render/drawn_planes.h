// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"
#include "render/gl_object.h"
#include "scene/camera.h"

namespace trephine::render {

/// Squares on planes through the scene, with or without the CT on them: caps of a cut, and slices.
class DrawnPlanes {
 public:
  DrawnPlanes();
  void set_ct(const grid::Grid<std::int16_t>& ct, Vec3 centre_mm);
  bool has_ct() const { return GLuint(ct_) != 0; }
  std::size_t ct_bytes() const { return has_ct() ? ct_lattice_.count() * 2 : 0; }
  /// Uses the program for that eye. `without_ct`: a texture in place of a CT that is missing.
  void use(const scene::EyeView& eye, Vec3 centre_mm, GLuint without_ct) const;
  const GlProgram& shader() const { return program_; }
  /// From its middle to two of its sides, from the scene's centre.
  void draw(Vec3 middle_mm, Vec3 across_mm, Vec3 along_mm) const;

 private:
  GlProgram program_;
  GlObject array_, corners_, ct_;
  scene::Mat4 to_ct_;
  grid::Lattice ct_lattice_;
};

}  // namespace trephine::render
