// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "grid/grid.h"
#include "surface/float_box.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// The triangles of a mesh by the cells of a lattice in which they lie, where they come row by row, as marching cubes
/// make them. Finds which of them can meet without a search tree.
class CellRows {
 public:
  /// Nothing where a triangle reaches a quarter of a cell beyond the cell of its centre, or where the triangles are in
  /// another order. Otherwise triangles whose cells do not touch lie half a cell apart at least.
  static std::optional<CellRows> of(const TriMesh& mesh, const grid::Lattice& lattice);

  std::size_t rows() const { return first_.size() - 1; }

  /// Calls visit(s, t), s < t, for the triangles s of the row and all t in the cells that touch theirs whose boxes
  /// meet.
  template <class Visit>
  void for_each_near_pair(std::size_t row, const Visit& visit) const {
    // The rows that touch this one and come after it, and where in each of them the search goes on.
    struct Window {
      std::uint32_t from, end;
    };
    std::array<Window, 4> later;
    int windows = 0;
    const auto column = static_cast<int>(row % static_cast<std::size_t>(along_));
    const auto add = [&](std::size_t other) {
      if (other < rows() && first_[other] < first_[other + 1]) later[windows++] = {first_[other], first_[other + 1]};
    };
    if (column + 1 < along_) add(row + 1);
    for (int d = -1; d <= 1; ++d)
      if (column + d >= 0 && column + d < along_) add(row + static_cast<std::size_t>(along_ + d));
    for (std::uint32_t s = first_[row]; s < first_[row + 1]; ++s) {
      for (std::uint32_t t = s + 1; t < first_[row + 1] && cell_[t] <= cell_[s] + 1; ++t)
        if (boxes_[s].meets(boxes_[t])) visit(s, t);
      for (int w = 0; w < windows; ++w) {
        Window& o = later[w];
        while (o.from < o.end && cell_[o.from] < cell_[s] - 1) ++o.from;
        for (std::uint32_t t = o.from; t < o.end && cell_[t] <= cell_[s] + 1; ++t)
          if (boxes_[s].meets(boxes_[t])) visit(s, t);
      }
    }
  }

 private:
  int along_ = 0;                     ///< rows of one layer
  std::vector<std::uint32_t> first_;  ///< of each row, and the end of the last
  std::vector<std::int32_t> cell_;    ///< of each triangle, along its row
  std::vector<FloatBox> boxes_;
};

}  // namespace trephine::surface
