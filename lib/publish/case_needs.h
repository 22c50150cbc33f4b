// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/report.h"
#include "config/config.h"
#include "mask/shape_interpolate.h"

namespace trephine::publish {

/// What building one case needs, by the number of its scan's voxels and of the anatomies that are shown or felt: an
/// estimate from measured cases. Memory is a quarter too low to a third too high (docs/validation/speed.md), disk to
/// about a factor of two. Noise, and the triangles that the anatomies may have, change it. Slices that are added
/// between thick ones, and what is cut off, memory_need() counts, and a library's plan before the first build of a case
/// does not.
struct CaseNeeds {
  double memory_mb = 0, disk_mb = 0;
  double cache_mb = 0;  ///< on disk as well, but the cache has a limit
};
CaseNeeds case_needs(std::uint64_t voxels_count, std::size_t anatomies_count, bool with_ct, bool with_page);

/// "250 MB", "1.2 GB".
std::string megabytes_text(double mb);

/// Throws Error 73, which says both sizes and how to begin all the same, where less than `need_mb` is free on the disk
/// of the folder. Where the system does not say what is free, nothing is refused.
void require_disk(const std::filesystem::path& folder, double need_mb);

/// The warning that a case took longer than the budget by which its point of a front was chosen; empty where it did
/// not. A budget of time cannot be enforced: the case is complete and valid, only later than wanted.
std::vector<std::string> overrun(const config::CaseTrade& trade, double seconds);

/// What a case takes here by a point of a front that a rule chose: the point's seconds, as much longer as this machine
/// is slower than the one that measured it (calibration_seconds(), a fifth of a second). Empty without a rule, and
/// where the front does not say how fast its machine was.
std::string seconds_expected(const config::CaseTrade& trade);

/// A scan's raster as its report says it; zeros where that says nothing.
struct ScanRaster {
  std::array<double, 3> voxels_count{}, spacing_mm{};
  std::uint64_t count() const;
  /// On voxels of these sizes; 0 keeps an axis as it is.
  ScanRaster on_voxels(const std::array<double, 3>& spacing_mm) const;
  /// At most so long along each axis.
  ScanRaster within(double length_mm) const;
};
ScanRaster raster_of(const dicom::ImportFigures& scan);

/// What memory the case will take, and how much there is; empty for scans of less than a million voxels. `scan` as it
/// was read, `used` as it goes into the stages; `interpolated`: how slices are added to what is segmented, null where
/// none are.
struct MemoryNeed {
  std::string text;
  /// Where there is too little: what to do. Larger voxels are named where the estimate then fits.
  std::string remedy;
};
MemoryNeed memory_need(const ScanRaster& scan, const ScanRaster& used, std::size_t anatomies_count,
                       const mask::ShapeInterpolateParams* interpolated);

/// From now on what a stage frees in large blocks goes back to the system at once, and is not kept for the next one:
/// in a scan of 50 million voxels this saves 120 MB for one second of work. A small scan changes nothing. It holds for
/// the whole process from then on.
void give_large_blocks_back(const ScanRaster& scan);

}  // namespace trephine::publish
