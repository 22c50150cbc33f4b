// SPDX-License-Identifier: GPL-3.0-or-later
// The surface that follows, made by a compute shader.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "drill/cell_triangles.h"
#include "render/gl_object.h"
#include "render/shaders.h"
#include "render/surface_maker.h"

namespace trephine::render {
namespace {

constexpr int side = drill::BrickLayout::side;
constexpr int chunk_bricks = 4;
constexpr std::size_t max_vertices = 3 * side * (side + 1) * (side + 1), max_indices = 15 * side * side * side;
constexpr GLuint groups_a_row = 32768;
constexpr std::uint32_t no_slot = 0xffffffff;

// Of shaders::brick_compute.
enum Binding : GLuint { vertices_at, indices_at, places_at, commands_at, heap_at, work_at };
struct Place {
  std::uint32_t first_vertex, vertex_room, first_index, index_room;
};
struct DrawCommand {
  std::uint32_t count, instances, first_index, base_vertex, base_instance;
};
struct Work {
  std::uint32_t brick, slot;
};

std::size_t with_room(std::size_t n) { return n + n / 2 + 16; }  // as the shader does

void store(const GlObject& buffer, std::size_t bytes, const void* data, GLenum use) {
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
  glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(std::max<std::size_t>(bytes, 16)), nullptr, use);
  if (bytes > 0 && data) glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes), data);
}

template <class T>
std::vector<T> fetch(const GlObject& buffer, std::size_t first, std::size_t count) {
  std::vector<T> out(count);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffer);
  if (count > 0)
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, GLintptr(first * sizeof(T)), GLsizeiptr(count * sizeof(T)),
                       out.data());
  return out;
}

GLint limit(GLenum what) {
  GLint n = 0;
  glGetIntegerv(what, &n);
  return n;
}

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ExitCode::io, "", "OpenGL", what + "; --surface-by processor works");
}

class ComputeSurface : public SurfaceMaker {
 public:
  ComputeSurface(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm, const ComputeRoom& room)
      : shadow_(volume, shape),
        room_(room),
        placed_(volume.voxels.direction, volume.voxels.origin_mm - centre_mm),
        counting_((std::string(shaders::brick_head) + "#define COUNT\n" + shaders::brick_compute).c_str()),
        making_((std::string(shaders::brick_head) + shaders::brick_compute).c_str()),
        values_(make_texture()),
        cells_(make_buffer()),
        vertices_(make_buffer()),
        indices_(make_buffer()),
        places_(make_buffer()),
        commands_(make_buffer()),
        heap_(make_buffer()),
        work_(make_buffer()),
        array_(make_vertex_array()) {
    upload_cells();
    upload_values();
    make_whole();
  }

  const PlacedChunks& placed() const override { return placed_; }
  const drill::ShadowVolume& shadow() const override { return shadow_; }
  std::size_t bytes() const override {
    return vertex_room_ * sizeof(scene::SceneVertex) + index_room_ * sizeof(std::uint32_t) +
           slot_room_ * (sizeof(Place) + sizeof(DrawCommand)) + 2 * shadow_.slice() * shadow_.size(2);
  }

  std::size_t update(const std::vector<std::size_t>& marked) override {
    const std::vector<std::size_t>& stale = shadow_.follow(marked);
    const drill::BrickLayout& layout = shadow_.layout();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_3D, values_);
    for (const std::size_t b : shadow_.copied()) {
      const std::array<int, 3> at = layout.place(b);
      upload_box({side * at[0], side * at[1], side * at[2]},
                 {drill::ShadowVolume::read_side, drill::ShadowVolume::read_side, drill::ShadowVolume::read_side});
    }
    make(stale);
    return stale.size();
  }

  void make(const std::vector<std::size_t>& bricks) override {
    std::size_t new_slots = 0;
    for (const std::size_t b : bricks) new_slots += slot_of_[b] == no_slot && drill::has_triangles(shadow_, b);
    if (!has_room_for(bricks.size()) || slots_ + new_slots > slot_room_) {
      make_whole();  // with these bricks
      return;
    }
    items_.clear();
    for (const std::size_t b : bricks) {
      if (slot_of_[b] == no_slot) {
        if (!drill::has_triangles(shadow_, b)) continue;
        slot_of_[b] = std::uint32_t(slots_++);
      }
      items_.push_back({std::uint32_t(b), slot_of_[b]});
    }
    run(making_);
  }

  void list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const override {
    out.clear();
    const Sight s = placed_.sight(scene);
    for (std::size_t n = 0; n < placed_.chunks.size(); ++n)
      if ((!seen || (*seen)[n]) && may_be_seen(placed_.chunks[n], s))
        out.add(placed_.chunks[n].range[0].first, placed_.chunks[n].range[0].count);
    out.add(std::uint32_t(chunk_slots_), std::uint32_t(slots_ - chunk_slots_));
  }

  void draw(const DrawList& list) const override {
    glBindVertexArray(array_);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_);
    for (const DrawList::Range& r : list.ranges())
      glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT,
                                  reinterpret_cast<const void*>(std::size_t(r.first) * sizeof(DrawCommand)),
                                  GLsizei(r.count), 0);
  }

  std::size_t triangles(const DrawList& list) const override {
    std::size_t indices = 0;
    for (const DrawList::Range& r : list.ranges())
      for (const DrawCommand& c : fetch<DrawCommand>(commands_, r.first, r.count)) indices += c.count;
    return indices / 3;
  }

  DrawnBrick read(std::size_t brick) const override {
    DrawnBrick out;
    if (slot_of_[brick] == no_slot) return out;
    const DrawCommand c = fetch<DrawCommand>(commands_, slot_of_[brick], 1).front();
    const Place p = fetch<Place>(places_, slot_of_[brick], 1).front();
    if (c.count == 0) return out;
    out.indices = fetch<std::uint32_t>(indices_, c.first_index, c.count);
    const std::uint32_t last = *std::max_element(out.indices.begin(), out.indices.end());
    if (last >= p.vertex_room || c.count > p.index_room || c.base_vertex != p.first_vertex)
      throw Error(ExitCode::io, "", "OpenGL", "a brick lies outside of its place");
    out.vertices = fetch<scene::SceneVertex>(vertices_, c.base_vertex, last + 1);
    return out;
  }

 private:
  // By the set of a cell's solid corners: a byte with the number of triangles, then their edges.
  void upload_cells() {
    std::array<std::array<std::uint8_t, 16>, 256> packed_cells{};
    for (std::size_t set = 0; set < 256; ++set) {
      const drill::detail::CellTriangles& t = drill::detail::cell_triangles()[set];
      packed_cells[set][0] = std::uint8_t(t.count);  // at most 5
      for (std::size_t n = 0; n < std::size_t(3 * t.count); ++n) packed_cells[set][n + 1] = t.edge[n];
    }
    glBindBuffer(GL_UNIFORM_BUFFER, cells_);
    glBufferData(GL_UNIFORM_BUFFER, sizeof packed_cells, packed_cells.data(), GL_STATIC_DRAW);
  }

  void upload_values() {
    const int most = limit(GL_MAX_3D_TEXTURE_SIZE);
    for (int a = 0; a < 3; ++a)
      if (shadow_.size(a) > std::size_t(most))
        refuse("a texture of this driver has at most " + std::to_string(most) + " voxels a side, the haptic volume " +
               std::to_string(shadow_.size(a)));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_3D, values_);
    glTexStorage3D(GL_TEXTURE_3D, 1, GL_R16UI, GLsizei(shadow_.size(0)), GLsizei(shadow_.size(1)),
                   GLsizei(shadow_.size(2)));
    for (const GLenum how : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_3D, how, GL_NEAREST);
    upload_box({0, 0, 0}, {int(shadow_.size(0)), int(shadow_.size(1)), int(shadow_.size(2))});
    check_gl("the voxels of a surface");
  }

  // From the copy, whose first voxel is the texture's.
  void upload_box(std::array<int, 3> first, std::array<int, 3> size) const {
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, GLint(shadow_.row()));
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, GLint(shadow_.size(1)));
    glTexSubImage3D(GL_TEXTURE_3D, 0, first[0], first[1], first[2], size[0], size[1], size[2], GL_RED_INTEGER,
                    GL_UNSIGNED_SHORT, shadow_.data() + shadow_.index(first[0] - 2, first[1] - 2, first[2] - 2));
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glPixelStorei(GL_UNPACK_IMAGE_HEIGHT, 0);
  }

  // Of as many bricks at their largest; the host knows no better without asking the card.
  bool has_room_for(std::size_t bricks) {
    const std::size_t vertices = bricks * with_room(max_vertices), indices = bricks * with_room(max_indices);
    if (vertex_bound_ + vertices > vertex_room_ || index_bound_ + indices > index_room_) {
      const std::vector<std::uint32_t> end = fetch<std::uint32_t>(heap_, 0, 2);
      vertex_bound_ = end[0];
      index_bound_ = end[1];
    }
    vertex_bound_ += vertices;
    index_bound_ += indices;
    return vertex_bound_ <= vertex_room_ && index_bound_ <= index_room_;
  }

  // All bricks, chunk by chunk: counted first, so that each has just the place that it needs.
  void make_whole() {
    const drill::BrickLayout& layout = shadow_.layout();
    std::vector<std::uint8_t> any(layout.count());
    parallel_for(0, std::int64_t(any.size()), 256, [&](std::int64_t from, std::int64_t to) {
      for (std::int64_t b = from; b < to; ++b) any[std::size_t(b)] = drill::has_triangles(shadow_, std::size_t(b));
    });
    int boxes[3];
    for (std::size_t a = 0; a < 3; ++a) boxes[a] = (layout.bricks[a] + chunk_bricks - 1) / chunk_bricks;
    slot_of_.assign(layout.count(), no_slot);
    items_.clear();
    placed_.chunks.clear();
    for (int z = 0; z < boxes[2]; ++z)
      for (int y = 0; y < boxes[1]; ++y)
        for (int x = 0; x < boxes[0]; ++x) add_chunk({x, y, z}, any);
    slots_ = chunk_slots_ = items_.size();
    slot_room_ = slots_ + room_.slots;
    store(heap_, 8, nullptr, GL_DYNAMIC_COPY);
    store(places_, slot_room_ * sizeof(Place), nullptr, GL_DYNAMIC_COPY);
    run(counting_);
    give_places();
    run(making_);
  }

  void add_chunk(std::array<int, 3> box, const std::vector<std::uint8_t>& any) {
    const drill::BrickLayout& layout = shadow_.layout();
    Chunk chunk;
    chunk.range[0].first = std::uint32_t(items_.size());
    int begin[3], end[3];
    for (std::size_t a = 0; a < 3; ++a) {
      begin[a] = chunk_bricks * box[a];
      end[a] = std::min(layout.bricks[a], begin[a] + chunk_bricks);
    }
    for (int z = begin[2]; z < end[2]; ++z)
      for (int y = begin[1]; y < end[1]; ++y)
        for (int x = begin[0]; x < end[0]; ++x) {
          const std::size_t b = layout.index(x, y, z);
          if (!any[b]) continue;
          slot_of_[b] = std::uint32_t(items_.size());
          items_.push_back({std::uint32_t(b), slot_of_[b]});
          const int at[3] = {x, y, z};
          for (int a = 0; a < 3; ++a) {
            chunk.low[a] = std::min(chunk.low[a], (side * at[a] - 1) * shadow_.spacing_mm()[a]);
            chunk.high[a] = std::max(chunk.high[a], (side * at[a] + side - 1) * shadow_.spacing_mm()[a]);
          }
        }
    chunk.range[0].count = std::uint32_t(items_.size()) - chunk.range[0].first;
    if (chunk.range[0].count > 0) placed_.chunks.push_back(chunk);
  }

  // What was counted stands in the rooms of the places: vertices, and indices.
  void give_places() {
    std::vector<Place> places = fetch<Place>(places_, 0, slots_);
    std::uint32_t vertices = 0, indices = 0;
    for (Place& p : places) {
      p.first_vertex = vertices;
      p.first_index = indices;
      vertices += p.vertex_room;
      indices += p.index_room;
    }
    vertex_bound_ = vertices;
    index_bound_ = indices;
    vertex_room_ = vertices + room_.bricks * with_room(max_vertices);
    index_room_ = indices + room_.bricks * with_room(max_indices);
    const std::size_t most = std::size_t(limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE));
    if (vertex_room_ * sizeof(scene::SceneVertex) > most || index_room_ * sizeof(std::uint32_t) > most)
      refuse("a storage buffer of this driver has at most " + std::to_string(most >> 20) + " MB, the surface needs " +
             std::to_string(std::max(vertex_room_ * sizeof(scene::SceneVertex), index_room_ * 4) >> 20));
    store(vertices_, vertex_room_ * sizeof(scene::SceneVertex), nullptr, GL_DYNAMIC_COPY);
    store(indices_, index_room_ * sizeof(std::uint32_t), nullptr, GL_DYNAMIC_COPY);
    store(commands_, slot_room_ * sizeof(DrawCommand), nullptr, GL_DYNAMIC_COPY);
    const std::uint32_t end[2] = {vertices, indices};
    store(heap_, sizeof end, end, GL_DYNAMIC_COPY);
    places.resize(slot_room_, Place{0, 0, 0, 0});
    store(places_, places.size() * sizeof(Place), places.data(), GL_DYNAMIC_COPY);
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(scene::SceneVertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 3, GL_BYTE, GL_TRUE, sizeof(scene::SceneVertex),
                          reinterpret_cast<const void*>(offsetof(scene::SceneVertex, normal)));
    check_gl("a surface of the graphics card");
  }

  // A work group for each of items_.
  void run(const GlProgram& program) {
    if (items_.empty()) return;
    store(work_, items_.size() * sizeof(Work), items_.data(), GL_STREAM_DRAW);
    program.use();
    const drill::BrickLayout& layout = shadow_.layout();
    const Vec3 s = shadow_.spacing_mm();
    program.set("values", 0);
    program.set_whole("bricks", layout.bricks[0], layout.bricks[1], layout.bricks[2]);
    program.set("spacing_mm", float(s.x), float(s.y), float(s.z));
    program.set("mirrored", placed_.mirrored ? 1 : 0);
    program.set("count", int(items_.size()));
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_3D, values_);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, cells_);
    const GlObject* const buffers[] = {&vertices_, &indices_, &places_, &commands_, &heap_, &work_};
    for (GLuint n = vertices_at; n <= work_at; ++n) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, n, *buffers[n]);
    const GLuint groups = GLuint(items_.size()), rows = (groups + groups_a_row - 1) / groups_a_row;
    glDispatchCompute(std::min(groups, groups_a_row), rows, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT |
                    GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    check_gl("the surface's shader");
  }

  drill::ShadowVolume shadow_;
  ComputeRoom room_;
  PlacedChunks placed_;
  GlProgram counting_, making_;
  GlObject values_, cells_, vertices_, indices_, places_, commands_, heap_, work_, array_;
  std::vector<std::uint32_t> slot_of_;       ///< by brick
  std::size_t slots_ = 0, chunk_slots_ = 0;  ///< behind those of chunks lie bricks that were empty or full before
  std::size_t slot_room_ = 0, vertex_room_ = 0, index_room_ = 0;
  std::size_t vertex_bound_ = 0, index_bound_ = 0;  ///< how full they are at most
  std::vector<Work> items_;
};

}  // namespace

std::unique_ptr<SurfaceMaker> compute_maker(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm,
                                            const ComputeRoom& room) {
  return std::make_unique<ComputeSurface>(volume, shape, centre_mm, room);
}

}  // namespace trephine::render
