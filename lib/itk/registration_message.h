// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "itk/transform.h"

namespace trephine::itk {

/// What the two sides of a registration say to each other (registration.h, program/register_worker.cpp): the task, then
/// for each of the three levels the fixed grid and the moving one, values from 0 to 1, then the mask of the places to
/// look at as a grid of the coarsest level (above 0: looked at).
constexpr const char* register_worker_name = "itk-register";
constexpr int registration_levels = 3;

struct RegistrationTask {
  std::int32_t affine = 0, has_initial = 0, bins = 32, samples = 60000;
  LinearMap initial;
};

struct RegistrationFound {
  LinearMap map;
  double information = 0;    ///< mutual information, nats
  double spread_mm = 0;      ///< how far apart the perturbed starts ended
  double inverse_mm = 0;     ///< how far the other direction's result is from the inverse
  double overlap_ratio = 0;  ///< share of the samples that lie in the moving scan
  double margin_ratio = 0;   ///< 1 - information 20 mm off / information
  double scale_ratio = 0;    ///< largest stretch of an affine registration that goes on from a rigid one
};

}  // namespace trephine::itk
