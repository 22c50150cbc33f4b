// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace trephine {
namespace {

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

void describe_scene_vertex() {
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SceneVertex), offset(0));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_BYTE, GL_TRUE, sizeof(SceneVertex), offset(offsetof(SceneVertex, normal)));
}

SceneVertex packed(const LiveVertex& v) {
  SceneVertex out;
  for (int a = 0; a < 3; ++a) {
    out.position_mm[a] = v.position_mm[a];
    out.normal[a] = std::int8_t(std::lrint(127 * std::clamp(v.normal[a], -1.f, 1.f)));
  }
  out.normal[3] = 0;
  return out;
}

// Room to grow for a brick that is cut: its surface becomes larger before it vanishes.
std::uint32_t with_room(std::size_t n) { return std::uint32_t(n + n / 2 + 16); }

}  // namespace

SurfaceBuffer::SurfaceBuffer(const SceneSurface& s)
    : array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()),
      count_(GLsizei(s.indices.size())) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(s.vertices.size() * sizeof s.vertices[0]), s.vertices.data(),
               GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(s.indices.size() * sizeof s.indices[0]), s.indices.data(),
               GL_STATIC_DRAW);
  describe_scene_vertex();
  bytes_ = s.vertices.size() * sizeof s.vertices[0] + s.indices.size() * sizeof s.indices[0];
  check_gl("a surface");
}

SurfaceBuffer::SurfaceBuffer(const Solid& s, bool coloured)
    : array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()),
      count_(GLsizei(s.indices.size())) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(s.vertices.size() * sizeof s.vertices[0]), s.vertices.data(),
               GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(s.indices.size() * sizeof s.indices[0]), s.indices.data(),
               GL_STATIC_DRAW);
  for (GLuint n = 0; n < (coloured ? 3u : 2u); ++n) {
    glEnableVertexAttribArray(n);
    glVertexAttribPointer(n, 3, GL_FLOAT, GL_FALSE, sizeof(SolidVertex), offset(n * 3 * sizeof(float)));
  }
  check_gl("a tool");
}

void SurfaceBuffer::draw() const {
  if (count_ == 0) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

BrickBuffer::BrickBuffer(const LiveSurface& surface, const Mat3& axes, Vec3 offset_mm)
    : array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()),
      model_(affine(axes, offset_mm)),
      mirrored_(determinant(axes) < 0) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  describe_scene_vertex();
  upload_all(surface);
}

// In a left-handed lattice a triangle that is counter-clockwise along its axes is clockwise in the world.
void BrickBuffer::append_indices(const BrickMesh& mesh, std::uint32_t first_vertex) {
  const std::size_t begin = index_work_.size();
  for (const std::uint16_t i : mesh.indices) index_work_.push_back(first_vertex + i);
  if (mirrored_)
    for (std::size_t n = begin; n + 2 < index_work_.size(); n += 3) std::swap(index_work_[n + 1], index_work_[n + 2]);
}

// All bricks anew and close together, with half as much room again behind them for those that outgrow their place.
void BrickBuffer::upload_all(const LiveSurface& surface) {
  const std::size_t count = surface.layout().count();
  places_.assign(count, {});
  vertex_work_.clear();
  index_work_.clear();
  for (std::size_t b = 0; b < count; ++b) {
    const BrickMesh& mesh = surface.brick(b);
    Place& p = places_[b];
    p = {std::uint32_t(vertex_work_.size()), std::uint32_t(mesh.vertices.size()), std::uint32_t(index_work_.size()),
         std::uint32_t(mesh.indices.size())};
    for (const LiveVertex& v : mesh.vertices) vertex_work_.push_back(packed(v));
    append_indices(mesh, p.first_vertex);
  }
  vertex_end_ = vertex_work_.size();
  index_end_ = index_work_.size();
  vertex_room_ = vertex_end_ + vertex_end_ / 2 + 65536;
  index_room_ = index_end_ + index_end_ / 2 + 6 * 65536;
  wasted_ = 0;
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertex_room_ * sizeof(SceneVertex)), nullptr, GL_DYNAMIC_DRAW);
  glBufferSubData(GL_ARRAY_BUFFER, 0, GLsizeiptr(vertex_end_ * sizeof(SceneVertex)), vertex_work_.data());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(index_room_ * sizeof(std::uint32_t)), nullptr, GL_DYNAMIC_DRAW);
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0, GLsizeiptr(index_end_ * sizeof(std::uint32_t)), index_work_.data());
  check_gl("the bricks of a surface");
}

void BrickBuffer::put(const BrickMesh& mesh, const Place& p) {
  vertex_work_.clear();
  index_work_.clear();
  for (const LiveVertex& v : mesh.vertices) vertex_work_.push_back(packed(v));
  append_indices(mesh, p.first_vertex);
  index_work_.resize(p.index_room, p.first_vertex);
  if (!vertex_work_.empty())
    glBufferSubData(GL_ARRAY_BUFFER, GLintptr(p.first_vertex * sizeof(SceneVertex)),
                    GLsizeiptr(vertex_work_.size() * sizeof(SceneVertex)), vertex_work_.data());
  if (!index_work_.empty())
    glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(p.first_index * sizeof(std::uint32_t)),
                    GLsizeiptr(index_work_.size() * sizeof(std::uint32_t)), index_work_.data());
}

void BrickBuffer::update(const LiveSurface& surface, const std::vector<std::size_t>& bricks) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  for (const std::size_t b : bricks) {
    const BrickMesh& mesh = surface.brick(b);
    Place& p = places_[b];
    if (mesh.vertices.size() > p.vertex_room || mesh.indices.size() > p.index_room) {
      put({}, p);
      wasted_ += p.index_room;
      const Place next{std::uint32_t(vertex_end_), with_room(mesh.vertices.size()), std::uint32_t(index_end_),
                       with_room(mesh.indices.size()) / 3 * 3};
      if (next.first_vertex + next.vertex_room > vertex_room_ || next.first_index + next.index_room > index_room_) {
        upload_all(surface);  // it holds every other brick of this call as well
        return;
      }
      p = next;
      vertex_end_ += p.vertex_room;
      index_end_ += p.index_room;
    }
    put(mesh, p);
  }
  if (wasted_ > index_end_ / 2) upload_all(surface);
  check_gl("bricks that were cut");
}

void BrickBuffer::draw() const {
  if (index_end_ == 0) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, GLsizei(index_end_), GL_UNSIGNED_INT, nullptr);
}

}  // namespace trephine
