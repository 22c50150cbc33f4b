// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "grid/gzip_limit.h"
#include "grid/nrrd.h"

namespace trephine::grid {

/// One volume of NIfTI-1 or NIfTI-2 (nifti.nimh.nih.gov), .nii or .nii.gz, either byte order.
struct Nifti {
  AnyGrid grid;       ///< int16 or uint8 where every value fits, else float; LPS, mm
  std::string frame;  ///< source of the position: "sform", "qform", or "pixdim" where the position is not known
  std::vector<std::string> warnings;
};

/// Whether the bytes begin as such a file, or a gzip stream, does.
bool may_be_nifti(std::string_view bytes);

/// Reads a NIfTI file. The file's RAS becomes LPS; metres and micrometres become mm; scl_slope and scl_inter are
/// applied. The sform is used where it has a code, else the qform, else only the voxels' size. Memory is allocated only
/// for data that exists, and that `limit` allows where it is compressed; what else the header says is in
/// reference/volume-files.md. Throws Error 70 where memory is too little; Error 65 naming the field, without a file:
/// not NIfTI, a pair of header and image, a datatype of colours or complex numbers, more than one volume, axes that are
/// not orthogonal, sizes that the bytes do not fill or exceed, a place beyond 1 km, a voxel that is not finite.
///
/// This is our own code and not Debian's niftilib: of 3,000 damaged headers and truncated files, niftilib read 94 % as
/// if they were whole, making up the missing data, and 2 % as volumes of over four times the file's size.
Nifti decode_nifti(std::string_view bytes, GzipLimit limit = labels_limit);

/// The bytes of a NIfTI-1 file (.nii, or .nii.gz with `gzip`, which holds no time or name): mm, RAS, the place as
/// float32 in the sform and, where its quaternion is exact to 0.005 mm, in the qform, and nothing of a patient. Where
/// float32 does not say the place to the last bit, a comment extension does, which decode_nifti takes as long as the
/// sform is the same. Throws
/// Error 65 where an axis has more than 32,767 voxels.
std::string encode_nifti(const HuVolume& volume, bool gzip);
std::string encode_nifti(const Mask& mask, bool gzip);

}  // namespace trephine::grid
