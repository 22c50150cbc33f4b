// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/report.h"

namespace trephine::publish {

/// What building one case needs, by the number of its scan's voxels: a rough estimate from measured cases, right to
/// about a factor of two. Noise, the anatomies of the scene and the triangles that they may have change it.
struct CaseNeeds {
  double memory_mb = 0, disk_mb = 0;
  double cache_mb = 0;  ///< on disk as well, but the cache has a limit
};
CaseNeeds case_needs(std::uint64_t voxels_count, bool with_ct, bool with_page);

/// The voxels of a scan that was read, by its report's figure `size` ("512x512x200"); 0 where that says nothing.
std::uint64_t voxels_by_report(const Report& scan);

/// "250 MB", "1.2 GB".
std::string megabytes_text(double mb);

/// Throws Error 73, which says both sizes and how to begin all the same, where less than `need_mb` is free on the disk
/// of the folder. Where the system does not say what is free, nothing is refused.
void require_disk(const std::filesystem::path& folder, double need_mb);

}  // namespace trephine::publish
