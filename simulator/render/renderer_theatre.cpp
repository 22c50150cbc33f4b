// SPDX-License-Identifier: GPL-3.0-or-later
// The looks of an operating theatre: lamp, drapes, the skin's texture, and what is wet or bleeds.
#include "render/renderer_impl.h"

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

}  // namespace trephine::render
