// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/temporary_folder.h"

namespace trephine::dicom {

/// Where a volume lies that is no DICOM.
struct VolumeSource {
  std::string token;           ///< "s1", "s2", ...: by the file's name in a folder, by its place in a scene
  std::filesystem::path file;  ///< the volume file; of an archive, once it is unpacked
  std::string member;          ///< of an archive: which
  bool transformed = false;    ///< a scene lays a transform on it
  std::shared_ptr<TemporaryFolder> unpacked;
};

/// The volumes that a path means: a volume file (itk/volume_file.h); a folder that holds nothing but such files and
/// their data files; a scene of 3D Slicer (.mrml), whose files lie beneath its folder, or one in an archive (.mrb),
/// which is unpacked in the bounded child. Empty where the path is something else: DICOM, most likely. Throws as
/// scene_volumes and read_archive; 65 for a scene without a volume.
std::vector<VolumeSource> volume_sources(const std::filesystem::path& path, const Progress& progress = {});

/// The files that are read with `path` although they are neither it nor in it: the data files of volume files, the
/// files of a scene. What names them may be damaged: then they are not all here, and reading it throws.
std::vector<std::filesystem::path> files_beside(const std::filesystem::path& path);

/// Lays the file of an archive's member into a temporary folder that goes with the source. Throws Error 65 where the
/// scene lays a transform on the volume (harden it there), or the file is missing or of no format that is read.
void unpack(const std::filesystem::path& path, VolumeSource& source, const Progress& progress = {});

/// The one that `series` names ("s2"; what follows a '-' is the size, which import_volume compares), unpacked; without
/// a name the only one. No file: DICOM. Throws Error 64 where there are several and no choice, or none of that name; as
/// the two above.
VolumeSource chosen_volume(const std::filesystem::path& path, const std::string& series, const Progress& progress = {});

}  // namespace trephine::dicom
