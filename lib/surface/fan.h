// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "surface/incidence.h"
#include "surface/trimesh.h"

namespace trephine::surface {

/// Whether two triangles around p certainly meet only in what they share. This is so where, seen along the sum of their
/// normals, all of them turn the same way about p and go around it once, because each then has its own sector of the
/// plane. Rounding is allowed for.
bool is_fan(const TriMesh& mesh, const Incidence& incidence, std::uint32_t p);

}  // namespace trephine::surface
