// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Fewer triangles of a surface that marching cubes made, within a bound that is proven while they are merged.
///
/// Space is divided into boxes of 8 x 8 x 8 cells, of 4 x 4 x 4 and of 2 x 2 x 2 (half as many along an axis whose
/// spacing is more than 1.5 times the least). The largest box is taken in which every patch of the surface, which is
/// what is joined there, is a disc, lies between two planes that are at most `apart` apart, and has no triangle that
/// faces away from them. Such a patch becomes the polygon of its border, cut into triangles that face the same way. The
/// border runs over the box's sides, and its points there are thinned to lines that miss none of them by more than
/// `aside`; the boxes on both sides of a side share them. Where nothing can be merged the triangles stay as they are.
/// So every point of the result is a point of the input, and components and genus are the input's.
///
/// Why within_mm holds, with apart^2 + aside^2 = within_mm^2: seen along the planes' normal, a patch and its polygon
/// each cover what their borders wind around, because all their triangles face the same way. So a point of one is
/// covered by the other, and then no more than `apart` away, or a border passes over it while it is thinned, and then a
/// point of the other border lies `aside` away across the normal and `apart` along it.
class CellMerge {
 public:
  /// Whether two triangles of three different points each meet.
  using Meet = bool (*)(const std::array<std::uint32_t, 3>&, const std::array<Vec3, 3>&,
                        const std::array<std::uint32_t, 3>&, const std::array<Vec3, 3>&);

  /// `cubes` holds continuous indices of the lattice, as marching cubes make them: each point lies on one lattice edge,
  /// apart from its ends. It must outlive this. Parallel, with the same result whatever the thread count.
  CellMerge(const TriMesh& cubes, Vec3 spacing_mm, double within_mm, Meet meet, const Progress& progress);

  /// The merged surface, in the same frame.
  TriMesh mesh() const;
  /// Divides the boxes in which the places lie, in the same frame, each into the next smaller ones. Returns how many
  /// there were; what lies in no merged box counts for nothing.
  std::size_t divide(const std::vector<Vec3>& places, const Progress& progress);
  /// All that were divided so far, also because their polygons could not be cut or met.
  std::size_t boxes_divided_count() const { return boxes_divided_count_; }

 private:
  static constexpr int units = 4, units_in_block = units * units * units;
  using Triangle = std::array<std::uint32_t, 3>;
  /// A box of the largest size.
  struct Block {
    std::array<int, 3> low;                            ///< its first cell
    std::uint32_t first = 0, end = 0;                  ///< its triangles in order_, unit by unit
    std::array<std::uint32_t, units_in_block + 1> of;  ///< where those of a unit begin
    std::array<std::uint8_t, units_in_block> level{};  ///< of the box that holds the unit; 0: nothing is merged
    /// The borders of the patches of boxes: `begin` of each in `points`, of the box that begins with `unit`.
    struct Border {
      std::uint32_t begin, unit;
      Vec3 normal;
    };
    std::vector<Border> borders;
    std::vector<std::uint32_t> points;
    std::vector<char> corner;  ///< of each of them: three boxes or more meet there, and it stays
    std::vector<Triangle> triangles;
  };
  struct Box {
    Vec3 low, high;
  };
  struct Room;
  struct Where {
    std::int32_t block;
    int unit, level;
    bool same(const Where& o) const { return block == o.block && unit == o.unit && level == o.level; }
  };

  void sort();
  void choose(Block& block, Room& room) const;
  bool examine(const Block& block, int unit, int level, Room& room) const;
  void trace(std::int32_t at, Room& room);
  void thin(const std::vector<std::uint32_t>& line, bool bend);
  std::size_t cut(Block& block, Room& room) const;  ///< returns how many boxes were divided
  bool cut_polygon(const Box& box, Vec3 normal, Room& room, std::vector<Triangle>& out) const;
  void settle(std::vector<std::int32_t> changed, const Progress& progress);
  std::vector<std::int32_t> around(const std::vector<std::int32_t>& blocks) const;
  Where where(const std::array<int, 3>& cell) const;
  int others(std::uint32_t point, const Where& own, Where& other) const;
  Box box_of(const Block& block, int unit, int level) const;
  Vec3 mm(std::uint32_t point) const;

  const TriMesh& cubes_;
  Vec3 spacing_;
  double apart_, aside_;
  Meet meet_;
  std::array<int, 3> unit_{2, 2, 2}, low_{}, count_{};  ///< cells of a unit; the first cell; blocks along each axis
  std::vector<std::int32_t> block_at_;                  ///< number of the block, -1: nothing is there
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> order_;  ///< the triangles, block by block and unit by unit
  std::size_t boxes_divided_count_ = 0;
  std::vector<char> stays_;  ///< of each point on a side between two boxes: thinning left it
};

}  // namespace trephine::surface
