// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace trephine::grid {

/// A header of 348 bytes and an image in two files (.hdr, .img or .img.gz): NIfTI-1, or Analyze 7.5, from which it came
/// (analyzedirect.com, "Analyze 7.5 file format").
struct ImagePair {
  std::string nifti;  ///< the bytes of one NIfTI file that says the same, for decode_nifti
  bool is_analyze = false;
  std::vector<std::string> warnings;
};

/// Analyze says neither to which sides its axes rise nor where it lies, so `analyze_axes` must say the sides: three
/// letters, of R or L, A or P, S or I, for the axes in the order of the file. "LAS" is a volume whose columns rise to
/// the left, whose rows rise forwards and whose slices rise upwards. Its first voxel is placed at 0, with a warning.
/// SPM's scale and offset are applied, with a warning. For NIfTI `analyze_axes` must be empty.
///
/// Throws Error 64 where analyze_axes is missing or makes no sense; 65 naming the field: neither of the two, units that
/// are not mm, a voxel's size that is not positive, more or fewer bytes than the voxels need.
ImagePair join_image_pair(std::string_view header, std::string_view image, bool gzip, const std::string& analyze_axes);

}  // namespace trephine::grid
