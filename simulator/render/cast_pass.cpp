// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/cast_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "render/context.h"
#include "render/renderer_impl.h"

namespace trephine::render {
namespace {

constexpr double least_scale = 0.2, moving_step = 2;  // of a picture's sides; of a whole picture's step
constexpr int table_row = 1024;

std::string definitions(bool shapes) {
  return fmt::format(
      "#version 430 core\n{}#define FULL {}u\n#define SHAPE_HU {:.1f}\n#define KEY_LIGHT vec3({:.9f}, {:.9f}, "
      "{:.9f})\n#define TABLE_LOW ({:.1f})\n#define "
      "TABLE_COUNT "
      "{}\n#define BRICK {:.1f}\n#define UNLIT {:.1f}\n#define HALVINGS {}\n#define CUT_STEPS {:.1f}\n#define LEAST "
      "{:.6f}\n",
      shapes ? "#define SHAPES\n" : "", voxel::haptic_full, cast::shape_hu, scene::key_light[0], scene::key_light[1],
      scene::key_light[2], double(cast::CastTable::low_hu), cast::CastTable::count, double(cast::CastBricks::side),
      cast::unlit_hu_per_mm, cast::halvings, cast::cut_steps, cast::least_light);
}

bool equal(const Vec3& a, const Vec3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// A linear map of directions.
scene::Mat4 map_of(const std::array<Vec3, 3>& columns) {
  Mat3 m;
  for (std::size_t c = 0; c < 3; ++c) m.column[c] = columns[c];
  return scene::affine(m, {});
}

GlObject target_texture(GLenum format, GLenum layout, int w, int h, GLint how) {
  GlObject t = make_texture();
  glBindTexture(GL_TEXTURE_2D, t);
  glTexImage2D(GL_TEXTURE_2D, 0, GLint(format), w, h, 0, layout, GL_FLOAT, nullptr);
  set_filter(GL_TEXTURE_2D, how, GL_CLAMP_TO_EDGE);
  return t;
}

}  // namespace

CastPass::CastPass(const grid::Lattice& lattice, bool shapes)
    : lattice_(lattice),
      casting_(shaders::screen_vertex, (definitions(shapes) + shaders::cast_fragment).c_str()),
      over_(shaders::screen_vertex, (definitions(false) + shaders::cast_over_fragment).c_str()),
      depth_(shaders::screen_vertex, (definitions(false) + "#define DEPTH\n" + shaders::cast_over_fragment).c_str()),
      empty_array_(make_vertex_array()),
      voxels_texture_(make_texture()),
      bricks_texture_(make_texture()),
      table_texture_(make_texture()) {
  if (const int most = *std::max_element(lattice.size.begin(), lattice.size.end()); most > Renderer::max_ct_side())
    throw Error(ExitCode::io, "", "cast",
                fmt::format("the volume has {} voxels along a side, the graphics driver takes {}", most,
                            Renderer::max_ct_side()));
  glBindTexture(GL_TEXTURE_3D, voxels_texture_);
  glTexImage3D(GL_TEXTURE_3D, 0, shapes ? GL_RGBA8UI : GL_R16_SNORM, lattice.size[0], lattice.size[1], lattice.size[2],
               0, shapes ? GL_RGBA_INTEGER : GL_RED, shapes ? GL_UNSIGNED_BYTE : GL_SHORT, nullptr);
  set_filter(GL_TEXTURE_3D, shapes ? GL_NEAREST : GL_LINEAR, GL_CLAMP_TO_EDGE);
}

CastPass::CastPass(const grid::Grid<std::int16_t>& voxels, cast::CastTable table) : CastPass(voxels, false) {
  hu_ = &voxels;
  set_table(std::move(table));
  follow(grid::whole_box(voxels));
  check_gl("a volume");
}

CastPass::CastPass(const cast::CastShapes& shapes) : CastPass(shapes.voxels(), true) {
  shapes_ = &shapes;
  follow_opacities();
  follow(grid::whole_box(lattice_));
  check_gl("a volume");
}

void CastPass::set_table(cast::CastTable table) {
  table_ = std::move(table);
  upload_table(table_row, cast::CastTable::count / table_row, table_.entries().data());
  if (bricks_.clear.empty())
    bricks_ = cast::CastBricks(*hu_, table_);
  else
    bricks_.look(table_);
  upload_bricks();
}

void CastPass::follow_opacities() {
  upload_table(cast::CastShapes::count, 1, shapes_->entries().data());
  bricks_ = cast::CastBricks(*shapes_);
  upload_bricks();
}

void CastPass::upload_table(int width, int height, const cast::CastTable::Entry* entries) {
  glBindTexture(GL_TEXTURE_2D, table_texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, entries);
  set_filter(GL_TEXTURE_2D, GL_NEAREST, GL_CLAMP_TO_EDGE);
}

void CastPass::upload_bricks() {
  glBindTexture(GL_TEXTURE_3D, bricks_texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage3D(GL_TEXTURE_3D, 0, GL_R8, bricks_.size[0], bricks_.size[1], bricks_.size[2], 0, GL_RED, GL_UNSIGNED_BYTE,
               bricks_.clear.data());
  set_filter(GL_TEXTURE_3D, GL_NEAREST, GL_CLAMP_TO_EDGE);
  changed_ = true;
}

template <class Voxel, class Read>
void CastPass::upload_voxels(const grid::Box& box, GLenum layout, GLenum kind, const Read& read) {
  std::vector<Voxel> part;
  const int size[3] = {box.end[0] - box.begin[0], box.end[1] - box.begin[1], box.end[2] - box.begin[2]};
  glBindTexture(GL_TEXTURE_3D, voxels_texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (int k = box.begin[2]; k < box.end[2]; ++k) {
    part.clear();
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) part.push_back(read(lattice_.index(i, j, k)));
    glTexSubImage3D(GL_TEXTURE_3D, 0, box.begin[0], box.begin[1], k, size[0], size[1], 1, layout, kind, part.data());
  }
}

void CastPass::follow(const grid::Box& changed) {
  const grid::Box box = grid::grown(changed, 0, lattice_);
  if (box.empty()) return;
  if (hu_) {
    upload_voxels<std::int16_t>(box, GL_RED, GL_SHORT, [&](std::size_t n) {  // a servo loop may be cutting
      return __atomic_load_n(&hu_->voxels[n], __ATOMIC_RELAXED);
    });
    bricks_.look(*hu_, table_, box);
  } else {
    upload_voxels<cast::CastShapes::Voxel>(box, GL_RGBA_INTEGER, GL_UNSIGNED_BYTE,
                                           [&](std::size_t n) { return shapes_->voxels().voxels[n]; });
    bricks_.look(*shapes_, box);
  }
  upload_bricks();
}

std::size_t CastPass::bytes() const {
  return lattice_.count() * (hu_ ? sizeof(std::int16_t) : sizeof(cast::CastShapes::Voxel)) + bricks_.clear.size() +
         table_.entries().size() * sizeof(cast::CastTable::Entry) + std::size_t(width_) * std::size_t(height_) * 12;
}

bool CastPass::same(const Sight& a, const Sight& b) {
  const auto cut = [](const Sight& s) { return s.cut.value_or(scene::CutPlane{{}, {}}); };
  const auto box = [](const Sight& s) { return s.box.value_or(surface::Bounds{}); };
  return a.width == b.width && a.height == b.height && equal(a.eye.eye_mm, b.eye.eye_mm) &&
         equal(a.eye.right, b.eye.right) && equal(a.eye.up, b.eye.up) && equal(a.eye.toward, b.eye.toward) &&
         a.eye.left == b.eye.left && a.eye.right_edge == b.eye.right_edge && a.eye.bottom == b.eye.bottom &&
         a.eye.top == b.eye.top && a.cut.has_value() == b.cut.has_value() && equal(cut(a).point_mm, cut(b).point_mm) &&
         equal(cut(a).normal, cut(b).normal) && a.box.has_value() == b.box.has_value() &&
         equal(box(a).min_mm, box(b).min_mm) && equal(box(a).max_mm, box(b).max_mm) && a.opacity == b.opacity &&
         a.tool == b.tool && (!a.tool || (norm(a.tip_mm - b.tip_mm) < 0.05 && norm(a.axis - b.axis) < 0.002));
}

void CastPass::make_target(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  frame_ = make_framebuffer();
  colour_ = target_texture(GL_RGBA16F, GL_RGBA, width, height, GL_LINEAR);
  hides_ = target_texture(GL_R32F, GL_RED, width, height, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour_, 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, hides_, 0);
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both);
  check_framebuffer();
}

void CastPass::draw(const PictureTargets& targets, KeptFences& kept, const scene::EyeView& eye,
                    const scene::SceneState& state, int width, int height, double ms) {
  Sight sight{eye, state.cut, state.cast_box, state.opacity, state.tip_mm, state.axis, state.tool_shown, width, height};
  const bool moved = std::exchange(changed_, false) || !same(sight, sight_);
  const bool whole = !(ms > 0);
  const double next = whole ? 1 : moved ? moving_scale_ : std::min(1.0, 2 * scale_);
  if (whole || moved || next > scale_) {
    scale_ = next;
    sight_ = sight;  // not where nothing is cast: what creeps would never have moved
    make_target(std::max(1, int(std::lround(width * scale_))), std::max(1, int(std::lround(height * scale_))));
    if (!whole) wait_for_driver();
    const auto begin = std::chrono::steady_clock::now();
    cast(targets, kept, sight, cast::step_of({}, lattice_) * (whole || !moved ? 1 : moving_step));
    if (!whole && moved) {
      wait_for_driver();
      const double took = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      const double wanted = scale_ * std::sqrt(ms / std::max(0.1, took));
      moving_scale_ = std::clamp(std::sqrt(moving_scale_ * wanted), least_scale, 1.0);
    }
  }
  lay_over(targets, kept, sight);
}

void CastPass::cast(const PictureTargets& targets, KeptFences& kept, const Sight& sight, double step_mm) {
  const scene::EyeView& e = sight.eye;
  kept.after_pass();
  targets.resolve(GL_DEPTH_BUFFER_BIT, kept);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_BLEND);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  glViewport(0, 0, width_, height_);
  casting_.use();
  const auto bind = [&](int unit, GLenum kind, GLuint texture, const char* name) {
    glActiveTexture(GL_TEXTURE0 + GLenum(unit));
    glBindTexture(kind, texture);
    casting_.set(name, unit);
  };
  bind(0, GL_TEXTURE_3D, voxels_texture_, "voxels");
  bind(1, GL_TEXTURE_3D, bricks_texture_, "bricks");
  bind(2, GL_TEXTURE_2D, table_texture_, "table");
  bind(3, GL_TEXTURE_2D, targets.depth(), "depth");
  glActiveTexture(GL_TEXTURE0);
  casting_.set("frustum", float(e.left), float(e.right_edge), float(e.bottom), float(e.top));
  casting_.set("planes", float(e.near_mm), float(e.far_mm));
  casting_.set("picture", float(width_), float(height_));
  const Vec3 from = lattice_.to_index(e.eye_mm), axes[3] = {e.right, e.up, e.toward};
  std::array<Vec3, 3> to_voxels, to_eye, to_box;
  for (std::size_t c = 0; c < 3; ++c) {
    to_voxels[c] = lattice_.to_index(lattice_.origin_mm + axes[c]);
    to_box[c] = axes[c];
    const Vec3 axis = lattice_.direction.column[c];
    to_eye[c] = {dot(axis, e.right), dot(axis, e.up), dot(axis, e.toward)};
  }
  casting_.set("from", from);
  casting_.set("size", float(lattice_.size[0]), float(lattice_.size[1]), float(lattice_.size[2]));
  casting_.set("spacing_mm", lattice_.spacing_mm);
  casting_.set("brick_count", float(bricks_.size[0]), float(bricks_.size[1]), float(bricks_.size[2]));
  casting_.set("to_voxels", map_of(to_voxels));
  casting_.set("to_eye", map_of(to_eye));
  casting_.set("to_box", map_of(to_box));
  casting_.set("step_mm", float(step_mm));
  const std::array<int, 2> seen = table_.seen_hu();
  casting_.set("seen_hu", float(seen[0]), float(seen[1]));
  const Vec3 wide{1e6, 1e6, 1e6};
  casting_.set("box_low", sight.box ? sight.box->min_mm - e.eye_mm : -wide);
  casting_.set("box_high", sight.box ? sight.box->max_mm - e.eye_mm : wide);
  if (sight.cut) {
    const Vec3 n = normalized(sight.cut->normal);
    casting_.set("cut", float(dot(n, e.right)), float(dot(n, e.up)), float(dot(n, e.toward)),
                 float(dot(n, e.eye_mm - sight.cut->point_mm)));
  } else {
    casting_.set("cut", 0.f, 0.f, 0.f, -1.f);
  }
  glBindVertexArray(empty_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  kept.after_pass();
}

void CastPass::lay_over(const PictureTargets& targets, KeptFences& kept, const Sight& sight) {
  const scene::EyeView& e = sight.eye;
  glBindFramebuffer(GL_FRAMEBUFFER, targets.frame());
  glViewport(0, 0, sight.width, sight.height);
  glDisable(GL_CLIP_DISTANCE0);
  glBindVertexArray(empty_array_);
  glActiveTexture(GL_TEXTURE0);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  over_.use();
  glBindTexture(GL_TEXTURE_2D, colour_);
  over_.set("rays", 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  depth_.use();
  glBindTexture(GL_TEXTURE_2D, hides_);
  depth_.set("hides_mm", 0);
  depth_.set("frustum", float(e.left), float(e.right_edge), float(e.bottom), float(e.top));
  depth_.set("planes", float(e.near_mm), float(e.far_mm));
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  kept.after_pass();
}

}  // namespace trephine::render
