// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "voxel/transfer.h"

namespace trephine::voxel {

constexpr std::size_t max_transfer_points = 64;

/// What is wrong with points for who only sees by them; "" where nothing is: there are two or more, they ascend, at
/// most two lie at the same HU, the first is clear, and all or none have a stiffness. What is touched is not asked:
/// TransferFunction::fault does.
std::string fault_of_points(const std::vector<TransferPoint>& points);

}  // namespace trephine::voxel
