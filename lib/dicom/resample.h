// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "dicom/geometry.h"

namespace trephine::dicom {

/// Cubic Hermite interpolation with three-point tangents on four samples, as weights; the result is to be limited to
/// the samples' range. Exact for parabolas, continuous in its slope, and the identity at a sample.
using Weights = std::array<double, 4>;
/// At t in [0, 1] between the middle samples of four equidistant ones.
Weights cubic_weights(double t);
/// At x between x[1] and x[2]; x ascends, and may repeat an end where there is no further sample.
Weights cubic_weights(const std::array<double, 4>& x, double at);

/// Which levels a target slice is made of: four ascending indices with weights, or one level as it is.
struct Taps {
  std::array<int, 4> level{};
  Weights weight{};
  bool exact = false;  ///< level[1] alone
  int first() const { return exact ? level[1] : level[0]; }
  int last() const { return exact ? level[1] : level[3]; }
};
Taps taps_of(const StackGeometry& geometry, int target_slice);

/// Moves a stored slice into the target's plane by its shift in columns and rows (sub-voxel; Lagrange's polynomial of
/// eight samples, limited to the range of the middle four); `air` where the slice does not reach. `out` gets target
/// columns x rows.
void shift_slice(const std::vector<float>& slice, int columns, int rows, const std::array<double, 2>& shift,
                 int target_columns, int target_rows, float air, std::vector<float>& out);

/// One target slice from its levels' slices, in the order of taps.level.
template <class T>
void blend(const Taps& taps, const std::array<const float*, 4>& slices, std::size_t count, T* out);

extern template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, std::int16_t*);
extern template void blend(const Taps&, const std::array<const float*, 4>&, std::size_t, float*);

}  // namespace trephine::dicom
