// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/splitmix64.h"
#include "render/renderer_impl.h"

namespace trephine::render {
scene::Mat4 to_texture(const grid::Lattice& lattice, Vec3 centre_mm) {
  scene::Mat4 m;
  for (int r = 0; r < 3; ++r) {
    const Vec3 axis = lattice.direction.column[std::size_t(r)];
    const double scale = 1 / (lattice.spacing_mm[r] * lattice.size[std::size_t(r)]);
    for (int c = 0; c < 3; ++c) m.at(r, c) = float(axis[c] * scale);
    m.at(r, 3) = float(dot(axis, centre_mm - lattice.origin_mm) * scale + 0.5 / lattice.size[std::size_t(r)]);
  }
  return m;
}

Renderer::Impl::Impl(const scene::SceneData& scene, const RenderQuality& q)
    : centre_mm(scene.centre_mm),
      quality(q),
      box(shaders::box_vertex, shaders::box_fragment),
      kept(driver_facts().software) {
  const surface::Bounds& b = scene.bounds;
  radius_mm = norm(b.max_mm - b.min_mm) / 2 + norm((b.max_mm + b.min_mm) / 2 - centre_mm);
  targets.set_samples(q.samples);
  for (const scene::SceneSurface& s : scene.surfaces) {
    Item item{{float(s.colour_rgb[0]), float(s.colour_rgb[1]), float(s.colour_rgb[2])},
              s.live,
              s.incised,
              s.skin,
              {},
              {},
              {},
              {}};
    if (!s.live) item.buffer = std::make_unique<SurfaceBuffer>(std::make_shared<const SurfaceParts>(parts_of(s)));
    items.push_back(std::move(item));
  }
  ball = SolidBuffer(scene::ball_solid(1, {1, 1, 1}, 16), false);
  dot_solid = SolidBuffer(scene::ball_solid(1, {1, 1, 1}, 3), false);
  empty_array = make_vertex_array();
  make_noise();
  check_gl("the renderer");
}

Renderer::Impl::~Impl() {
  for (Item& item : items) glDeleteQueries(GLsizei(item.queries.size()), item.queries.data());
}

// Smooth noise that repeats: the grain of a surface without a texture of its own.
void Renderer::Impl::make_noise() {
  constexpr int n = 32;
  std::vector<std::uint8_t> values(n * n * n);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = std::uint8_t(splitmix64_mixed((i + 1) * splitmix64_step) >> 56);
  noise = make_texture();
  glBindTexture(GL_TEXTURE_3D, noise);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R8, n, n, n, 0, GL_RED, GL_UNSIGNED_BYTE, values.data());
  set_filter(GL_TEXTURE_3D, GL_LINEAR, GL_REPEAT);
}

Renderer::Renderer(const scene::SceneData& scene, const RenderQuality& quality) : impl_(new Impl(scene, quality)) {}
Renderer::~Renderer() = default;

void Renderer::set_quality(const RenderQuality& quality) {
  impl_->quality = quality;
  impl_->targets.set_samples(quality.samples);
}

void Renderer::set_surface(int n, std::shared_ptr<const SurfaceParts> shown) {
  impl_->items[std::size_t(n)].buffer = std::make_unique<SurfaceBuffer>(std::move(shown));
}

std::shared_ptr<const SurfaceParts> Renderer::parts(int n) const {
  const Impl::Item& item = impl_->items[std::size_t(n)];
  return item.buffer ? item.buffer->parts() : nullptr;
}

void Renderer::set_coarse(int n, std::optional<CoarseParts> coarse, bool keep_those_before) {
  if (const auto& buffer = impl_->items[std::size_t(n)].buffer)
    buffer->set_coarse(std::move(coarse), keep_those_before);
}

bool Renderer::upload_coarse(std::size_t max_bytes) {
  for (const Impl::Item& item : impl_->items)
    if (item.buffer && item.buffer->upload_coarse(max_bytes)) return true;
  return false;
}

std::size_t Renderer::coarse_bytes() const {
  std::size_t n = 0;
  for (const Impl::Item& item : impl_->items) n += item.buffer ? item.buffer->coarse_bytes() : 0;
  return n;
}

std::string Renderer::set_live(int n, const voxel::HapticVolume& volume, int shape, scene::ViewParams::SurfaceBy by) {
  MakerChoice choice;
  auto maker = wanted_maker(by, driver_facts().software, volume, shape, impl_->centre_mm, choice);
  Impl::Item& item = impl_->items[std::size_t(n)];
  item.maker = maker.get();
  item.buffer = std::move(maker);
  return choice.text();
}
std::size_t Renderer::follow(const std::vector<std::size_t>& marked) {
  std::size_t made = 0;
  for (Impl::Item& item : impl_->items)
    if (item.maker) made += item.maker->update(marked);
  return made;
}
void Renderer::set_tool(const scene::Solid& solid, bool second) {
  (second ? impl_->second_tool : impl_->tool) = SolidBuffer(solid, true);
  if (!second) impl_->shadow.set_tool(solid);
}
void Renderer::set_ct(const grid::Grid<std::int16_t>& ct) { impl_->planes.set_ct(ct, impl_->centre_mm); }
void Renderer::set_background(std::array<float, 3> linear_rgb) { impl_->background = linear_rgb; }

VolumeRays& Renderer::rays() { return impl_->rays; }

int Renderer::max_ct_side() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  return most;
}

std::size_t Renderer::incisions() const { return impl_->walls.size(); }
void Renderer::clear_incisions() { impl_->walls.clear(); }
void Renderer::drop_oldest_incision() {
  if (!impl_->walls.empty()) impl_->walls.erase(impl_->walls.begin());
}

void Renderer::add_incision(const IncisionWall& w) {
  if (impl_->walls.size() == max_incisions) impl_->walls.erase(impl_->walls.begin());
  Impl::Wall wall{w.ball, w.surface, make_texture(), to_texture(w.lattice, impl_->centre_mm), w.occupancy.size()};
  glBindTexture(GL_TEXTURE_3D, wall.occupancy);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R8, w.lattice.size[0], w.lattice.size[1], w.lattice.size[2], 0, GL_RED,
               GL_UNSIGNED_BYTE, w.occupancy.data());
  set_filter(GL_TEXTURE_3D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  impl_->walls.push_back(std::move(wall));
  check_gl("an incision");
}

void Renderer::draw(const scene::EyeView& eye, const scene::SceneState& state, int width, int height) {
  impl_->kept.new_picture();
  impl_->targets.make(width, height);
  impl_->draw(eye, state, width, height);
  check_gl("a picture");
}

void Renderer::present(int x, int y, int width, int height, int mask) {
  impl_->targets.present(x, y, width, height, mask);
}

std::size_t Renderer::drawn_triangles() const {
  std::size_t n = 0;
  for (const auto& [item, list] : impl_->lists) n += impl_->items[item].buffer->triangles(list);
  return n;
}

std::size_t Renderer::graphics_bytes() const { return scene_bytes() + impl_->targets.bytes(); }

std::size_t Renderer::scene_bytes() const {
  std::size_t n = impl_->planes.ct_bytes() + (impl_->rays.pass ? impl_->rays.pass->bytes() : 0);
  for (const Impl::Item& item : impl_->items) n += item.buffer ? item.buffer->bytes() : 0;
  for (const Impl::Wall& wall : impl_->walls) n += wall.bytes;
  return n;
}

struct OffscreenPicture::Impl {
  int width, height;
  GlObject frame, colour;
};

OffscreenPicture::OffscreenPicture(int width, int height)
    : impl_(new Impl{width, height, make_framebuffer(), make_renderbuffer()}) {
  glBindRenderbuffer(GL_RENDERBUFFER, impl_->colour);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  bind();
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, impl_->colour);
  check_framebuffer();
}
OffscreenPicture::~OffscreenPicture() = default;
void OffscreenPicture::bind() { glBindFramebuffer(GL_FRAMEBUFFER, impl_->frame); }
scene::Picture OffscreenPicture::read() {
  bind();
  return read_picture(impl_->width, impl_->height);
}

void bind_screen(Eye eye) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDrawBuffer(eye == Eye::left ? GL_BACK_LEFT : eye == Eye::right ? GL_BACK_RIGHT : GL_BACK);
}

scene::Picture read_picture(int width, int height) {
  scene::Picture p{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 3)};
  std::vector<std::uint8_t> upside_down(p.rgb.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  check_gl("reading a picture");
  const std::size_t row = std::size_t(width) * 3;
  for (std::size_t y = 0; y < std::size_t(height); ++y)
    std::memcpy(p.rgb.data() + y * row, upside_down.data() + (std::size_t(height) - 1 - y) * row, row);
  return p;
}

}  // namespace trephine::render
