// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"
#include "haptics/feel.h"
#include "haptics/haptic_state.h"

namespace trephine::haptics {

/// What is felt everywhere, also in air.
struct FreeParams {
  enum class Guide { none, line, plane };
  double viscosity_n_s_per_mm = 0;
  std::array<double, 3> weight_n{0, 0, 0};
  Guide guide = Guide::none;
  std::array<double, 3> guide_point_mm{0, 0, 0}, guide_along{0, 0, 1};
  double guide_n_per_mm = 0.3, guide_most_n = 1;
  template <class V>
  static void describe(V& v) {
    using P = FreeParams;
    v.number(&P::viscosity_n_s_per_mm, "viscosity_n_s_per_mm", Range{0, 0.1},
             "Force against each mm/s of the tool's motion, everywhere.");
    v.numbers(&P::weight_n, "weight_n", Range{-100, 100},
              "Weight of what the hand holds, along the case's axes (LPS); the force holds it up.");
    v.choice(&P::guide, "guide", {{"none", Guide::none}, {"line", Guide::line}, {"plane", Guide::plane}},
             "What leads the tool: a line through guide_point_mm, or the plane through it.");
    v.numbers(&P::guide_point_mm, "guide_point_mm", Range{-1e5, 1e5}, "A point of the guide, LPS.");
    v.numbers(&P::guide_along, "guide_along", Range{-1, 1},
              "Direction of the line, or normal of the plane; of any length but 0.");
    v.number(&P::guide_n_per_mm, "guide_n_per_mm", Range{0, 10}, "Force for each mm off the guide.");
    v.number(&P::guide_most_n, "guide_most_n", Range{0, 100}, "Largest force of the guide.");
  }
  bool any() const { return viscosity_n_s_per_mm > 0 || weight_n != std::array<double, 3>{} || guide != Guide::none; }
};

/// The force of FreeParams on the tool. It neither allocates nor locks; equal inputs give equal bits.
class FreeFeel {
 public:
  /// `cutoff_hz`: of the low-pass filter on the velocity (ForceParams::velocity_cutoff_hz). Throws Error 64 for a guide
  /// without a direction.
  FreeFeel(const FreeParams& params, double cutoff_hz);
  /// On the hand, in that tick.
  Vec3 force_n(const HapticInput& in);

 private:
  const FreeParams params_;
  const double slowness_s_;
  Vec3 along_, last_mm_, velocity_;
  bool known_ = false;
};

}  // namespace trephine::haptics
