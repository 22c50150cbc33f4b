// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "grid/grid.h"
#include "voxel/transfer.h"

namespace trephine::cast {

/// A resolved transfer function as an editor changes it; points are counted from 0. Its points remain such as
/// voxel::fault_of_points allows: they ascend, and the first is clear.
///
/// A point to whole HU, no farther than its neighbours allow.
voxel::TransferFunction with_moved(voxel::TransferFunction f, std::size_t point, double hu, double opacity);
voxel::TransferFunction with_colour(voxel::TransferFunction f, std::size_t point, std::array<double, 3> colour_rgb);
struct AddedPoint {
  voxel::TransferFunction function;
  std::size_t point = 0;
};
/// With the colour and the stiffness that the function has there; nothing where there are 64 points already, or two at
/// these HU.
std::optional<AddedPoint> with_added(voxel::TransferFunction f, double hu, double opacity);
/// Without it; of two points both remain.
voxel::TransferFunction with_removed(voxel::TransferFunction f, std::size_t point);

/// "150:0:ede3c7,300:0.97:ede3c7", as voxel::transfer_from_text reads it; colours of 8 bits.
std::string points_text(const voxel::TransferFunction& f);
/// "ede3c7".
std::string colour_text(const std::array<double, 3>& colour_rgb);

/// A file of a resolved function, in the part of YAML that is JSON: a scene takes it as `transfer_file`, --transfer and
/// the window by its name. It keeps every bit.
std::string transfer_file_text(const voxel::TransferFunction& f);
/// Reads such a file, for who sees by it: that what is touched is one range of HU is not asked. Throws Error 66, and 65
/// naming the file and the key.
voxel::TransferFunction read_transfer_file(const std::filesystem::path& file);
/// What --transfer gives: a preset, points, or the name of a file, which ends in .yaml. Throws as
/// voxel::transfer_from_text and read_transfer_file do.
voxel::TransferFunction transfer_of(const std::string& text, const std::string& flag);

/// How many voxels of a volume have which HU.
struct HuHistogram {
  static constexpr int bin_hu = 16, bins = (voxel::transfer_high_hu + 1 - voxel::transfer_low_hu) / bin_hu;
  /// HU beyond the ends are counted in the outermost bins.
  std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(bins, 0);

  HuHistogram() = default;
  explicit HuHistogram(const grid::Grid<std::int16_t>& voxels);
  /// A bin's height, from 0 to 1: by the logarithm, for air is most of a scan.
  double height(int bin) const;

 private:
  std::uint64_t most_ = 0;
};

}  // namespace trephine::cast
