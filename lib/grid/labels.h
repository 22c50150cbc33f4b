// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "grid/nrrd.h"

namespace trephine::grid {

/// One segment that a .seg.nrrd of 3D Slicer describes.
struct LabelSegment {
  std::string id, name;
  int value = 1, layer = 0;
  bool cropped = false;  ///< the segment says that it reaches beyond the file's voxels
};

/// A file of labels: a label map (NRRD, NIfTI), or segments (.seg.nrrd), several layers of which may overlap.
struct LabelFile {
  Lattice lattice;  ///< LPS, mm
  int layers = 1;
  AnyGrid samples;  ///< (layer, i, j, k) at lattice.index(i, j, k) * layers + layer
  std::vector<LabelSegment> segments;
  std::string format;  ///< "NRRD", "seg.nrrd", "NIfTI"
  std::vector<std::string> warnings;
};

/// Decides by the content of the bytes, not by a name. Throws Error 65 naming the field, without a file: the faults of
/// read_nrrd and decode_nifti; neither of the two formats; a fractional segmentation.
LabelFile decode_labels(std::string_view bytes);
/// The same for a file, in a bounded child (grid/bounded_read.h); throws Error 66, and 65 and 70 with the file.
LabelFile read_labels(const std::filesystem::path& file);

/// Voxels that another reader read, as labels. Throws Error 65 where one is negative or no whole number.
LabelFile labels_of(AnyGrid samples, const std::string& format);

/// The bytes of a NRRD file (gzip) that decode_labels reads back: a map of one layer of uint8 or int16, its segments by
/// name, ID and value. Throws Error 70 for any other map.
std::string encode_labels(const LabelFile& map);

/// A label taken from a file: 1 where the label is, on the map's lattice.
struct PickedLabel {
  Mask mask;
  std::string name;  ///< of the segment, or the value
  std::size_t voxels = 0;
};

/// Picks the label by its value ("3"), by a segment's name or ID ("brain"; upper and lower case are alike where only
/// one name matches), several of them together ("4, 43, third ventricle"), or, for "", everything that is not 0. Throws
/// Error 65 for field "label": there is no such name or value (naming those that exist), a name or value occurs in
/// several segments or layers, or samples are not whole numbers.
PickedLabel pick_label(const LabelFile& map, const std::string& label);

}  // namespace trephine::grid
