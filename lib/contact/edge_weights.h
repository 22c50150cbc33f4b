// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

namespace trephine::contact {

/// About an edge (RoundEdge): how far samples are looked for.
constexpr double edge_far_voxels = 3.2;
/// How many samples of a face are enough.
constexpr int least_face_samples = 3;

/// How much a sample counts. What lies far along the edge counts less, for an edge may be curved.
inline double weight_along_edge(double along_mm, double voxel_mm) {
  const double off = along_mm / (edge_far_voxels * voxel_mm);
  return std::max(0.02, (1 - off * off) * (1 - off * off));
}

}  // namespace trephine::contact
