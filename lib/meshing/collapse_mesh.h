// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::meshing {

/// A closed 2-manifold mesh that shrinks by edge collapses. Any collapse can be undone later, whatever came after it.
/// Points are kept in float32: they must lie on its raster (snap_to_float32), so that nothing is rounded.
///
/// Half-edge 3 t + c runs from corner c of triangle t to the next one. A collapse of half-edge h (u to v) removes v and
/// the two triangles at the edge; u stays, at a new place. Dead elements keep their labels and links, so that undoing
/// needs little more than h and u's old place. Each live triangle knows the collapse that last changed it. A collapse
/// can be undone once every triangle around its point is as the collapse left it, so undoing it first undoes the later
/// collapses there.
///
/// Collapses may run at the same time, each thread with its own log, where they share no point's triangles: a collapse
/// writes the triangles around its two ends and the links of the triangles beside them across their shared edges.
class CollapseMesh {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// The mesh must be closed and 2-manifold.
  explicit CollapseMesh(const surface::TriMesh& mesh);

  struct Record {
    std::uint32_t half_edge;
    std::array<float, 3> old_place_mm;
    std::uint32_t journal;  ///< into the log's journal: what last changed the triangles around u before; none: undone
  };
  /// A sequence of collapses; their ids begin at first_id.
  struct Log {
    std::uint32_t first_id = 0;
    std::vector<Record> records;
    std::vector<std::uint32_t> journal;
  };
  /// Opens a log for at most that many collapses.
  Log open_log(std::size_t capacity);
  /// Closes the log. Logs must be closed in the order in which they were opened.
  void keep(Log&& log);

  std::size_t live_triangles() const { return live_triangles_; }
  bool live_triangle(std::uint32_t t) const { return !dead_[t]; }
  bool live_point(std::uint32_t v) const { return killed_by_[v] == none; }
  std::size_t points() const { return points_mm_.size(); }
  std::size_t triangles() const { return triangles_.size(); }
  Vec3 point_mm(std::uint32_t v) const {
    const auto& p = points_mm_[v];
    return {p[0], p[1], p[2]};
  }
  void move(std::uint32_t v, Vec3 place_mm) {
    points_mm_[v] = {static_cast<float>(place_mm.x), static_cast<float>(place_mm.y), static_cast<float>(place_mm.z)};
  }
  const std::array<std::uint32_t, 3>& triangle(std::uint32_t t) const { return triangles_[t]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next(h)); }

  /// Calls visit(h) for the half-edges that leave the live point v, in a fixed order.
  template <class Visit>
  void for_each_leaving(std::uint32_t v, Visit&& visit) const {
    const std::uint32_t start = out_[v];
    std::uint32_t h = start;
    do {
      visit(h);
      h = twin_[previous(h)];
    } while (h != start);
  }

  /// Whether the collapse leaves the surface a closed 2-manifold (link condition).
  bool keeps_manifold(std::uint32_t h) const;
  /// Collapses h. live_triangles() counts it once the log is kept.
  void collapse(std::uint32_t h, Vec3 place_mm, Log& log);

  /// The collapse that last changed the triangle, or none.
  std::uint32_t last_change(std::uint32_t t) const { return changed_by_[t]; }
  /// The collapse that removed the dead point.
  std::uint32_t killer(std::uint32_t v) const { return killed_by_[v]; }
  /// Undoes the collapse after the collapses that depend on it. Calls before(u, v) before each and undone(u, v) after
  /// each.
  using Visit = std::function<void(std::uint32_t u, std::uint32_t v)>;
  void undo(std::uint32_t collapse, const Visit& before, const Visit& undone);

  /// For each point itself if it is alive, else the live point into which it was collapsed.
  std::vector<std::uint32_t> survivors() const;

  /// The live part as a mesh; triangle_of gives for each of its triangles the number here.
  surface::TriMesh to_mesh(Vec3 origin_mm, std::vector<std::uint32_t>* triangle_of = nullptr) const;

 private:
  Record& record(std::uint32_t id);
  void undo_now(std::uint32_t id);

  std::vector<std::array<float, 3>> points_mm_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> twin_, out_, killed_by_, changed_by_;
  std::vector<char> dead_;
  std::vector<Log> logs_;
  std::uint32_t next_id_ = 0;
  std::size_t live_triangles_ = 0;
};

}  // namespace trephine::meshing
