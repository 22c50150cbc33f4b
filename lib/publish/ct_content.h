// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::publish {

/// Bounds of the middles of the lattice's voxels, LPS mm.
surface::Bounds bounds_of_lattice(const grid::Lattice& lattice);

/// The part of a scan that a case publishes: the whole voxels that `shown`, grown by the margin, touches. HU that are
/// not whole are rounded, and values beyond int16 take its ends. Throws Error 70 where the scan does not reach there.
grid::Grid<std::int16_t> published_ct(const grid::HuVolume& scan, const surface::Bounds& shown, double margin_mm);

}  // namespace trephine::publish
