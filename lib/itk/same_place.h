// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/progress.h"
#include "grid/grid.h"
#include "itk/transform.h"

namespace trephine::itk {

/// Whether the map moves nothing: both scans are then said to be reconstructions of one scan (two kernels).
bool is_identity(const LinearMap& map);

/// From this Dice of their bones on, two reconstructions of one scan are believed to be such: two kernels give 0.95, a
/// head that moved by 3 mm 0.7.
constexpr double min_bone_ratio = 0.85;

/// How well the bones of two CT scans in HU lie upon each other, each where its positions say: Dice of the cells of 2
/// mm whose mean is above 300 HU in both, where both reach. Neither noise nor what a kernel sharpens counts in such
/// means. 0 where there is no bone. The same on any number of threads.
double bone_ratio(const grid::HuVolume& fixed, const grid::HuVolume& moving, const Progress& progress = {});

/// The largest distance between the places to which the two maps lead what is above -300 HU in the CT.
double apart_mm(const grid::HuVolume& fixed, const LinearMap& a, const LinearMap& b);

}  // namespace trephine::itk
