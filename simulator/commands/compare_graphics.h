// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "peers/comparison.h"

namespace trephine::commands {

/// Draws meshes without a window, as a plain picture of 1280 x 720, and measures it. Names what draws; where nothing
/// can, the function is empty and `fault` says why. In a build with TREPHINE_HEADLESS it is always empty.
peers::DrawMesh mesh_drawer(std::string& renderer, std::string& fault);

}  // namespace trephine::commands
