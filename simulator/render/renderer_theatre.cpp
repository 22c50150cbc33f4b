// SPDX-License-Identifier: GPL-3.0-or-later
// The looks of an operating theatre: lamp, drapes, the skin's texture, and what is wet, bleeds or is covered with dust.
#include <cmath>

#include "render/renderer_impl.h"
#include "scene/bone_dust.h"

namespace trephine::render {
namespace {

constexpr float bump_mm = 0.22f;  // height of the skin's and the cloth's texture, as their shading says

}  // namespace

int Renderer::Impl::theatre_parts(const scene::SceneState& state) const {
  return !state.theatre ? 0 : shaders::theatre_part | (quality.grain ? shaders::grain_part : 0);
}

void Renderer::Impl::set_theatre(const GlProgram& p) const {
  const scene::TheatreField& field = *surface_state->theatre;
  const Vec3 at = relative(field.centre_mm);
  p.set("field", float(at.x), float(at.y), float(at.z), float(field.lamp_mm));
  p.set("bump_mm", bump_mm);
  const scene::CutBall wound = walls.empty() ? scene::CutBall{centre_mm, 0} : walls.back().ball;
  const Vec3 middle = relative(wound.centre_mm);
  p.set("wound", float(middle.x), float(middle.y), float(middle.z), float(wound.radius_mm));
}

void Renderer::Impl::set_tissue(bool skin, double wet) const {
  surface->set("open_mm", skin ? float(surface_state->theatre->open_mm) : 0.f);
  surface->set("wet", float(wet));
}

void Renderer::Impl::take_dust(const scene::SceneState& state) {
  dusty = state.dust && state.dust->any();
  if (!dusty) return;
  const scene::BoneDust& from = *state.dust;
  if (dust_of == &from && dust_version == from.version()) return;
  constexpr int n = scene::BoneDust::side;
  const std::vector<std::uint8_t> texels = from.texels();
  const bool made_before = GLuint(dust) != 0;
  if (!made_before) dust = make_texture();
  glBindTexture(GL_TEXTURE_3D, dust);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (made_before) {
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, n, n, n, GL_RG, GL_UNSIGNED_BYTE, texels.data());
  } else {
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RG8, n, n, n, 0, GL_RG, GL_UNSIGNED_BYTE, texels.data());
    const float none[4] = {0, 0, 0, 0};
    glTexParameterfv(GL_TEXTURE_3D, GL_TEXTURE_BORDER_COLOR, none);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }
  grid::Lattice cells;
  cells.size = {n, n, n};
  cells.spacing_mm = Vec3{1, 1, 1} * scene::BoneDust::cell_mm;
  cells.origin_mm = from.first_mm();
  to_dust = to_texture(cells, centre_mm);
  dust_middle_mm = relative(from.first_mm() + cells.spacing_mm * (0.5 * (n - 1)));
  dust_of = &from;
  dust_version = from.version();
}

void Renderer::Impl::part_by_dust(std::size_t n, const std::vector<std::uint8_t>* seen) {
  if (!items[n].buffer) return;
  const PlacedChunks& placed = items[n].buffer->placed();
  const Vec3 middle = transpose_times(placed.axes, dust_middle_mm - placed.offset_mm);
  const double half = 0.5 * scene::BoneDust::side * scene::BoneDust::cell_mm;
  Vec3 reach;  // of the dust's box along the surface's axes
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) reach[a] += half * std::abs(placed.axes.column[a][b]);
  near_dust.assign(placed.chunks.size(), 0);
  far_from_dust.assign(placed.chunks.size(), 0);
  for (std::size_t c = 0; c < placed.chunks.size(); ++c) {
    if (seen && !(*seen)[c]) continue;
    bool near = true;
    for (int a = 0; a < 3; ++a)
      near =
          near && placed.chunks[c].low[a] <= middle[a] + reach[a] && placed.chunks[c].high[a] >= middle[a] - reach[a];
    (near ? near_dust : far_from_dust)[c] = 1;
  }
}

void Renderer::Impl::set_dust(const GlProgram& p) const {
  p.set("grains", 0);
  p.set("dust", 3);
  p.set("to_dust", to_dust);
  glActiveTexture(GL_TEXTURE3);
  glBindTexture(GL_TEXTURE_3D, dust);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace trephine::render
