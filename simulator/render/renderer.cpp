// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/splitmix64.h"
#include "render/renderer_impl.h"

namespace trephine {
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

Mat4 to_texture(const Lattice& lattice, Vec3 centre_mm) {
  Mat4 m;
  for (int r = 0; r < 3; ++r) {
    const Vec3 axis = lattice.direction.column[std::size_t(r)];
    const double scale = 1 / (lattice.spacing_mm[r] * lattice.size[std::size_t(r)]);
    for (int c = 0; c < 3; ++c) m.at(r, c) = float(axis[c] * scale);
    m.at(r, 3) = float(dot(axis, centre_mm - lattice.origin_mm) * scale + 0.5 / lattice.size[std::size_t(r)]);
  }
  return m;
}

Renderer::Impl::Impl(const SceneData& scene, const RenderQuality& q)
    : centre_mm(scene.centre_mm),
      quality(q),
      surface(shaders::surface_vertex, shaders::surface_fragment),
      plane(shaders::plane_vertex, shaders::plane_fragment),
      box(shaders::box_vertex, shaders::box_fragment),
      openness(shaders::screen_vertex, shaders::openness_fragment),
      darkening(shaders::screen_vertex, shaders::darken_fragment),
      presenting(shaders::screen_vertex, shaders::present_fragment) {
  const Bounds& b = scene.bounds;
  radius_mm = norm(b.max_mm - b.min_mm) / 2 + norm((b.max_mm + b.min_mm) / 2 - centre_mm);
  samples = std::clamp(q.samples, 1, driver_facts().most_samples);
  for (const SceneSurface& s : scene.surfaces) {
    Item item{
        {float(s.colour_rgb[0]), float(s.colour_rgb[1]), float(s.colour_rgb[2])}, s.live, s.incised, {}, {}, {}, {}};
    if (!s.live) item.buffer = std::make_unique<SurfaceBuffer>(s);
    items.push_back(std::move(item));
  }
  ball = SolidBuffer(ball_solid(1, {1, 1, 1}, 16), false);
  dot_solid = SolidBuffer(ball_solid(1, {1, 1, 1}, 3), false);
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

void Renderer::Impl::upload_ct(const Grid<std::int16_t>& grid) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  if (*std::max_element(grid.size.begin(), grid.size.end()) > most) return;  // the cut has the surface's colour then
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

Renderer::Renderer(const SceneData& scene, const RenderQuality& quality) : impl_(new Impl(scene, quality)) {}
Renderer::~Renderer() = default;

void Renderer::set_quality(const RenderQuality& quality) {
  impl_->quality = quality;
  const int samples = std::clamp(quality.samples, 1, driver_facts().most_samples);
  if (samples != impl_->samples) impl_->width = 0;
  impl_->samples = samples;
}

std::string Renderer::set_live(int n, const HapticVolume& volume, int shape, ViewParams::SurfaceBy by) {
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
void Renderer::set_tool(const Solid& solid) { impl_->tool = SolidBuffer(solid, true); }
void Renderer::set_ct(const Grid<std::int16_t>& ct) { impl_->upload_ct(ct); }
void Renderer::set_background(std::array<float, 3> linear_rgb) { impl_->background = linear_rgb; }

void Renderer::clear_incisions() { impl_->walls.clear(); }

void Renderer::add_incision(const IncisionWall& w) {
  if (impl_->walls.size() == most_incisions) impl_->walls.erase(impl_->walls.begin());
  Impl::Wall wall{w.ball, w.surface, make_texture(), to_texture(w.lattice, impl_->centre_mm), w.occupancy.size()};
  glBindTexture(GL_TEXTURE_3D, wall.occupancy);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R8, w.lattice.size[0], w.lattice.size[1], w.lattice.size[2], 0, GL_RED,
               GL_UNSIGNED_BYTE, w.occupancy.data());
  filter(GL_TEXTURE_3D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  impl_->walls.push_back(std::move(wall));
  check_gl("an incision");
}

void Renderer::draw(const EyeView& eye, const SceneState& state, int width, int height) {
  impl_->make_targets(width, height);
  impl_->draw(eye, state, width, height);
  check_gl("a picture");
}

void Renderer::present(int x, int y, int width, int height, int mask) {
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
Picture OffscreenPicture::read() {
  bind();
  return read_picture(impl_->width, impl_->height);
}

void bind_screen() { glBindFramebuffer(GL_FRAMEBUFFER, 0); }

Picture read_picture(int width, int height) {
  Picture p{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 3)};
  std::vector<std::uint8_t> upside_down(p.rgb.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  check_gl("reading a picture");
  const std::size_t row = std::size_t(width) * 3;
  for (std::size_t y = 0; y < std::size_t(height); ++y)
    std::memcpy(p.rgb.data() + y * row, upside_down.data() + (std::size_t(height) - 1 - y) * row, row);
  return p;
}

}  // namespace trephine
