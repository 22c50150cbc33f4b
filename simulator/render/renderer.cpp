// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/splitmix64.h"
#include "render/memory.h"
#include "render/renderer_impl.h"

namespace trephine::render {
namespace {

void filter(GLenum target, GLint how, GLint wrap) {
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, how);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, how);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(target, axis, wrap);
}

void check_framebuffer() {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ExitCode::io, "", "OpenGL", "the driver refuses a picture of this size");
}

}  // namespace

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
      plane(shaders::plane_vertex, shaders::plane_fragment),
      box(shaders::box_vertex, shaders::box_fragment),
      openness(shaders::screen_vertex, shaders::openness_fragment),
      smoothing(shaders::screen_vertex, shaders::smooth_fragment),
      darkening(shaders::screen_vertex, shaders::darken_fragment),
      presenting(shaders::screen_vertex, shaders::present_fragment),
      shadow(shaders::shadow_vertex, shaders::box_fragment),
      kept(driver_facts().software) {
  const surface::Bounds& b = scene.bounds;
  radius_mm = norm(b.max_mm - b.min_mm) / 2 + norm((b.max_mm + b.min_mm) / 2 - centre_mm);
  samples = std::clamp(q.samples, 1, driver_facts().max_samples);
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
  plane_array = make_vertex_array();
  plane_corners = make_buffer();
  const float corners[] = {-1, -1, 1, -1, -1, 1, 1, 1};
  glBindVertexArray(plane_array);
  glBindBuffer(GL_ARRAY_BUFFER, plane_corners);
  glBufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  empty_array = make_vertex_array();
  make_noise();
  make_shadow_map();
  copies = copies_bytes();
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
  filter(GL_TEXTURE_3D, GL_LINEAR, GL_REPEAT);
}

void Renderer::Impl::upload_ct(const grid::Grid<std::int16_t>& grid) {
  ct = make_texture();
  glBindTexture(GL_TEXTURE_3D, ct);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R16_SNORM, grid.size[0], grid.size[1], grid.size[2], 0, GL_RED, GL_SHORT,
               grid.voxels.data());
  filter(GL_TEXTURE_3D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  check_gl("the CT");
  to_ct = to_texture(grid, centre_mm);
  ct_lattice = grid;
  has_ct = true;
}

void Renderer::Impl::make_targets(int w, int h) {
  if (w == width && h == height) return;
  width = w;
  height = h;
  const auto texture = [](GLenum format, int tw, int th, GLenum layout, GLenum type, GLint how) {
    GlObject t = make_texture();
    glBindTexture(GL_TEXTURE_2D, t);
    glTexImage2D(GL_TEXTURE_2D, 0, GLint(format), tw, th, 0, layout, type, nullptr);
    filter(GL_TEXTURE_2D, how, GL_CLAMP_TO_EDGE);
    return t;
  };
  one = make_framebuffer();
  one_colour = texture(GL_SRGB8_ALPHA8, w, h, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR);
  one_depth = texture(GL_DEPTH24_STENCIL8, w, h, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, one);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, one_colour, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_TEXTURE_2D, one_depth, 0);
  check_framebuffer();
  half = make_framebuffer();
  half_open = texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, half);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, half_open, 0);
  check_framebuffer();
  half_too = make_framebuffer();
  half_smooth = texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE, GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, half_too);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, half_smooth, 0);
  check_framebuffer();
  if (samples > 1) {
    many = make_framebuffer();
    many_colour = make_renderbuffer();
    many_depth = make_renderbuffer();
    glBindRenderbuffer(GL_RENDERBUFFER, many_colour);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_SRGB8_ALPHA8, w, h);
    glBindRenderbuffer(GL_RENDERBUFFER, many_depth);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH24_STENCIL8, w, h);
    glBindFramebuffer(GL_FRAMEBUFFER, many);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, many_colour);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, many_depth);
    check_framebuffer();
  }
  check_gl("the picture");
}

Renderer::Renderer(const scene::SceneData& scene, const RenderQuality& quality) : impl_(new Impl(scene, quality)) {}
Renderer::~Renderer() = default;

void Renderer::set_quality(const RenderQuality& quality) {
  impl_->quality = quality;
  const int samples = std::clamp(quality.samples, 1, driver_facts().max_samples);
  if (samples != impl_->samples) impl_->width = 0;
  impl_->samples = samples;
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
void Renderer::set_tool(const scene::Solid& solid) {
  impl_->tool = SolidBuffer(solid, true);
  double radius = 0, low = 0, high = 0;
  for (const scene::SolidVertex& v : solid.vertices) {
    radius = std::max(radius, double(std::hypot(v.position_mm[0], v.position_mm[1])));
    low = std::min(low, double(v.position_mm[2]));
    high = std::max(high, double(v.position_mm[2]));
  }
  impl_->tool_radius_mm = radius;
  impl_->tool_low_mm = low;
  impl_->tool_high_mm = high;
}
void Renderer::set_ct(const grid::Grid<std::int16_t>& ct) { impl_->upload_ct(ct); }
void Renderer::set_background(std::array<float, 3> linear_rgb) { impl_->background = linear_rgb; }

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
  filter(GL_TEXTURE_3D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  impl_->walls.push_back(std::move(wall));
  check_gl("an incision");
}

void Renderer::draw(const scene::EyeView& eye, const scene::SceneState& state, int width, int height) {
  impl_->kept.new_picture();
  impl_->make_targets(width, height);
  impl_->draw(eye, state, width, height);
  check_gl("a picture");
}

// Whether the driver copies the picture's bytes as they are, sRGB into a framebuffer that does not know of it. OpenGL
// says so, and some drivers were known not to.
bool Renderer::Impl::copies_bytes() {
  const GlObject from = make_framebuffer(), to = make_framebuffer();
  const GlObject source = make_renderbuffer(), target = make_renderbuffer();
  glBindRenderbuffer(GL_RENDERBUFFER, source);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_SRGB8_ALPHA8, 1, 1);
  glBindRenderbuffer(GL_RENDERBUFFER, target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
  glBindFramebuffer(GL_FRAMEBUFFER, to);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  glBindFramebuffer(GL_FRAMEBUFFER, from);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, source);
  glEnable(GL_FRAMEBUFFER_SRGB);
  const float half_lit[] = {0.5f, 0.5f, 0.5f, 1};
  glClearBufferfv(GL_COLOR, 0, half_lit);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  glBlitFramebuffer(0, 0, 1, 1, 0, 0, 1, 1, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, to);
  std::uint8_t pixel[4] = {};
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
  return pixel[0] >= 187 && pixel[0] <= 189;  // 0.5 as sRGB
}

void Renderer::present(int x, int y, int width, int height, int mask) {
  if (mask == 7 && impl_->copies) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->one);
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(0, 0, impl_->width, impl_->height, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT,
                      impl_->width == width && impl_->height == height ? GL_NEAREST : GL_LINEAR);
    GLint target = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(target));
    check_gl("the picture's copy");
    return;
  }
  glViewport(x, y, width, height);
  glDisable(GL_DEPTH_TEST);
  glColorMask(mask & 1, mask >> 1 & 1, mask >> 2 & 1, GL_TRUE);
  impl_->presenting.use();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, impl_->one_colour);
  impl_->presenting.set("picture", 0);
  glBindVertexArray(impl_->empty_array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  check_gl("the picture's copy");
}

std::size_t Renderer::drawn_triangles() const {
  std::size_t n = 0;
  for (const auto& [item, list] : impl_->lists) n += impl_->items[item].buffer->triangles(list);
  return n;
}

std::size_t Renderer::graphics_bytes() const {
  return scene_bytes() + picture_bytes(impl_->width, impl_->height, impl_->samples);
}

std::size_t Renderer::scene_bytes() const {
  std::size_t n = impl_->has_ct ? impl_->ct_lattice.count() * 2 : 0;
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
