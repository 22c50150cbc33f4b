// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/dust_texture.h"

#include <cmath>

#include "render/renderer_impl.h"

namespace trephine::render {

void DustTexture::take(const scene::SceneState& state, Vec3 centre_mm) {
  there_ = state.dust && state.dust->any();
  if (!there_) return;
  const scene::BoneDust& from = *state.dust;
  if (of_ == &from && version_ == from.version()) return;
  constexpr int n = scene::BoneDust::side;
  const std::vector<std::uint8_t> texels = from.texels();
  const bool made_before = GLuint(texture_) != 0;
  if (!made_before) texture_ = make_texture();
  glBindTexture(GL_TEXTURE_3D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (made_before) {
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, n, n, n, GL_RGB, GL_UNSIGNED_BYTE, texels.data());
  } else {
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGB8, n, n, n, 0, GL_RGB, GL_UNSIGNED_BYTE, texels.data());
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
  to_dust_ = to_texture(cells, centre_mm);
  middle_mm_ = from.first_mm() + cells.spacing_mm * (0.5 * (n - 1)) - centre_mm;
  of_ = &from;
  version_ = from.version();
}

void DustTexture::part(const PlacedChunks& placed, const std::vector<std::uint8_t>* seen) {
  const Vec3 middle = transpose_times(placed.axes, middle_mm_ - placed.offset_mm);
  const double half = 0.5 * scene::BoneDust::side * scene::BoneDust::cell_mm;
  Vec3 reach;  // of the dust's box along the surface's axes
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) reach[a] += half * std::abs(placed.axes.column[a][b]);
  near_it_.assign(placed.chunks.size(), 0);
  far_from_it_.assign(placed.chunks.size(), 0);
  for (std::size_t c = 0; c < placed.chunks.size(); ++c) {
    if (seen && !(*seen)[c]) continue;
    bool near = true;
    for (int a = 0; a < 3; ++a)
      near =
          near && placed.chunks[c].low[a] <= middle[a] + reach[a] && placed.chunks[c].high[a] >= middle[a] - reach[a];
    (near ? near_it_ : far_from_it_)[c] = 1;
  }
}

void DustTexture::set(const GlProgram& p) const {
  p.set("grains", 0);
  p.set("dust", 3);
  p.set("to_dust", to_dust_);
  glActiveTexture(GL_TEXTURE3);
  glBindTexture(GL_TEXTURE_3D, texture_);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace trephine::render
