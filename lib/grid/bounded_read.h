// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "grid/labels.h"
#include "grid/nrrd.h"

namespace trephine::grid {

/// Files of strangers, read by the parsers of this room in a bounded child (base/child.h): whatever is in them, the
/// caller lives, and neither memory nor time is taken beyond what bytes of that count can need. These functions throw
/// what the parsers throw, without a file, and Error 70 where the child dies or reaches a limit.
///
/// The programs that call them begin with run_child_if_asked.
struct BoundedGrid {
  AnyGrid grid;
  NrrdKeys keys;            ///< of a NRRD
  bool is_analyze = false;  ///< of a pair
  std::vector<std::string> warnings;
};

/// read_nrrd; decode_nifti of a file; join_image_pair and decode_nifti of a header and its image. The voxels are those
/// of a scan (`scan_limit`) or of labels, a field or a mask.
BoundedGrid read_nrrd_bounded(const std::filesystem::path& file, GzipLimit limit, const Progress& progress = {});
BoundedGrid read_nifti_bounded(const std::filesystem::path& file, GzipLimit limit, const Progress& progress = {});
BoundedGrid read_pair_bounded(const std::filesystem::path& header, const std::filesystem::path& image,
                              const std::string& analyze_axes, const Progress& progress = {});

/// decode_labels of a file, or of bytes.
LabelFile read_labels_bounded(const std::filesystem::path& file, const Progress& progress = {});
LabelFile decode_labels_bounded(std::string_view bytes, const Progress& progress = {});

/// read_nrrd_bounded as read_hu_nrrd and its siblings read it (grid/nrrd.h); the errors name the file.
HuVolume read_foreign_hu(const std::filesystem::path& file);
Field read_foreign_field(const std::filesystem::path& file);
Mask read_foreign_mask(const std::filesystem::path& file);

}  // namespace trephine::grid
