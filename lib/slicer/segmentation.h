// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "grid/grid.h"
#include "pacs/object.h"

namespace trephine::slicer {

/// A segmentation as 3D Slicer's .seg.nrrd with terminology (slicer.readthedocs.io, developer guide, Segmentations and
/// Terminologies): what each segment is in SNOMED CT, from the table that DICOM segmentations have too. Segments that
/// share voxels lie in layers of their own; others share a layer, so that few layers are needed. The bits of a segment
/// are those of pacs::bits_inside on pacs::slices_of(lattice). Throws Error 70 where there is no segment, or more than
/// 255.
std::string encode_segmentation(const grid::Lattice& lattice, const std::vector<pacs::Segment>& segments);

/// The ID of segment n, counted from 0.
std::string segment_id(std::size_t n);

}  // namespace trephine::slicer
