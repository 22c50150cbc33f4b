// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "picture/image.h"
#include "surface/trimesh.h"

namespace trephine::picture {

/// The signed distance of each of the mesh's points to the reference, world mm, positive outside of it. The reference
/// should be closed and oriented.
std::vector<double> signed_deviations_mm(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                                         const Progress& progress = {});

/// The mesh from four sides, coloured by its signed distance to the reference: blue where it lies inside, grey where it
/// lies on it, red where it lies outside, with full colour at full_scale_mm (0: the 99th percentile of the points'
/// distances), and with a scale. The same bytes whatever the thread count. Throws Error 65 as check_mesh does, and for
/// a surface without triangles.
Image deviation_picture(const surface::TriMesh& mesh, const surface::TriMesh& reference, double full_scale_mm = 0,
                        const Progress& progress = {});

}  // namespace trephine::picture
