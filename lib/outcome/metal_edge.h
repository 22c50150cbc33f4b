// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <utility>
#include <vector>

namespace trephine::outcome {

/// A voxel near an axis: how far along it and from it, and what is there.
struct AxisVoxel {
  double along_mm, off_mm, hu;
  double slice_mm;  ///< how far off the axis its slice's middle lies
};

/// Where metal ends in a scan that may clip it: the edge, and the standard deviation of its blur, whose profile fits
/// best what is seen on voxels (place, HU) at places that rise outwards. `metal` is its HU, `most` the most that the
/// scan shows. Interpolated HU would not do: beside a clipped voxel they are too low. Nothing of fewer than 12 voxels.
struct MetalEdge {
  double at_mm = 0, blur_mm = 0;
};
std::optional<MetalEdge> metal_edge(const std::vector<std::pair<double, double>>& hu_at, double metal, double most);

/// Where the tip of a shaft ends along its axis, by the voxels about it: a slice averages the cone with what is beside
/// it, by how far off the axis it lies and how thick it is. `metal`: its HU, and the most that the scan shows. The cone
/// is one of 5 mm with a blunt end; that of another screw leaves the tip some tenths of a mm off. Nothing of fewer
/// than 12 voxels.
std::optional<double> tip_end(const std::vector<AxisVoxel>& core, double radius_mm, double slice_mm,
                              const std::pair<double, double>& metal);

}  // namespace trephine::outcome
