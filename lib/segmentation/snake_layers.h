// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/parallel.h"
#include "grid/grid.h"
#include "mask/bits.h"
#include "segmentation/snake_spacing.h"

namespace trephine::segmentation {

/// The voxels about the zero crossing of phi, and phi's distances there. Layer 0 is the voxels with a face neighbour on
/// the other side; layers 1 and 2 are their neighbours and the neighbours of those. In all three phi is a distance, mm,
/// positive inside; elsewhere it is stale until finish().
///
/// Who moves the surface writes phi in layer 0, tells set_inside() what that changed, and calls relayer(). Words are 64
/// voxels of a row, as in BitMask. The same bits whatever the thread count.
class BandLayers {
 public:
  /// phi must outlive this, and is changed by it alone and by who moves the surface.
  explicit BandLayers(grid::Grid<float>& phi);

  /// Finds the layers from the signs of phi, which may be in any unit, and makes phi a distance in them.
  void begin();
  /// Finds them again after phi changed in layer 0. No voxel may have moved by more than its smallest side.
  void relayer();
  /// Gives phi one and the same value, of its sign, everywhere outside the layers.
  void finish();

  std::size_t inside_count() const;                       ///< voxels
  std::size_t band_count() const { return band_count_; }  ///< voxels in layer 0
  std::uint64_t inside(int j, int w, int k) const { return inside_.row(j, k)[w]; }
  /// For one slice at a time from one thread; others may do the same with other slices.
  void set_inside(int j, int w, int k, std::uint64_t bits) {
    std::uint64_t& in = inside_.row(j, k)[w];
    slices_[std::size_t(k)].inside += std::size_t(__builtin_popcountll(bits)) - std::size_t(__builtin_popcountll(in));
    in = bits;
  }
  /// Which voxels of the word are in one of the layers.
  std::uint64_t band(int j, int w, int k) const {
    return layer0_.row(j, k)[w] | layer1_.row(j, k)[w] | layer2_.row(j, k)[w];
  }

  /// f(k) for every slice, by several threads.
  template <class F>
  void for_all_slices(F&& f) const {
    for_slices(everything_, f);
  }
  /// f(j, w) for every word of a slice, in the order of memory.
  template <class F>
  void for_all_words(F&& f) const {
    for_words(everything_, f);
  }
  /// f(j, w, bits) for every word of slice k with voxels of layer 0, in the order of memory.
  template <class F>
  void for_layer0(int k, F&& f) const {
    const Slice& s = slices_[std::size_t(k)];
    if (!s.any) return;
    for_words(s.reach, [&](int j, int w) {
      if (const std::uint64_t bits = layer0_.row(j, k)[w]) f(j, w, bits);
    });
  }
  /// f(i, b) for every bit b of word w that is set: voxel i of the row.
  template <class F>
  static void for_bits(std::uint64_t bits, int w, F&& f) {
    for (; bits; bits &= bits - 1) {
      const int b = __builtin_ctzll(bits);
      f(w * 64 + b, b);
    }
  }

  /// The rows and words that a part of the lattice covers.
  struct Reach {
    int j0 = 0, j1 = 0, k0 = 0, k1 = 0, w0 = 0, w1 = 0;
  };

 private:
  struct Slice {
    std::size_t inside = 0, band = 0;
    Reach reach;  ///< of layer 0, where there is `any` of it
    bool any = false;
  };

  template <class F>
  static void for_slices(const Reach& r, F&& f) {
    parallel_for(r.k0, r.k1, 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < int(to); ++k) f(k);
    });
  }
  template <class F>
  static void for_words(const Reach& r, F&& f) {
    for (int j = r.j0; j < r.j1; ++j)
      for (int w = r.w0; w < r.w1; ++w) f(j, w);
  }

  std::uint64_t crossing(int w, int j, int k) const;
  float first_distance(int i, int j, int k) const;
  void set_from(const mask::BitMask& from, std::uint64_t bits, int w, int j, int k);
  void measure_layer0(const Reach& cover);
  Reach grown(const Reach& r) const;
  void rebuild_outer(const Reach& cover);
  void outer(const Reach& cover, const mask::BitMask& from, const mask::BitMask& innermost, mask::BitMask& to);

  const grid::Lattice l_;
  grid::Grid<float>& phi_;
  const SnakeSpacing s_;
  mask::BitMask inside_, layer0_, layer1_, layer2_, next0_;
  std::vector<Slice> slices_;
  Reach everything_, reach_, before_;  ///< the lattice; layer 0, now and a step ago
  std::size_t band_count_ = 0;
};

}  // namespace trephine::segmentation
