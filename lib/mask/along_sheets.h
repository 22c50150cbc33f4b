// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "mask/bits.h"

namespace trephine::segmentation {

/// Averages each known voxel with known ones beside it in the plane that edges and sheets about it lie in: a Gaussian
/// of `sigma_mm` along the plane, hardly any across. A cleft of fluid 2 mm wide keeps its depth while noise falls as if
/// over 4 pi sigma^2. The plane is square to the principal direction of the structure tensor (Weickert, Anisotropic
/// Diffusion in Image Processing, 1998), of gradients at `edge_sigma_mm`, over `tensor_sigma_mm`; where nothing has a
/// direction it is any plane. Voxels not known keep their value.
Grid<float> averaged_along_sheets(const Grid<float>& hu, const BitMask& known, double sigma_mm,
                                  const Progress& progress = {});

}  // namespace trephine::segmentation
