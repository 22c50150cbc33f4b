// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "itk/volume_header.h"

namespace trephine::itk {

/// Our own look at formats of which ITK passes over what changes voxels or their places, before it reads them
/// (docs/reference/volume-files.md). The geometry is what the file says; require_same compares ITK's with it.

/// A legacy VTK image (VTK User's Guide, "Legacy File Formats"): its header's lines, and that one array of as many
/// scalars as the header says is all that follows. Throws Error 65 naming the key: one is missing or given twice, says
/// another kind of data set, of array or of values; more or fewer values. `unknown`: keys that VTK does not know.
VolumeHeader check_vtk_file(const std::string& file);

/// A GIPL file, gzip or not: its header of 256 bytes, and that as many bytes follow as the voxels need, with the right
/// checksum where it is compressed. Throws Error 65 naming the field: one that would scale the values or turn the axes
/// (matrix, pixval_offset, pixval_cal, interslice_gap, orientation), a type or size that is not read, more or fewer
/// bytes, more than a scan grows to.
VolumeHeader check_gipl_file(const std::string& file);

}  // namespace trephine::itk
