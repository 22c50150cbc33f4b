// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "dicom/elements.h"
#include "grid/labels.h"
#include "pacs/object.h"

namespace trephine::pacs {

/// Labels in a DICOM object: what a segmentation or a structure set holds, on slices of its own.
struct LabelObject {
  SliceSet slices;  ///< every slice that the object names, without images
  std::vector<Segment> segments;
  std::string format;  ///< "DICOM SEG", "RT structure set"
};

/// Reads a BINARY segmentation as it is stored, or the closed contours of an RT structure set, filled by parity on
/// pixels of 0.5 mm (larger ones where more than 2,048 were needed). Contours of one plane that lie within each other
/// are holes. Planes within 0.1 mm are one. Between its own planes a region is interpolated by its shape where other
/// regions have planes there; where a step is more than three times those beside it, its pieces are separate. The bytes
/// are not trusted: lengths are checked before anything is read (dicom/elements.h). Throws Error 65 naming the tag:
/// another kind of object, a fractional segmentation or one of labels, compressed pixels, planes that are not parallel,
/// frames beside each other on one plane, more than 255 segments or 10,000 slices. Throws Error 70 where there is too
/// little memory for them.
LabelObject decode_label_object(const dicom::Origin& origin);

/// The labels on an upright uniform lattice, as import_series makes it of the slices: those on such slices as they are,
/// voxel for voxel. Others are interpolated by their shape [Raya1990]: each slice's signed distance, moved within its
/// plane where slices are tilted, and linearly between slices. A slice without pixels of a segment is empty; so is what
/// lies half a step beyond the last slice. Segments that overlap are in layers.
grid::LabelFile label_file_of(const LabelObject& object, const Progress& progress = {});

/// itk::read_label_file, and of a file that begins as DICOM does what the two functions above make of it.
grid::LabelFile read_label_file(const std::filesystem::path& file, const Progress& progress = {});

}  // namespace trephine::pacs
