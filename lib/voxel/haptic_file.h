// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "grid/nrrd.h"
#include "voxel/haptic_volume.h"

namespace trephine::voxel {

/// The key by which the NRRD of a haptic volume is recognized.
constexpr const char* haptic_file_key = "trephine-haptic";

/// A haptic volume as NRRD (int16, raw, LPS; 3D Slicer opens it) whose keys say what the values mean:
///   trephine-haptic  {"version": 1, "encoding": "occupancy", "shapes": [{"name", "number", "window": [low, high]}]}
/// Hardness is a second file of its own. The bytes are the same for the same volume.
std::string encode_haptic(const HapticVolume& volume);
std::string encode_hardness(const HapticVolume& volume);

/// The simulator's reader: it bounds everything by the bytes that exist, then calls check_haptic_volume. `hardness` may
/// be empty. Throws Error 65 naming the field.
HapticVolume decode_haptic(std::string_view bytes, std::string_view hardness = {});

/// The same for a NRRD that was read already.
HapticVolume haptic_of(grid::AnyGrid voxels, const grid::NrrdKeys& keys);

/// The same for files. Writing throws Error 73 and 74; reading throws 66 and 65.
void write_haptic(const std::filesystem::path& file, const HapticVolume& volume);
HapticVolume read_haptic(const std::filesystem::path& file);

}  // namespace trephine::voxel
