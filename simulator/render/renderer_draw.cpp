// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "haptics/tool.h"
#include "render/renderer_impl.h"

namespace trephine::render {
namespace {

constexpr float grain_of_surface = 0.35f;

void set_colour(const std::array<float, 3>& srgb) {
  glVertexAttrib3f(2, linear_of(srgb[0]), linear_of(srgb[1]), linear_of(srgb[2]));
}

Mat3 scaled(double by) {
  Mat3 axes;
  for (Vec3& column : axes.column) column = column * by;
  return axes;
}

}  // namespace

void Renderer::Impl::set_balls(const GlProgram& program, bool any) const {
  const int count = any ? int(walls.size()) : 0;
  program.set("balls", count);
  for (int n = 0; n < count; ++n) {
    const scene::CutBall& b = walls[std::size_t(n)].ball;
    const Vec3 p = relative(b.centre_mm);
    const std::string name = "ball[" + std::to_string(n) + "]";
    program.set(name.c_str(), float(p.x), float(p.y), float(p.z), float(b.radius_mm));
  }
}

void Renderer::Impl::begin_surface(const scene::EyeView& eye, const scene::SceneState& state, bool cut) {
  begun.reset();
  surface_eye = &eye;
  surface_state = &state;
  surface_cut = cut && state.cut;
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_3D, noise);
}

void Renderer::Impl::surface_with(int parts) {
  using namespace shaders;
  if (labelling) parts = (parts & (balls_part | wall_part)) | label_part;
  GlProgram& p = surfaces[parts];
  surface = &p;
  const std::size_t number = std::size_t(parts);
  if (!made[number]) {
    static const std::pair<int, const char*> names[] = {
        {grain_part, "GRAIN"},   {glow_part, "GLOW"},       {balls_part, "BALLS"}, {wall_part, "WALL"},
        {shadow_part, "SHADOW"}, {theatre_part, "THEATRE"}, {dust_part, "DUST"},   {label_part, "LABEL"}};
    std::string source = fmt::format("#version 430 core\n#define KEY_LIGHT vec3({:.9f}, {:.9f}, {:.9f})\n",
                                     key_light[0], key_light[1], key_light[2]);
    for (const auto& [part, name] : names)
      if (parts & part) source += std::string("#define ") + name + "\n";
    p = GlProgram((source + surface_vertex).c_str(), (source + surface_fragment).c_str());
    made.set(number);
  }
  p.use();
  if (begun[number]) return;
  begun.set(number);
  // What is the same for all that this program draws in this picture.
  const scene::SceneState& state = *surface_state;
  p.set("to_camera", surface_eye->to_camera(centre_mm));
  p.set("projection", surface_eye->projection());
  if (surface_cut) {
    const Vec3 n = normalized(state.cut->normal);
    p.set("clip", float(n.x), float(n.y), float(n.z), float(dot(n, relative(state.cut->point_mm))));
  } else {
    p.set("clip", 0.f, 0.f, 0.f, 1.f);
  }
  if (parts & grain_part) {
    p.set("noise", 0);
    p.set("grain", grain_of_surface);
  }
  if (parts & wall_part) p.set("occupancy", 1);
  if (parts & theatre_part) set_theatre(p);
  if (parts & dust_part) dust.set(p);
  if (parts & shadow_part) shadow.receive(p);
  if (parts & glow_part) {
    p.set("glow_colour", 0.05f, 0.55f, 0.9f);
    p.set("glow", float(0.25 + 0.65 * std::clamp(state.contact_strength, 0.0, 1.0)));
    p.set("glow_place", relative(*state.contact_mm));
  }
}

void Renderer::Impl::draw_surface(std::size_t n, Sight::Faces faces, const std::vector<std::uint8_t>* seen) {
  if (!items[n].buffer) return;  // a live surface that nobody has set
  sight.faces = faces;
  lists.emplace_back(n, DrawList());
  items[n].buffer->list(sight, seen, lists.back().second);
  items[n].buffer->draw(lists.back().second);
}

// Which chunks of a surface are hidden behind what was drawn: the driver tests their boxes against the depth.
void Renderer::Impl::ask_hidden(std::size_t n, const scene::EyeView& eye) {
  Item& item = items[n];
  if (!item.buffer) return;
  const std::vector<Chunk>& chunks = item.buffer->placed().chunks;
  item.seen.assign(chunks.size(), 0);
  if (item.queries.size() < chunks.size()) {
    const std::size_t had = item.queries.size();
    item.queries.resize(chunks.size());
    glGenQueries(GLsizei(chunks.size() - had), item.queries.data() + had);
  }
  const Sight s = item.buffer->placed().sight(sight);
  box.use();
  box.set("model", item.buffer->placed().model);
  box.set("to_camera", eye.to_camera(centre_mm));
  box.set("projection", eye.projection());
  glBindVertexArray(empty_array);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDepthMask(GL_FALSE);
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CULL_FACE);
  std::vector<std::size_t> asked;
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    if (!may_be_seen(chunks[c], s)) continue;
    const Vec3 room{0.5, 0.5, 0.5}, low = chunks[c].low - room, high = chunks[c].high + room;
    double away = 0;  // of the eye from the box, per axis; what the near plane may cut is not asked for
    for (int a = 0; a < 3; ++a) away = std::max({away, low[a] - s.eye[a], s.eye[a] - high[a]});
    if (away < 2 * eye.near_mm) {
      item.seen[c] = 1;
      continue;
    }
    asked.push_back(c);
    box.set("low", low);
    box.set("high", high);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, item.queries[c]);
    glDrawArrays(GL_TRIANGLES, 0, 36);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
  }
  kept.after_pass();  // reading a result ends one
  for (const std::size_t c : asked) {
    GLuint any = 1;
    glGetQueryObjectuiv(item.queries[c], GL_QUERY_RESULT, &any);
    item.seen[c] = any != 0;
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
}

void Renderer::Impl::use_surface(std::size_t n, const scene::SceneState& state, double opacity, bool near_dust) {
  using namespace shaders;
  const Item& item = items[n];
  surface_with((item.skin && quality.grain ? grain_part : 0) | (item.incised && !walls.empty() ? balls_part : 0) |
               (state.contact_mm ? glow_part : 0) | (shadow.casts_any() ? shadow_part : 0) |
               (dust.any() && near_dust ? dust_part : 0) | theatre_parts(state));
  if (state.theatre) set_tissue(item.skin, item.skin ? 0.1 : 1);
  surface->set("model", item.buffer ? item.buffer->placed().model : scene::Mat4());
  surface->set("opacity", float(opacity));
  surface->set("label", int(n) + 1);
  if (item.incised && !walls.empty()) set_balls(*surface, true);
  set_colour(item.colour_rgb);
}

void Renderer::Impl::draw_opaque(const scene::EyeView& eye, const scene::SceneState& state) {
  bool first = true;
  for (std::size_t n = 0; n < items.size() && n < state.opacity.size(); ++n) {
    if (state.opacity[n] < 1) continue;
    // Inner sides are seen only through a cut or an incision.
    const bool both = state.cut || (items[n].incised && !walls.empty());
    const bool ask = !first && quality.ask_hidden;
    if (ask) ask_hidden(n, eye);
    first = false;
    if (state.cut) glEnable(GL_CLIP_DISTANCE0);
    if (both)
      glDisable(GL_CULL_FACE);
    else
      glEnable(GL_CULL_FACE);
    const Sight::Faces faces = both ? Sight::Faces::both : Sight::Faces::front;
    const std::vector<std::uint8_t>* seen = ask ? &items[n].seen : nullptr;
    if (dust.any() && items[n].buffer) dust.part(items[n].buffer->placed(), seen);
    use_surface(n, state, 1);
    draw_surface(n, faces, dust.any() ? &dust.near() : seen);
    if (!dust.any()) continue;
    // The rest of it is drawn without: a processor that draws takes as long for what there is no dust on.
    sight.loose = false;
    use_surface(n, state, 1, false);
    draw_surface(n, faces, &dust.elsewhere());
    sight.loose = true;
  }
  glDisable(GL_CULL_FACE);
}

void Renderer::Impl::draw_walls(const scene::SceneState& state) {
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  for (std::size_t n = 0; n < walls.size(); ++n) {
    const Wall& wall = walls[n];
    const std::size_t s = std::size_t(wall.surface);
    if (s >= state.opacity.size() || state.opacity[s] <= 0) continue;
    surface_with(shaders::wall_part | shaders::balls_part | (quality.grain ? shaders::grain_part : 0) |
                 (state.contact_mm ? shaders::glow_part : 0) | (shadow.casts_any() ? shaders::shadow_part : 0) |
                 (dust.any() ? shaders::dust_part : 0) | theatre_parts(state));
    if (state.theatre) set_tissue(false, 1);
    surface->set("model", scene::affine(scaled(wall.ball.radius_mm), relative(wall.ball.centre_mm)));
    surface->set("opacity", 1.f);
    surface->set("label", wall.surface + 1);
    surface->set("wall_ball", int(n));
    surface->set("to_occupancy", wall.to_occupancy);
    set_balls(*surface, true);
    const std::array<float, 3>& c = items[s].colour_rgb;
    set_colour({c[0], c[1] * 0.62f, c[2] * 0.6f});  // what lies under the surface is redder
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_3D, wall.occupancy);
    ball.draw();
  }
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
}

void Renderer::Impl::draw_solid_at(const SolidBuffer& solid, Vec3 place_mm, const Mat3& axes, double opacity) {
  surface_with(0);  // nor does the tool receive its own shadow
  surface->set("model", scene::affine(axes, relative(place_mm)));
  surface->set("opacity", float(opacity));
  surface->set("label", int(items.size()) + 1);  // the tool is the only one of them that has a label
  solid.draw();
}

void Renderer::Impl::draw_markers(const scene::SceneState& state, double opacity) {
  for (const auto* all : {&state.markers, &state.moving})
    for (const scene::Marker& m : *all) {
      set_colour(m.colour_rgb);
      draw_solid_at(ball, m.position_mm, scaled(m.radius_mm), opacity);
    }
}

void Renderer::Impl::draw_tools(const scene::SceneState& state) {
  if (state.tool_shown) draw_solid_at(tool, state.tip_mm, haptics::frame_along(state.axis), 1);
  if (state.second_shown) draw_solid_at(second_tool, state.second_tip_mm, haptics::frame_along(state.second_axis), 1);
}

void Renderer::Impl::draw_solids(const scene::SceneState& state) {
  glEnable(GL_CULL_FACE);
  draw_markers(state, 1);
  const auto dots = [&](const std::vector<Vec3>& places, const std::array<float, 3>& colour, double radius_mm = 0.35) {
    set_colour(colour);
    for (const Vec3 p : places) draw_solid_at(dot_solid, p, scaled(radius_mm), 1);
  };
  dots(state.trace_mm, {0.95f, 0.35f, 0.1f});
  dots(state.ghost_mm, {0.1f, 0.85f, 0.55f});
  dots(state.ink_mm, {0.12f, 0.25f, 0.85f}, 0.9);
  draw_tools(state);
  for (const scene::Marker& drop : state.drops) {
    set_colour(drop.colour_rgb);
    draw_solid_at(ball, drop.position_mm, scaled(drop.radius_mm), 1);
  }
  glDisable(GL_CULL_FACE);
}

// What lies behind surfaces shines through faintly: markers, and where the hand is while a surface holds the tool.
void Renderer::Impl::draw_ghost(const scene::SceneState& state) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glEnable(GL_CULL_FACE);
  glDepthFunc(GL_GREATER);
  draw_markers(state, 0.25);
  glDepthFunc(GL_LESS);
  if (state.device_mm && state.tool_shown) {
    glDisable(GL_DEPTH_TEST);
    set_colour({0.95f, 0.3f, 0.2f});
    draw_solid_at(ball, *state.device_mm, scaled(0.8), 0.6);
    glEnable(GL_DEPTH_TEST);
  }
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void Renderer::Impl::draw_transparent(const scene::SceneState& state) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glEnable(GL_CULL_FACE);
  const auto one = [&](std::size_t n, GLenum hidden) {
    if (n >= state.opacity.size() || state.opacity[n] <= 0 || state.opacity[n] >= 1) return;
    glCullFace(hidden);
    use_surface(n, state, state.opacity[n]);
    draw_surface(n, hidden == GL_FRONT ? Sight::Faces::back : Sight::Faces::front);
  };
  for (std::size_t n = 0; n < items.size(); ++n) one(n, GL_FRONT);
  for (std::size_t n = items.size(); n-- > 0;) one(n, GL_BACK);
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

void Renderer::Impl::draw(const scene::EyeView& eye, const scene::SceneState& state, int w, int h) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_CLIP_DISTANCE0);
  dust.take(state, centre_mm);
  shadow.cast(tool, eye, state, centre_mm, quality.shadow_taps);
  if (shadow.casts_any()) kept.after_pass();
  glBindFramebuffer(GL_FRAMEBUFFER, targets.frame());
  glViewport(0, 0, w, h);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_BLEND);
  glFrontFace(GL_CCW);
  glCullFace(GL_BACK);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glClearColor(background[0], background[1], background[2], 1);
  glClearStencil(0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  if (state.cut) glEnable(GL_CLIP_DISTANCE0);
  sight = sight_of(eye, state, centre_mm);
  lists.clear();
  begin_surface(eye, state);
  // Coarse and whole triangles would not close a cut, and would be seen double through each other.
  sight.coarse = quality.coarse.within_mm > 0 && !state.cut;
  sight.near = relative(state.tip_mm);
  sight.fine_mm = state.tool_shown ? quality.coarse.fine_mm : -1e6;
  draw_opaque(eye, state);
  sight.coarse = false;
  draw_walls(state);
  draw_room(state);
  if (state.cut) draw_caps(eye, state);
  glDisable(GL_CLIP_DISTANCE0);
  draw_ct_planes(eye, state);
  // Mesa's llvmpipe clips by the shader's distance even where that is switched off, so the distance itself must say no.
  begin_surface(eye, state, false);
  draw_solids(state);
  if (quality.occlusion) targets.darken(eye, quality.occlusion_mm, kept);
  if (rays.pass) rays.pass->draw(targets, kept, eye, state, w, h, quality.cast_ms);
  if (state.cut) glEnable(GL_CLIP_DISTANCE0);
  begin_surface(eye, state);
  draw_transparent(state);
  glDisable(GL_CLIP_DISTANCE0);
  begin_surface(eye, state, false);
  draw_ghost(state);
  kept.after_pass();
  targets.resolve(GL_COLOR_BUFFER_BIT, kept);
  glDisable(GL_FRAMEBUFFER_SRGB);
}

}  // namespace trephine::render
