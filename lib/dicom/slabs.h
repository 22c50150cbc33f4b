// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "dicom/catalogue.h"

namespace trephine::dicom {

/// Parts the slices of one stack by their AcquisitionNumber where acquisitions lie within each other, into as few scans
/// as there are: slabs of several acquisitions that follow one another are one scan, and so are slabs that overlap by
/// less than half of the shorter one at the same positions (there the lower slab's slices count). The scan of most
/// slices comes first. What is left (a slab that was scanned again, the scan after contrast agent) is parted likewise.
/// Where no acquisitions overlap, everything is one scan.
std::vector<std::vector<FrameRef>> part_by_acquisition(std::vector<FrameRef> stack);

/// Marks the series that only scan a part of a larger one again: Series::part_of. They have its UID, study, frame of
/// reference and kernel, lie within its ends, and have less than half of its slices.
void find_rescans(std::vector<Series>& series);

}  // namespace trephine::dicom
