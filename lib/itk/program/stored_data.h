// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>

#include "itk/volume_header.h"

namespace trephine::itk {

/// ITK reads as many bytes as a header says and passes over what else is there. Throws Error 65 where the voxels'
/// bytes, inflated where they are compressed, are more or fewer than `wanted`, or where something follows them.
void require_as_many(const VolumeHeader& header, const std::filesystem::path& file, std::uint64_t wanted);

}  // namespace trephine::itk
