// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/srgb.h"

namespace trephine::render {
namespace {

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

// Room to grow for a brick that is cut: its surface becomes larger before it vanishes.
std::uint32_t with_room(std::size_t n) { return std::uint32_t(n + n / 2 + 16); }

bool touch(const Chunk& a, const Chunk& b) {
  constexpr double gap_mm = 0.1;
  for (int k = 0; k < 3; ++k)
    if (a.low[k] > b.high[k] + gap_mm || b.low[k] > a.high[k] + gap_mm) return false;
  return true;
}

}  // namespace

float linear_of(float srgb) { return float(linear_of_srgb(std::max(0.f, srgb))); }

void DrawList::add_to(std::vector<Range>& ranges, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return;
  if (!ranges.empty() && ranges.back().first + ranges.back().count == first)
    ranges.back().count += count;
  else
    ranges.push_back({first, count});
}

SolidBuffer::SolidBuffer(const scene::Solid& s, bool coloured)
    : array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()),
      count_(GLsizei(s.indices.size())) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  std::vector<scene::SolidVertex> vertices = s.vertices;
  for (scene::SolidVertex& v : vertices)
    for (float& part : v.colour_rgb) part = linear_of(part);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof vertices[0]), vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(s.indices.size() * sizeof s.indices[0]), s.indices.data(),
               GL_STATIC_DRAW);
  for (GLuint n = 0; n < (coloured ? 3u : 2u); ++n) {
    glEnableVertexAttribArray(n);
    glVertexAttribPointer(n, 3, GL_FLOAT, GL_FALSE, sizeof(scene::SolidVertex), offset(n * 3 * sizeof(float)));
  }
  check_gl("a tool");
}

void SolidBuffer::draw() const {
  if (count_ == 0) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

SurfaceBuffer::SurfaceBuffer(std::shared_ptr<const SurfaceParts> parts) : parts_(std::move(parts)) { upload(0, 0); }

SurfaceBuffer::SurfaceBuffer(const drill::LiveSurface& surface, const Mat3& axes, Vec3 offset_mm)
    : placed_(axes, offset_mm) {
  upload_bricks(surface);
}

// The vertices as they are, with triangles of one kind or the other.
GlObject SurfaceBuffer::make_array(const GlObject& indices) const {
  GlObject array = make_vertex_array();
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(scene::SceneVertex), offset(0));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_BYTE, GL_TRUE, sizeof(scene::SceneVertex),
                        offset(offsetof(scene::SceneVertex, normal)));
  return array;
}

// The parts, with room behind them. Coarser triangles were of those before.
void SurfaceBuffer::upload(std::size_t spare_vertices, std::size_t spare_indices) {
  coming_.reset();
  coarse_ = {};
  placed_.chunks = parts_->chunks;
  cut_.assign(placed_.chunks.size(), 0);
  vertex_end_ = parts_->vertices.size();
  index_end_ = parts_->indices.size();
  vertex_room_ = vertex_end_ + spare_vertices;
  index_room_ = index_end_ + spare_indices;
  vertices_ = make_buffer();
  indices_ = make_buffer();
  array_ = make_array(indices_);
  const GLenum use = spare_indices > 0 ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW;
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertex_room_ * sizeof(scene::SceneVertex)), nullptr, use);
  glBufferSubData(GL_ARRAY_BUFFER, 0, GLsizeiptr(vertex_end_ * sizeof(scene::SceneVertex)), parts_->vertices.data());
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(index_room_ * sizeof(std::uint32_t)), nullptr, use);
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0, GLsizeiptr(index_end_ * sizeof(std::uint32_t)), parts_->indices.data());
  check_gl("a surface");
}

void SurfaceBuffer::upload_bricks(const drill::LiveSurface& surface) {
  places_.assign(surface.layout().count(), {});
  parts_ = std::make_shared<const SurfaceParts>(parts_of(surface, placed_.mirrored, bricks_));
  upload(parts_->vertices.size() / 4 + 65536, parts_->indices.size() / 4 + 6 * 65536);
}

void SurfaceBuffer::set_coarse(std::optional<CoarseParts> coarse, bool keep_those_before) {
  coming_.reset();
  if (!coarse || !keep_those_before) show_coarse({});
  if (!coarse) return;
  Coming& c = coming_.emplace(Coming{std::move(*coarse), {}, 0});
  c.made.bytes = c.parts.indices.size() * sizeof(std::uint32_t);
  c.made.indices = make_buffer();
  c.made.array = make_array(c.made.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(c.made.bytes), nullptr, GL_STATIC_DRAW);
  check_gl("coarser triangles");
}

bool SurfaceBuffer::upload_coarse(std::size_t& max_bytes) {
  if (!coming_) return false;
  Coming& c = *coming_;
  const std::size_t now = std::min(max_bytes, c.made.bytes - c.uploaded);
  glBindVertexArray(c.made.array);
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(c.uploaded), GLsizeiptr(now),
                  reinterpret_cast<const char*>(c.parts.indices.data()) + c.uploaded);
  check_gl("coarser triangles");
  c.uploaded += now;
  max_bytes -= now;
  if (c.uploaded < c.made.bytes) return true;
  c.made.chunks = std::move(c.parts.chunks);
  show_coarse(std::move(c.made));
  coming_.reset();
  return false;
}

// A vertex of theirs may have gone beyond the box of its chunk, so the box grows: whether a chunk is seen is asked of
// its box.
void SurfaceBuffer::show_coarse(Coarse coarse) {
  coarse_ = std::move(coarse);
  for (std::size_t n = 0; n < placed_.chunks.size(); ++n) {
    placed_.chunks[n].low = parts_->chunks[n].low;
    placed_.chunks[n].high = parts_->chunks[n].high;
    if (!coarse_.chunks.empty()) placed_.chunks[n].include(coarse_.chunks[n]);
  }
}

std::size_t SurfaceBuffer::coarse_bytes() const { return coarse_.bytes + (coming_ ? coming_->made.bytes : 0); }

void SurfaceBuffer::leave_chunk(std::size_t b) {
  cut_[bricks_.chunk_of[b]] = 1;
  // The triangles of a brick that face one way follow each other.
  std::vector<std::uint32_t>& at = index_work_;
  at.assign(bricks_.where.begin() + bricks_.first[b], bricks_.where.begin() + bricks_.first[b + 1]);
  std::sort(at.begin(), at.end());
  const std::vector<std::uint32_t> none(3 * at.size(), 0);
  for (std::size_t n = 0; n < at.size();) {
    std::size_t end = n + 1;
    while (end < at.size() && at[end] == at[end - 1] + 3) ++end;
    glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(at[n] * sizeof(std::uint32_t)),
                    GLsizeiptr(3 * (end - n) * sizeof(std::uint32_t)), none.data());
    n = end;
  }
}

void SurfaceBuffer::put(const drill::BrickMesh& mesh, const Place& p) {
  vertex_work_.clear();
  index_work_.clear();
  append(mesh, placed_.mirrored, p.first_vertex, vertex_work_, index_work_);
  index_work_.resize(p.index_room, p.first_vertex);
  if (!vertex_work_.empty())
    glBufferSubData(GL_ARRAY_BUFFER, GLintptr(p.first_vertex * sizeof(scene::SceneVertex)),
                    GLsizeiptr(vertex_work_.size() * sizeof(scene::SceneVertex)), vertex_work_.data());
  if (!index_work_.empty())
    glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(p.first_index * sizeof(std::uint32_t)),
                    GLsizeiptr(index_work_.size() * sizeof(std::uint32_t)), index_work_.data());
}

void SurfaceBuffer::update(const drill::LiveSurface& surface, const std::vector<std::size_t>& bricks) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  for (const std::size_t b : bricks) {
    const drill::BrickMesh& mesh = surface.brick(b);
    Place& p = places_[b];
    if (p.index_room == 0) leave_chunk(b);
    if (mesh.vertices.size() > p.vertex_room || mesh.indices.size() > p.index_room) {
      if (p.index_room > 0) put({}, p);
      const Place next{std::uint32_t(vertex_end_), with_room(mesh.vertices.size()), std::uint32_t(index_end_),
                       with_room(mesh.indices.size()) / 3 * 3};
      if (next.first_vertex + next.vertex_room > vertex_room_ || next.first_index + next.index_room > index_room_) {
        upload_bricks(surface);  // with every other brick of this call as well
        return;
      }
      p = next;
      vertex_end_ += p.vertex_room;
      index_end_ += p.index_room;
    } else if (p.index_room == 0) {
      p = {0, 0, 0, 3};  // a brick that is empty now: it has left its chunk, and has no place
      p.first_index = std::uint32_t(index_end_);
      if (index_end_ + 3 > index_room_) {
        upload_bricks(surface);
        return;
      }
      index_end_ += 3;
    }
    put(mesh, p);
  }
  check_gl("bricks that were cut");
}

void SurfaceBuffer::list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const {
  out.clear();
  const Sight s = placed_.sight(scene);
  // Where fine and coarse meet, a row of chunks is drawn both ways, so that no gap is seen between them.
  std::vector<std::size_t> fine;
  const bool any_coarse = s.coarse && !coarse_.chunks.empty();
  if (any_coarse)
    for (std::size_t n = 0; n < placed_.chunks.size(); ++n)
      if (cut_[n] || away_from_near(placed_.chunks[n], s) <= s.fine_mm) fine.push_back(n);
  const auto beside_fine = [&](std::size_t n) {
    return std::any_of(fine.begin(), fine.end(),
                       [&](std::size_t f) { return touch(placed_.chunks[n], placed_.chunks[f]); });
  };
  for (std::size_t n = 0; n < placed_.chunks.size(); ++n) {
    const Chunk& chunk = placed_.chunks[n];
    if ((seen && !(*seen)[n]) || !may_be_seen(chunk, s)) continue;
    const bool coarse = any_coarse && !cut_[n] && away_from_near(chunk, s) > s.fine_mm;
    if (!coarse || beside_fine(n))
      for (const Chunk::Range& r : chunk.range)
        if (r.count > 0 && may_face(chunk, r, s)) out.add(r.first, r.count);
    if (!coarse) continue;
    for (const Chunk::Range& r : coarse_.chunks[n].range)
      if (r.count > 0 && may_face(coarse_.chunks[n], r, s)) out.add_coarse(r.first, r.count);
  }
  const std::size_t in_chunks = parts_->indices.size();
  if (s.loose) out.add(std::uint32_t(in_chunks), std::uint32_t(index_end_ - in_chunks));
}

void SurfaceBuffer::draw(const DrawList& list) const {
  draw_ranges(array_, list.ranges());
  draw_ranges(coarse_.array, list.coarse());
}

void SurfaceBuffer::draw_ranges(const GlObject& array, const std::vector<DrawList::Range>& ranges) const {
  if (ranges.empty()) return;
  count_work_.clear();
  first_work_.clear();
  for (const DrawList::Range& r : ranges) {
    count_work_.push_back(GLsizei(r.count));
    first_work_.push_back(offset(r.first * sizeof(std::uint32_t)));
  }
  glBindVertexArray(array);
  glMultiDrawElements(GL_TRIANGLES, count_work_.data(), GL_UNSIGNED_INT, first_work_.data(),
                      GLsizei(count_work_.size()));
}

std::size_t SurfaceBuffer::triangles(const DrawList& list) const {
  std::size_t indices = 0;
  for (const DrawList::Range& r : list.ranges()) indices += r.count;
  for (const DrawList::Range& r : list.coarse()) indices += r.count;
  return indices / 3;
}

}  // namespace trephine::render
