// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>

#include "base/vec3.h"

namespace trephine::itk {

constexpr const char* read_worker_name = "itk-read";
constexpr const char* write_worker_name = "itk-write";

/// The formats that ITK reads for us, and of which it writes all but NRRD.
enum class ItkFormat : std::int32_t { meta_image, nrrd, gipl, vtk, minc };
/// What voxels are written as.
enum class ItkSample : std::int32_t { int16, float32, uint8 };

/// Head of the answer to a format and a file's path; then the keys that are not known (their number, and each as a
/// text), and the voxels, int16 or float, i fastest. The geometry is as ITK gives it, unchecked.
struct ItkVolume {
  std::array<std::int32_t, 3> size{};
  std::int32_t is_int16 = 0;
  std::array<double, 3> spacing{}, origin{};
  std::array<std::array<double, 3>, 3> axis{};  ///< direction of axis k
};

}  // namespace trephine::itk
