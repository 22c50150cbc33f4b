// SPDX-License-Identifier: GPL-3.0-or-later
// The looks of an operating theatre: lamp, drapes, the skin's texture, and what is wet or bleeds.
#include "render/renderer_impl.h"
#include "scene/room.h"

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

void Renderer::Impl::draw_room(const scene::SceneState& state) {
  if (!state.theatre || !state.room || state.cut || labelling) return;
  if (shown_room != state.room) {
    shown_room = state.room;
    room = SolidBuffer(shown_room->solid, true);
  }
  glEnable(GL_CULL_FACE);
  surface_with(shaders::theatre_part);  // without a texture, which costs most of a pixel
  set_tissue(false, 0);
  surface->set("model", scene::Mat4());
  surface->set("opacity", 1.f);
  room.draw();
  glDisable(GL_CULL_FACE);
}

}  // namespace trephine::render
