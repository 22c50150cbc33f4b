// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "dicom/import.h"
#include "dicom/volume_source.h"

namespace trephine::dicom {

/// import_series of the volume that was chosen among those of `path`. Where params.volume_values is hu, the values must
/// look like a CT's HU: voxels below -500 HU lie mostly at air (-1000), there is soft tissue, and it is not stored with
/// another offset. Values below -1024 are padding and become air. Throws Error 64 where volume_values is unsaid, or
/// where params.series names a size ("s2-512x512x108") that the volume has not; 65 where the values do not look like
/// HU; and as read_volume_file. An error in an archive names the archive.
ImportResult import_volume(const std::filesystem::path& path, const VolumeSource& volume, const ImportParams& params,
                           const Progress& progress = {});
/// hash_of_volume_file of it; an error names `path` too.
std::string hash_of_volume(const std::filesystem::path& path, const VolumeSource& volume);

/// list_series of the volumes that a path means (volume_source.h); nothing of a file's or a volume's name is told.
SeriesList list_volumes(const std::filesystem::path& path, std::vector<VolumeSource> volumes,
                        const ImportParams& params, const Progress& progress = {});

}  // namespace trephine::dicom
