// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

namespace trephine::itk {

/// What is said before the grid (program/denoise_worker.cpp); the answer is the grid's samples.
constexpr const char* denoise_worker_name = "itk-denoise";
struct DenoiseTask {
  std::int32_t method = 0, iterations = 0;
  double sigma_mm = 1, edge_hu = 60, step = 0.03;
};

}  // namespace trephine::itk
