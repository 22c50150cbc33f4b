// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "phantom/scan.h"
#include "phantom/slice_image.h"

namespace trephine::phantom {

/// HU of a body at a point of the scanner's frame, edges of tissues ramped over that width.
using HuAt = std::function<double(Vec3 lps_mm, double width_mm)>;

/// Artefacts of a slice, drawn after the kernel's blur.
using Artefacts = std::function<void(SliceImage&, const SlicePose&, double pixel_mm)>;

/// A body on the scanner of the head: averaged over the slice's thickness, then the kernel, artefacts and noise. The
/// same bytes whatever the thread count. Cancelled.
Scan scan_body(const HuAt& hu, const ScanParams& params, std::uint64_t seed, const Progress& progress = {},
               const Artefacts& artefacts = {});

/// What `label` says of the middle of each of the scan's voxels.
grid::Mask labelled(const Scan& scan, const std::function<int(Vec3 lps_mm)>& label);

/// The middle of the scanner's default block: where bodies that have a frame of their own are laid.
Vec3 default_centre_mm();

/// From a body's frame, whose origin is laid there, to the scanner's, as the body lies.
itk::LinearMap lies_at(Vec3 origin_mm, const ScanParams& params);

}  // namespace trephine::phantom
