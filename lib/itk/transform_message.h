// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

namespace trephine::itk {

/// What is asked of the worker (program/transform_worker.cpp), then a file's path, then, to write, the map as the nine
/// numbers of its matrix row by row and its offset. The answer to `read`: for each transform of the file its type as
/// text, its parameters and its fixed parameters as arrays.
constexpr const char* transform_worker_name = "itk-transform";
enum class TransformTask : std::int32_t { read, write };

}  // namespace trephine::itk
