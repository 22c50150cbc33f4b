// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::mask {

/// A binary mask with one bit for each voxel. Rows (along x) take whole 64-bit words: 6 MB for 50 million voxels, and
/// morphology with a true ball in mm needs only a few word operations for each row. Bits beyond a row's end stay 0.
class BitMask {
 public:
  BitMask() = default;
  explicit BitMask(const grid::Lattice& lattice);

  const grid::Lattice& lattice() const { return lattice_; }
  int words() const { return words_; }
  std::uint64_t* row(int j, int k) { return bits_.data() + (std::size_t(k) * lattice_.size[1] + j) * words_; }
  const std::uint64_t* row(int j, int k) const { return const_cast<BitMask*>(this)->row(j, k); }
  bool get(int i, int j, int k) const { return row(j, k)[i >> 6] >> (i & 63) & 1; }
  /// Whether the voxel is set; false beyond the lattice.
  bool at(int i, int j, int k) const { return lattice_.contains(i, j, k) && get(i, j, k); }
  void set(int i, int j, int k) { row(j, k)[i >> 6] |= std::uint64_t{1} << (i & 63); }
  void clear(int i, int j, int k) { row(j, k)[i >> 6] &= ~(std::uint64_t{1} << (i & 63)); }

  std::size_t count() const;
  bool any() const;
  /// The smallest box around the set voxels; empty where there are none.
  grid::Box bounds() const;
  /// The mean of the set voxels' centres, LPS; the centre of the lattice's first voxel where there are none.
  Vec3 centre_mm() const;

  BitMask& operator&=(const BitMask& o);
  BitMask& operator|=(const BitMask& o);
  BitMask& remove(const BitMask& o);  ///< and not
  BitMask& invert();

 private:
  void trim();  ///< clears the bits beyond the rows' ends
  grid::Lattice lattice_;
  int words_ = 0;
  std::vector<std::uint64_t> bits_;
};

/// The voxels of one that are not, and that are, in the other; both on one lattice.
inline BitMask without(BitMask a, const BitMask& b) { return a.remove(b); }
inline BitMask both(BitMask a, const BitMask& b) { return a &= b; }

/// Calls test(j, k, row of flags), which fills one byte for each voxel. It is called in parallel, once for each row.
BitMask make_mask(const grid::Lattice& lattice, const std::function<void(int j, int k, std::uint8_t* row)>& test);
/// The voxels where the field is above 0, placed on `lattice` (of the same raster, else Error 65).
BitMask positive(const grid::Field& field, const grid::Lattice& lattice);
/// The part of the mask in `box`; the lattice is cropped(mask.lattice(), box).
BitMask crop(const BitMask& mask, const grid::Box& box);

/// The mask on another lattice of the same raster; voxels beyond that lattice are lost.
BitMask placed(const BitMask& mask, const grid::Lattice& lattice);

/// All voxels whose centre is within radius_mm of the centre of a set voxel (a ball in mm, whatever the spacing).
/// Beyond the lattice's edge everything counts as background when a mask is dilated and as foreground when it is
/// eroded, so a mask neither grows nor shrinks there. Throws Error 65 where the ball has more than 40,000 rows of
/// voxels (a radius of 113).
BitMask dilated(const BitMask& mask, double radius_mm, const Progress& progress = {});
BitMask eroded(const BitMask& mask, double radius_mm, const Progress& progress = {});
BitMask closed(const BitMask& mask, double radius_mm, const Progress& progress = {});
/// One step of dilation to the 6 face neighbours.
BitMask dilated_6(const BitMask& mask);
/// `mask` grown inside `domain` along paths of face neighbours, up to radius_mm from its start.
BitMask grown_within(const BitMask& mask, const BitMask& domain, double radius_mm, const Progress& progress = {});

struct Component {
  std::size_t voxels = 0;
  grid::Box box;
  int faces = 0;  ///< how many of the lattice's six faces it touches
};

/// Connected components, found by runs: by face neighbours, or by all 26. They are numbered in the order of their first
/// voxel.
struct Components {
  struct Run {
    std::int32_t begin, end, component;
  };
  grid::Lattice lattice;
  std::vector<Run> runs;
  std::vector<std::size_t> row_start;  ///< index into runs of each row, and the end
  std::vector<Component> list;
};
Components components(const BitMask& mask, bool diagonal = false);
/// Calls visit(component, i, j, k) for every voxel, in the order of memory.
template <class Visit>
void for_each_voxel(const Components& c, const Visit& visit) {
  const int ny = c.lattice.size[1];
  for (std::size_t row = 0; row + 1 < c.row_start.size(); ++row)
    for (std::size_t r = c.row_start[row]; r < c.row_start[row + 1]; ++r)
      for (int i = c.runs[r].begin; i < c.runs[r].end; ++i)
        visit(int(c.runs[r].component), i, int(row % ny), int(row / ny));
}
/// The union of the components for which keep[component] is not 0.
BitMask select(const Components& components, const std::vector<char>& keep);
/// The union of the components of at least `ml`.
BitMask at_least_ml(const Components& components, double ml);
/// The component with most voxels (the first of equals); empty where there is none.
BitMask largest(const Components& components);
/// keep[c] is 1 where component c has a voxel in `other` (on the same lattice).
std::vector<char> touching(const Components& components, const BitMask& other);

}  // namespace trephine::mask
