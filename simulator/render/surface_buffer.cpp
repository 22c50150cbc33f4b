// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <unordered_map>

#include "render/coarse.h"

namespace trephine {
namespace {

constexpr double chunk_mm = 25;
constexpr int chunk_bricks = 4;

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

// Room to grow for a brick that is cut: its surface becomes larger before it vanishes.
std::uint32_t with_room(std::size_t n) { return std::uint32_t(n + n / 2 + 16); }

bool touch(const Chunk& a, const Chunk& b) {
  constexpr double gap_mm = 0.1;
  for (int k = 0; k < 3; ++k)
    if (a.low[k] > b.high[k] + gap_mm || b.low[k] > a.high[k] + gap_mm) return false;
  return true;
}

Vec3 vec(const float* p) { return {p[0], p[1], p[2]}; }

}  // namespace

float linear_of(float srgb) { return std::pow(std::max(0.f, srgb), 2.2f); }

SceneVertex packed(const LiveVertex& v) {
  SceneVertex out;
  for (int a = 0; a < 3; ++a) {
    out.position_mm[a] = v.position_mm[a];
    out.normal[a] = std::int8_t(std::lrint(127 * std::clamp(v.normal[a], -1.f, 1.f)));
  }
  out.normal[3] = 0;
  return out;
}

void DrawList::add(std::uint32_t first, std::uint32_t count) {
  if (count == 0) return;
  if (!ranges_.empty() && ranges_.back().first + ranges_.back().count == first)
    ranges_.back().count += count;
  else
    ranges_.push_back({first, count});
}

SolidBuffer::SolidBuffer(const Solid& s, bool coloured)
    : array_(make_vertex_array()),
      vertices_(make_buffer()),
      indices_(make_buffer()),
      count_(GLsizei(s.indices.size())) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  std::vector<SolidVertex> vertices = s.vertices;
  for (SolidVertex& v : vertices)
    for (float& part : v.colour_rgb) part = linear_of(part);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof vertices[0]), vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(s.indices.size() * sizeof s.indices[0]), s.indices.data(),
               GL_STATIC_DRAW);
  for (GLuint n = 0; n < (coloured ? 3u : 2u); ++n) {
    glEnableVertexAttribArray(n);
    glVertexAttribPointer(n, 3, GL_FLOAT, GL_FALSE, sizeof(SolidVertex), offset(n * 3 * sizeof(float)));
  }
  check_gl("a tool");
}

void SolidBuffer::draw() const {
  if (count_ == 0) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

SurfaceBuffer::SurfaceBuffer(const SceneSurface& s) {
  vertex_work_ = s.vertices;
  index_work_ = s.indices;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> box_of(s.indices.size() / 3);
  for (std::size_t t = 0; t < box_of.size(); ++t) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a)
      key = key << 20 |
            (std::uint64_t(std::floor(s.vertices[s.indices[3 * t]].position_mm[a] / chunk_mm) + 524288) & 0xfffff);
    box_of[t] = numbers.emplace(key, std::uint32_t(numbers.size())).first->second;
  }
  placed_.chunks = make_chunks(
      index_work_, box_of, numbers.size(), [&](std::uint32_t v) { return vec(vertex_work_[v].position_mm); }, nullptr);
  fine_end_ = index_work_.size();
  keep_boxes();
  upload(0, 0);
}

void SurfaceBuffer::keep_boxes() {
  boxes_.clear();
  for (const Chunk& c : placed_.chunks) boxes_.emplace_back(c.low, c.high);
}

std::optional<CoarseFacts> SurfaceBuffer::make_coarse(double within_mm, std::size_t most_bytes) {
  if (within_mm == coarse_mm_ && (!coarse_facts_ || coarse_facts_->bytes <= most_bytes)) return coarse_facts_;
  coarse_mm_ = within_mm;
  coarse_most_ = most_bytes;
  index_work_.resize(fine_end_);
  add_coarse();
  upload(0, 0);
  return coarse_facts_;
}

std::optional<CoarseFacts> SurfaceBuffer::make_coarse(const LiveSurface& surface, double within_mm,
                                                      std::size_t most_bytes) {
  if (within_mm == coarse_mm_ && (!coarse_facts_ || coarse_facts_->bytes <= most_bytes)) return coarse_facts_;
  coarse_mm_ = within_mm;
  coarse_most_ = most_bytes;
  upload_bricks(surface);
  return coarse_facts_;
}

// Behind the triangles of the chunks, in the same chunks. A vertex may have gone beyond the box of its chunk, so the
// box grows: whether a chunk is seen is asked of its box.
void SurfaceBuffer::add_coarse() {
  coarse_.clear();
  coarse_facts_.reset();
  cut_.assign(placed_.chunks.size(), 0);
  for (std::size_t n = 0; n < boxes_.size(); ++n) std::tie(placed_.chunks[n].low, placed_.chunks[n].high) = boxes_[n];
  if (!(coarse_mm_ > 0)) return;
  std::vector<std::uint32_t> chunk_of(index_work_.size() / 3);
  for (std::size_t n = 0; n < placed_.chunks.size(); ++n) {
    for (const Chunk::Range& r : placed_.chunks[n].range)
      std::fill_n(chunk_of.begin() + r.first / 3, r.count / 3, std::uint32_t(n));
  }
  CoarseTriangles coarse = coarse_triangles(vertex_work_, index_work_, coarse_mm_);
  if (coarse.indices.empty() || !is_worth_it(coarse.indices.size(), fine_end_) ||
      coarse.indices.size() * sizeof(std::uint32_t) > coarse_most_)
    return;
  coarse_facts_ = coarse_facts(vertex_work_, fine_end_ / 3, coarse.indices);
  std::vector<std::uint32_t> box_of;
  box_of.reserve(coarse.from.size());
  for (const std::uint32_t t : coarse.from) box_of.push_back(chunk_of[t]);
  coarse_ = make_chunks(
      coarse.indices, box_of, placed_.chunks.size(), [&](std::uint32_t v) { return vec(vertex_work_[v].position_mm); },
      nullptr);
  for (std::size_t n = 0; n < coarse_.size(); ++n) placed_.chunks[n].include(coarse_[n]);
  const auto first = std::uint32_t(index_work_.size());
  for (Chunk& chunk : coarse_)
    for (Chunk::Range& r : chunk.range) {
      r.first += first;
      if (placed_.mirrored) r.axis = r.axis * -1;
    }
  index_work_.insert(index_work_.end(), coarse.indices.begin(), coarse.indices.end());
}

SurfaceBuffer::SurfaceBuffer(const LiveSurface& surface, const Mat3& axes, Vec3 offset_mm) : placed_(axes, offset_mm) {
  upload_bricks(surface);
}

// What is in the two work lists, with room behind it.
void SurfaceBuffer::upload(std::size_t spare_vertices, std::size_t spare_indices) {
  array_ = make_vertex_array();
  vertices_ = make_buffer();
  indices_ = make_buffer();
  vertex_end_ = vertex_work_.size();
  index_end_ = chunk_end_ = index_work_.size();
  vertex_room_ = vertex_end_ + spare_vertices;
  index_room_ = index_end_ + spare_indices;
  const GLenum use = spare_indices > 0 ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW;
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertex_room_ * sizeof(SceneVertex)), nullptr, use);
  glBufferSubData(GL_ARRAY_BUFFER, 0, GLsizeiptr(vertex_end_ * sizeof(SceneVertex)), vertex_work_.data());
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(index_room_ * sizeof(std::uint32_t)), nullptr, use);
  glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, 0, GLsizeiptr(index_end_ * sizeof(std::uint32_t)), index_work_.data());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(SceneVertex), offset(0));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_BYTE, GL_TRUE, sizeof(SceneVertex), offset(offsetof(SceneVertex, normal)));
  check_gl("a surface");
}

// In a left-handed lattice a triangle that is counter-clockwise along its axes is clockwise in the world.
void SurfaceBuffer::append(const BrickMesh& mesh, std::uint32_t first_vertex) {
  for (const LiveVertex& v : mesh.vertices) vertex_work_.push_back(packed(v));
  const std::size_t begin = index_work_.size();
  for (const std::uint16_t i : mesh.indices) index_work_.push_back(first_vertex + i);
  if (placed_.mirrored)
    for (std::size_t n = begin; n + 2 < index_work_.size(); n += 3) std::swap(index_work_[n + 1], index_work_[n + 2]);
}

void SurfaceBuffer::upload_bricks(const LiveSurface& surface) {
  const BrickLayout& layout = surface.layout();
  const std::size_t count = layout.count();
  int boxes[3];
  for (std::size_t a = 0; a < 3; ++a) boxes[a] = (layout.bricks[a] + chunk_bricks - 1) / chunk_bricks;
  places_.assign(count, {});
  chunk_of_.assign(count, 0);
  brick_first_.assign(count + 1, 0);
  vertex_work_.clear();
  index_work_.clear();
  std::vector<std::uint32_t> box_of;
  for (std::size_t b = 0; b < count; ++b) {
    append(surface.brick(b), std::uint32_t(vertex_work_.size()));
    brick_first_[b + 1] = std::uint32_t(index_work_.size() / 3);
    const std::array<int, 3> at = layout.place(b);
    const int box = (at[2] / chunk_bricks * boxes[1] + at[1] / chunk_bricks) * boxes[0] + at[0] / chunk_bricks;
    chunk_of_[b] = std::uint32_t(box);
    box_of.resize(index_work_.size() / 3, std::uint32_t(box));
  }
  // The normals of mirrored triangles point the right way after the model's mirroring: chunks know them as they are in
  // the lattice.
  const double sign = placed_.mirrored ? -1 : 1;
  placed_.chunks = make_chunks(
      index_work_, box_of, std::size_t(boxes[0] * boxes[1] * boxes[2]),
      [&](std::uint32_t v) { return vec(vertex_work_[v].position_mm); }, &where_);
  for (Chunk& chunk : placed_.chunks)
    for (Chunk::Range& r : chunk.range) r.axis = r.axis * sign;
  fine_end_ = index_work_.size();
  keep_boxes();
  add_coarse();
  upload(vertex_work_.size() / 4 + 65536, fine_end_ / 4 + 6 * 65536);
}

void SurfaceBuffer::leave_chunk(std::size_t b) {
  cut_[chunk_of_[b]] = 1;
  // The triangles of a brick that face one way follow each other.
  std::vector<std::uint32_t>& at = index_work_;
  at.assign(where_.begin() + brick_first_[b], where_.begin() + brick_first_[b + 1]);
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

void SurfaceBuffer::put(const BrickMesh& mesh, const Place& p) {
  vertex_work_.clear();
  index_work_.clear();
  append(mesh, p.first_vertex);
  index_work_.resize(p.index_room, p.first_vertex);
  if (!vertex_work_.empty())
    glBufferSubData(GL_ARRAY_BUFFER, GLintptr(p.first_vertex * sizeof(SceneVertex)),
                    GLsizeiptr(vertex_work_.size() * sizeof(SceneVertex)), vertex_work_.data());
  if (!index_work_.empty())
    glBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(p.first_index * sizeof(std::uint32_t)),
                    GLsizeiptr(index_work_.size() * sizeof(std::uint32_t)), index_work_.data());
}

void SurfaceBuffer::update(const LiveSurface& surface, const std::vector<std::size_t>& bricks) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  for (const std::size_t b : bricks) {
    const BrickMesh& mesh = surface.brick(b);
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
  if (s.coarse && !coarse_.empty())
    for (std::size_t n = 0; n < placed_.chunks.size(); ++n)
      if (cut_[n] || away_from_near(placed_.chunks[n], s) <= s.fine_mm) fine.push_back(n);
  const auto beside_fine = [&](std::size_t n) {
    return std::any_of(fine.begin(), fine.end(),
                       [&](std::size_t f) { return touch(placed_.chunks[n], placed_.chunks[f]); });
  };
  for (std::size_t n = 0; n < placed_.chunks.size(); ++n) {
    const Chunk& chunk = placed_.chunks[n];
    if ((seen && !(*seen)[n]) || !may_be_seen(chunk, s)) continue;
    const auto add = [&](const Chunk& c) {
      for (const Chunk::Range& r : c.range)
        if (r.count > 0 && may_face(c, r, s)) out.add(r.first, r.count);
    };
    const bool coarse = s.coarse && !coarse_.empty() && !cut_[n] && away_from_near(chunk, s) > s.fine_mm;
    if (!coarse || beside_fine(n)) add(chunk);
    if (coarse) add(coarse_[n]);
  }
  out.add(std::uint32_t(chunk_end_), std::uint32_t(index_end_ - chunk_end_));
}

void SurfaceBuffer::draw(const DrawList& list) const {
  count_work_.clear();
  first_work_.clear();
  for (const DrawList::Range& r : list.ranges()) {
    count_work_.push_back(GLsizei(r.count));
    first_work_.push_back(offset(r.first * sizeof(std::uint32_t)));
  }
  glBindVertexArray(array_);
  if (!count_work_.empty())
    glMultiDrawElements(GL_TRIANGLES, count_work_.data(), GL_UNSIGNED_INT, first_work_.data(),
                        GLsizei(count_work_.size()));
}

std::size_t SurfaceBuffer::triangles(const DrawList& list) const {
  std::size_t indices = 0;
  for (const DrawList::Range& r : list.ranges()) indices += r.count;
  return indices / 3;
}

}  // namespace trephine
