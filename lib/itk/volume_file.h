// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::itk {

/// A volume of one value a voxel from a file that is no DICOM. LPS, mm; whole numbers as int16 where all fit.
struct VolumeFile {
  grid::HuVolume volume;
  std::string format;  ///< "NIfTI", "Analyze", "NRRD", "MetaImage", "GIPL", "VTK image", "MINC"
  std::vector<std::string> warnings;
  std::string modality{};  ///< "CT", "MR", ...: what the file says; empty where it says none
};

/// Whether the file's name ends in `ending` (".nii.gz", lower case), whatever its own case.
bool has_ending(const std::filesystem::path& file, std::string_view ending);

/// The volume files that a path means: the file itself, or those of a folder that holds nothing else but them and their
/// data files, by name. Empty where the path is something else (DICOM, most likely). Nothing is read but names and the
/// first bytes.
std::vector<std::filesystem::path> find_volume_files(const std::filesystem::path& file_or_folder);

/// Reads NIfTI (.nii, .nii.gz) and NRRD (.nrrd, raw and gzip) with our own parsers in a bounded child, and MetaImage
/// (.mha, .mhd), NRRD with a data file of its own or in another encoding (.nhdr), GIPL (.gipl, .gipl.gz), VTK's legacy
/// image (.vtk) and MINC 2 (.mnc) with ITK in a bounded child. What ITK makes of a file is not taken on trust: it is
/// read twice, into memory of different content, so that a voxel that the file does not hold shows; a MetaImage must
/// say its spacing, place and direction, and ITK must have understood the same (as must the attributes of a MINC file,
/// whose RAS becomes LPS); the bytes must be as many as the header says; a data file must lie beside its header.
///
/// GIPL and VTK do not say which way the axes lie: they are taken as LPS, with a warning. A header and an image in two
/// files (.hdr with .img or .img.gz) are NIfTI or Analyze 7.5, which does not say which side is left: then
/// `analyze_axes` must, as join_image_pair says (grid/image_pair.h), with a warning. Metres and micrometres become mm
/// where the file has units.
///
/// Throws Error 66; 64 where analyze_axes is missing, or given for another format; 65 naming the field: damaged,
/// sheared axes, colours, more than one volume, a voxel that is not finite, over 4e9 voxels; 70 as run_child.
VolumeFile read_volume_file(const std::filesystem::path& file, const Progress& progress = {},
                            const std::string& analyze_axes = "");

/// The file beside a header (.mhd, .nhdr, .hdr) that holds its voxels; empty where they are in the file itself. Throws
/// Error 65 where the header is refused.
std::filesystem::path data_file_of(const std::filesystem::path& file);
/// Hash of the bytes of the file and of its data file. Throws as read_volume_file does.
std::string hash_of_volume_file(const std::filesystem::path& file);

}  // namespace trephine::itk
