// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "itk/transform.h"

namespace trephine::itk {

/// Whether the name ends as a transform's file does: .tfm (text), .h5 (HDF5).
bool is_transform_file(const std::filesystem::path& file);

/// Reads ITK's transform file, as text (.tfm, .txt; transform.h) or HDF5 (.h5, .hdf5), as ITK, 3D Slicer, ANTs and
/// elastix write them: a linear transform, or a composite of linear ones, which become one. HDF5 is read by ITK in a
/// bounded child. Throws Error 66; 65 with the file: a transform that is not linear, of another dimension or not to be
/// inverted, a damaged file; as itk_child::run.
LinearMap read_transform(const std::filesystem::path& file);

/// Writes the map as one AffineTransform_double_3_3, in the format that the name's ending says, without date, user or
/// machine, which ITK writes into HDF5. Throws Error 64 for another ending, 73 and 74 as write_file.
void write_transform(const std::filesystem::path& file, const LinearMap& map);

}  // namespace trephine::itk
