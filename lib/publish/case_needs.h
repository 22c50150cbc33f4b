// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "base/report.h"

namespace trephine::publish {

/// What building one case needs, by the number of its scan's voxels and of the anatomies that are shown or felt: an
/// estimate from measured cases. Memory is mostly right within 20 % (docs/speed.md), disk to about a factor of two.
/// Noise, and the triangles that the anatomies may have, change it.
struct CaseNeeds {
  double memory_mb = 0, disk_mb = 0;
  double cache_mb = 0;  ///< on disk as well, but the cache has a limit
};
CaseNeeds case_needs(std::uint64_t voxels_count, std::size_t anatomies_count, bool with_ct, bool with_page);

/// The voxels of a scan that was read, by its report's figure `size` ("512x512x200"); 0 where that says nothing.
std::uint64_t voxels_by_report(const Report& scan);

/// "250 MB", "1.2 GB".
std::string megabytes_text(double mb);

/// Throws Error 73, which says both sizes and how to begin all the same, where less than `need_mb` is free on the disk
/// of the folder. Where the system does not say what is free, nothing is refused.
void require_disk(const std::filesystem::path& folder, double need_mb);

/// Logs what memory the case will take, as a warning with what to do where that is more than is available; nothing for
/// scans of less than a million voxels.
void tell_memory(const std::string& case_token, std::uint64_t voxels_count, double need_mb);

}  // namespace trephine::publish
