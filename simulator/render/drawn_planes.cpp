// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/drawn_planes.h"

#include "render/renderer_impl.h"

namespace trephine::render {

DrawnPlanes::DrawnPlanes()
    : program_(shaders::plane_vertex, shaders::plane_fragment), array_(make_vertex_array()), corners_(make_buffer()) {
  const float places[] = {-1, -1, 1, -1, -1, 1, 1, 1};
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, sizeof places, places, GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void DrawnPlanes::set_ct(const grid::Grid<std::int16_t>& grid, Vec3 centre_mm) {
  ct_ = make_texture();
  glBindTexture(GL_TEXTURE_3D, ct_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R16_SNORM, grid.size[0], grid.size[1], grid.size[2], 0, GL_RED, GL_SHORT,
               grid.voxels.data());
  set_filter(GL_TEXTURE_3D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  check_gl("the CT");
  to_ct_ = to_texture(grid, centre_mm);
  ct_lattice_ = grid;
}

void DrawnPlanes::use(const scene::EyeView& eye, Vec3 centre_mm, GLuint without_ct) const {
  program_.use();
  program_.set("to_camera", eye.to_camera(centre_mm));
  program_.set("projection", eye.projection());
  program_.set("to_ct", to_ct_);
  program_.set("ct", 0);
  program_.set("encode", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, has_ct() ? GLuint(ct_) : without_ct);
}

void DrawnPlanes::draw(Vec3 middle, Vec3 across, Vec3 along) const {
  program_.set("middle", middle);
  program_.set("across", across);
  program_.set("along", along);
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace trephine::render
