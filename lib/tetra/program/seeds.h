// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "surface/trimesh.h"

namespace trephine::tetra {

/// A corner of a surface with which the refinement begins, and the regions on its two sides.
struct Seed {
  Vec3 world_mm;
  std::array<int, 2> between;
};

class Regions;  // tetra/program/regions.h

/// Corners of every piece of every surface, spread at about twice `size_mm`, and closer on a piece that is too small
/// for four of them: so none is overlooked. Corners that are no border between two regions are left out.
std::vector<Seed> seeds_of(const std::vector<surface::TriMesh>& surfaces, const Regions& regions, double size_mm);

}  // namespace trephine::tetra
