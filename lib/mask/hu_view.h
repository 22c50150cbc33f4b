// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/report.h"
#include "mask/bits.h"

namespace trephine::mask {

/// The volume's samples as float, whatever type they are stored in.
class HuView {
 public:
  explicit HuView(const grid::HuVolume& v)
      : i16_(std::get_if<grid::Grid<std::int16_t>>(&v)),
        f32_(std::get_if<grid::Grid<float>>(&v)),
        lattice_(grid::lattice_of(v)) {}
  explicit HuView(const grid::Grid<float>& v) : i16_(nullptr), f32_(&v), lattice_(v) {}
  float operator()(std::size_t index) const { return i16_ ? float(i16_->voxels[index]) : f32_->voxels[index]; }
  float operator()(int i, int j, int k) const { return (*this)(lattice_.index(i, j, k)); }
  bool is_integer() const { return i16_ != nullptr; }
  const grid::Lattice& lattice() const { return lattice_; }

 private:
  const grid::Grid<std::int16_t>* i16_;
  const grid::Grid<float>* f32_;
  const grid::Lattice& lattice_;
};

/// The voxels of more than `threshold`.
BitMask above(const HuView& hu, double threshold);

/// The box as float HU.
grid::Grid<float> crop(const HuView& hu, const grid::Box& box);

/// The box of voxels whose centres lie within the region of interest, which is given by its corners in LPS mm. The box
/// is exact for volumes along the axes and encloses the region for oblique ones. Throws Error 80 where there are none,
/// 64 where the lower corner lies beyond the upper one.
grid::Box region_of_interest(const grid::Lattice& lattice, const std::array<double, 3>& roi_min_mm,
                             const std::array<double, 3>& roi_max_mm);

struct FillRule {
  double close_mm = 0;
  double max_ml = 1000;
  bool cut_open = false;  ///< a cavity that only one face of the lattice cuts open counts as enclosed
};
/// The voxels that are not in `shape` and cannot be reached from outside. The outside consists of the components of the
/// closed shape's complement that touch the lattice's edge or exceed max_ml, grown back by close_mm along free paths.
BitMask holes(const BitMask& shape, const FillRule& rule, const Progress& progress = {});

/// How large a mask is.
struct MaskSize {
  std::size_t voxels_count = 0;
  double volume_ml = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&MaskSize::voxels_count, "voxels_count", Range{}, "Voxels inside.");
    v.number(&MaskSize::volume_ml, "volume_ml", Range{}, "Their volume.");
  }
};

/// Throws Error 80 where the mask is empty, fills the volume, or is flat.
MaskSize check_mask(const BitMask& mask, std::size_t volume_voxels);

/// Throws Error 80 where all voxels are alike, so that the volume cannot show what other fields say is in it.
void check_varies(const grid::HuVolume& volume);

/// Throws Error 65 where a voxel is NaN or infinite.
void check_finite(const grid::HuVolume& volume);

}  // namespace trephine::mask
