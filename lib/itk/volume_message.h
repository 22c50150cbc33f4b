// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "base/vec3.h"

namespace trephine {

constexpr const char* read_worker_name = "itk-read";

/// The formats that ITK reads for us.
enum class ItkFormat : std::int32_t { meta_image, nrrd, gipl, vtk };

/// Head of the answer to a format and a file's path; then the voxels, int16 or float, i fastest. The geometry is as ITK
/// gives it, unchecked.
struct ItkVolume {
  std::array<std::int32_t, 3> size{};
  std::int32_t is_int16 = 0;
  std::array<double, 3> spacing{}, origin{};
  std::array<std::array<double, 3>, 3> axis{};  ///< direction of axis k
};

}  // namespace trephine
