// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::itk {

enum class DenoiseMethod { curvature, bilateral, median, gaussian, non_local_means };

struct DenoiseParams {
  DenoiseMethod method = DenoiseMethod::curvature;
  double sigma_mm = 0.8, edge_hu = 60;
  double search_mm = 3, patch_mm = 1;

  template <class V>
  static void describe(V& v) {
    using P = DenoiseParams;
    v.choice(
        &P::method, "method",
        {{"curvature", DenoiseMethod::curvature},
         {"bilateral", DenoiseMethod::bilateral},
         {"median", DenoiseMethod::median},
         {"gaussian", DenoiseMethod::gaussian},
         {"non_local_means", DenoiseMethod::non_local_means}},
        "Curvature anisotropic diffusion and the bilateral filter keep edges, the median keeps steps, the Gaussian "
        "keeps nothing; non-local means average voxels whose surroundings look alike.");
    v.number(
        &P::sigma_mm, "sigma_mm", Range{0.1, 10},
        "How far values are averaged: standard deviation of the Gaussian that does as much where there is no edge; "
        "half of the side of the median's cube. Not of non_local_means.");
    v.number(
        &P::edge_hu, "edge_hu", Range{1, 3000},
        "A step of this many HU over sigma_mm counts as an edge (curvature, bilateral): say about twice the noise. "
        "non_local_means takes half of this as the noise's standard deviation.");
    v.number(&P::search_mm, "search_mm", Range{0.5, 20},
             "non_local_means: how far away alike surroundings are sought.");
    v.number(&P::patch_mm, "patch_mm", Range{0, 5}, "non_local_means: half of the side of the cube that is compared.");
  }
};

/// What is printed of it.
struct DenoiseResult {
  std::size_t voxels_count = 0;
  std::optional<std::int64_t> iterations_count;
  double removed_hu = 0;
  template <class V>
  static void describe(V& v) {
    using P = DenoiseResult;
    v.integer(&P::voxels_count, "voxels_count", Range{}, "Voxels that were filtered.");
    v.integer(&P::iterations_count, "iterations_count", "Iterations, of the curvature flow.");
    v.number(&P::removed_hu, "removed_hu", Range{}, "Standard deviation of what was taken away within soft tissue.");
  }
};

/// The volume with less noise, by ITK's filters in a bounded child (itk_child.h), or by our own non-local means
/// (non_local_means.h). Where `within` is given, only the box
/// about the places where it is positive is filtered, with 4 sigma_mm (search_mm and patch_mm) around it; the rest
/// stays. Whole numbers stay whole numbers, rounded. The same bytes for every number of threads: every voxel is
/// computed by itself.
///
/// Curvature: [Whitaker2001] diffusion until a Gaussian of sigma_mm would be reached, in steps that are stable for the
/// smallest voxel side. Soft tissue is -100 to 100 HU. Throws 64 where sigma_mm (search_mm) is too
/// much for the voxels (5,000 steps each), 65 where a voxel is not finite, the Gaussian has fewer than
/// 4 voxels along an axis, or `within` is nowhere
/// positive; as itk_child::run.
Outcome<grid::HuVolume, DenoiseResult> denoise(const grid::HuVolume& volume, const grid::Field* within,
                                               const DenoiseParams& params, const Progress& progress = {});

}  // namespace trephine::itk
