// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "surface/trimesh.h"

namespace trephine {

/// The process remembers the last few dozen meshes that passed check_validity, by the SHA-256 of their points and
/// triangles, so that what one step has checked the next need not check again. Any thread.
void remember_valid(const TriMesh& mesh);
bool known_valid(const TriMesh& mesh);

}  // namespace trephine
