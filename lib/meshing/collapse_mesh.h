// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "surface/trimesh.h"

namespace trephine {

/// A closed, 2-manifold mesh that shrinks by edge collapses, any of which can be undone later, whatever came after it.
///
/// Half-edge 3 t + c runs from corner c of triangle t to the next one. A collapse of half-edge h (u to v) removes v and
/// the two triangles at the edge; u stays, at a new place. What is dead keeps its labels and links, so that undoing
/// needs little more than h and u's old place. Each live triangle knows the collapse that last changed it: a collapse
/// can be undone once every triangle around its point is as it left it, so undoing one first undoes those that came
/// later there.
class CollapseMesh {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// The mesh must be closed and 2-manifold.
  explicit CollapseMesh(const TriMesh& mesh);

  std::size_t live_triangles() const { return live_triangles_; }
  bool live_triangle(std::uint32_t t) const { return !dead_[t]; }
  bool live_point(std::uint32_t v) const { return killed_by_[v] == none; }
  std::size_t points() const { return points_mm_.size(); }
  std::size_t triangles() const { return triangles_.size(); }
  Vec3 point_mm(std::uint32_t v) const { return points_mm_[v]; }
  const std::array<std::uint32_t, 3>& triangle(std::uint32_t t) const { return triangles_[t]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  std::uint32_t from(std::uint32_t h) const { return triangles_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next(h)); }

  /// Calls visit(h) for the half-edges that leave the live point v, in a fixed turn.
  template <class Visit>
  void for_each_leaving(std::uint32_t v, Visit&& visit) const {
    const std::uint32_t start = out_[v];
    std::uint32_t h = start;
    do {
      visit(h);
      h = twin_[previous(h)];
    } while (h != start);
  }

  /// The collapse leaves the surface a closed 2-manifold (link condition).
  bool keeps_manifold(std::uint32_t h);
  void collapse(std::uint32_t h, Vec3 place_mm);

  /// The collapse that last changed the triangle, or none.
  std::uint32_t last_change(std::uint32_t t) const { return changed_by_[t]; }
  /// Undoes the collapse, and first those that depend on it; calls undone(u, v) after each.
  void undo(std::uint32_t collapse, const std::function<void(std::uint32_t u, std::uint32_t v)>& undone);

  /// What is alive, as a mesh; triangle_of gives for each of its triangles the one here.
  TriMesh to_mesh(Vec3 origin_mm, std::vector<std::uint32_t>* triangle_of = nullptr) const;

 private:
  struct Record {
    std::uint32_t half_edge;
    Vec3 old_place_mm;
    std::size_t journal;  ///< into journal_: what last changed the triangles around u before
    bool undone = false;
  };
  void undo_now(std::uint32_t collapse);

  std::vector<Vec3> points_mm_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> twin_, out_, killed_by_, changed_by_, mark_;
  std::vector<char> dead_;
  std::vector<Record> records_;
  std::vector<std::uint32_t> journal_;
  std::uint32_t stamp_ = 0;
  std::size_t live_triangles_ = 0;
};

}  // namespace trephine
