// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "dicom/geometry.h"

namespace trephine::dicom {

/// Cubic Hermite interpolation with three-point tangents on four samples, as weights; the caller limits the result to
/// the samples' range. It is exact for parabolas, has a continuous slope, and is the identity at a sample.
using Weights = std::array<double, 4>;
/// The weights at t in [0, 1] between the middle two of four equidistant samples.
Weights cubic_weights(double t);
/// The weights at a place between x[1] and x[2]; x ascends, and may repeat an end where there is no further sample.
Weights cubic_weights(const std::array<double, 4>& x, double at);

/// The levels of which a target slice is made: four ascending indices with weights, or one level as it is.
struct Taps {
  std::array<int, 4> level{};
  Weights weight{};
  bool exact = false;  ///< level[1] alone
  int first() const { return exact ? level[1] : level[0]; }
  int last() const { return exact ? level[1] : level[3]; }
};
Taps taps_of(const StackGeometry& geometry, int target_slice);

/// Moves a stored slice into the target's plane by its shift in columns and rows (sub-voxel; Lagrange's polynomial of
/// eight samples, limited to the range of the middle four). Voxels that the slice does not reach get `air`. `out`
/// receives target columns x rows.
void shift_slice(const std::vector<float>& slice, int columns, int rows, const std::array<double, 2>& shift,
                 int target_columns, int target_rows, float air, std::vector<float>& out);

/// Makes one target slice from the slices of its levels, in the order of taps.level.
template <class T>
void blend(const Taps& taps, const std::array<const float*, 4>& slices, std::size_t count, T* out);

extern template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, std::int16_t*);
extern template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, float*);

}  // namespace trephine::dicom
