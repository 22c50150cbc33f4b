// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Something dense and thin in a scan, a catheter or a line, followed along its middle between the voxels.
#include <functional>
#include <vector>

#include "outcome/line.h"

namespace trephine::outcome {

class ScanView;

/// How a thing is followed: what is looked at across it, and when it ends.
struct TraceParams {
  double disc_mm = 3.6, ring_from_mm = 4.4, ring_to_mm = 6;
  double most_around_hu = 80;  ///< what lies about it is taken for no denser than this
  bool in_air = false;         ///< where that is air, as in a lung, it counts as air; else as tissue
  double thick_ratio = 2;      ///< of what is dense across it: more is bone, or something else
  int bridged_steps = 0;       ///< so many obscured steps without it are passed where it goes straight on
  int tip_steps = 24;          ///< it is straight over so many before its end
  double most_aside_mm = 1.6;  ///< in one step
  int turn_steps = 8;          ///< its direction is that of the last so many
  /// Places of the scan that are something else, bone: they count as nothing. Empty: all count.
  std::function<bool(Vec3)> is_other = {};
};

/// What is denser than tissue across a line.
struct Section {
  bool beyond = false;    ///< the scan ends there
  bool obscured = false;  ///< something else lies across it too, or part of what is about it is air
  double sum = 0;         ///< HU mm^2
  double around_hu = 0;   ///< of what lies about it
  double peak = 0;        ///< HU above what is around
  Vec3 middle_mm;
};
Section section_of(const ScanView& scan, Vec3 at, const Frame& across, const TraceParams& params);

struct Step {
  Vec3 at_mm;
  Section section;
};

/// The median of the last so many steps' sums.
double median_sum(const std::vector<Step>& steps, std::size_t most);

/// From a place on it to its end, every half millimetre, in scan coordinates; `reference` is its sum.
std::vector<Step> followed(const ScanView& scan, Vec3 from, Vec3 way, double reference, const TraceParams& params);

/// Where its sum drops to half beyond the last steps, and what a rounded end reaches beyond that.
Vec3 tip_of(const ScanView& scan, const std::vector<Step>& towards_tip, const TraceParams& params);

/// Full width at half height there: of its sum and peak, as if it were Gaussian.
double width_mm(const Section& section);

}  // namespace trephine::outcome
