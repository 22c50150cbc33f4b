// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "itk/volume_message.h"

namespace trephine::itk {

/// The geometry that a MINC 2 file says, read from its HDF5 attributes without libminc and turned from MINC's RAS to
/// LPS: ITK 5.2 hands MINC's coordinates over as if they were LPS, which would exchange left and right, front and back.
/// Throws Error 65: not MINC 2, not three dimensions in space, irregular spacing, units that are not mm, a
/// start, step or direction that is missing.
ItkVolume minc_geometry(const std::string& file);

/// Attributes and objects that MINC does not know, as they may be told (a file that minc_geometry has passed). Throws
/// Error 65 for those that would change place or values: an alignment that is not the voxels' centre, an image that
/// says it is not complete.
std::vector<std::string> minc_unknown_keys(const std::string& file);

/// What two readers of the same voxels must agree in.
struct ValueFigures {
  double smallest = 0, largest = 0, sum = 0;
  std::uint64_t count = 0;
  void add(double v) {
    smallest = count == 0 ? v : std::min(smallest, v);
    largest = count == 0 ? v : std::max(largest, v);
    sum += v;
    ++count;
  }
  bool agree(const ValueFigures& b) const {
    const double near = 1e-5 * (std::fabs(smallest) + std::fabs(largest)) + 1e-12;
    return count == b.count && count > 0 && std::fabs(smallest - b.smallest) <= near &&
           std::fabs(largest - b.largest) <= near && std::fabs(sum - b.sum) <= near * static_cast<double>(count);
  }
};

/// The figures of the voxels by what the file says of them (valid_range, image-min and image-max, one number or one for
/// each slice), read without libminc, which takes 0, 1 and the type's range for what is missing. Throws Error 65: one
/// of these is missing or damaged, the range is not the type's, the file has lost a part of the image.
ValueFigures minc_values(const std::string& file);

/// Writes a MINC 2 file: voxels as they are, without scaling, dates, history and the name of the user, which libminc
/// writes into each file. Throws Error 74.
void write_minc(const std::string& file, const ItkVolume& head, ItkSample sample, std::string_view voxels);

}  // namespace trephine::itk
