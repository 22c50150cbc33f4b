// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "base/vec3.h"

namespace trephine::surface {

/// Distance to a surface that is known: positive outside, negative inside, at a world point. Called from several
/// threads.
using DistanceFunction = std::function<double(Vec3 world_mm)>;

}  // namespace trephine::surface
