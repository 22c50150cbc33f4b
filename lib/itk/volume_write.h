// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/labels.h"
#include "grid/nrrd.h"

namespace trephine::itk {

/// The endings of names that write_volume_file takes: .nrrd .nii .nii.gz .mha .gipl .gipl.gz .vtk .mnc.
const std::vector<std::string>& written_volume_endings();

/// Writes a volume, a field or labels in the format that the file's ending says: NRRD and NIfTI with our own writers,
/// MetaImage, GIPL, VTK's legacy image and MINC 2 by trephine-itk. Nothing of a patient, no date and no name of a user
/// goes into the file; the same voxels give the same bytes. The file is read back before it gets its name: the same
/// voxels, and every corner within 0.001 mm (NIfTI and GIPL hold float32).
///
/// Throws Error 64 for another ending, 65 where the format cannot say where the volume lies (GIPL and VTK hold no
/// directions) or how large it is, 73 and 74 as write_file, as itk_child::run.
void write_volume_file(const std::filesystem::path& file, const grid::AnyGrid& grid, const Progress& progress = {});

/// The voxels of a volume file as they are stored: NRRD and NIfTI keep uint8; what ITK reads is int16 or float, as
/// read_volume_file gives it. `format` (may be null) becomes the format's name, `warnings` what is to be said. Throws
/// as read_volume_file.
grid::AnyGrid read_grid_file(const std::filesystem::path& file, std::string* format, std::vector<std::string>* warnings,
                             const Progress& progress = {}, const std::string& analyze_axes = "");

/// read_labels of every format that write_volume_file writes (not of two files: a cache knows the one that is named).
grid::LabelFile read_label_file(const std::filesystem::path& file, const Progress& progress = {});

}  // namespace trephine::itk
