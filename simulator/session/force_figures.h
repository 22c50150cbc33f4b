// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptics/frame.h"

namespace trephine::session {

/// How good forces are, by the measure of [Rizzi, chapter 4] and by what that measure leaves out.
struct ForceFigures {
  std::uint64_t frames = 0, touching = 0;
  double anomaly_ratio = 0;     ///< share of d|F|/dt (central differences) outside mean +- 10 sigma
  double zero_force_ratio = 0;  ///< frames without force
  double max_step_n = 0, sigma_n_per_s = 0, mean_force_n = 0, most_force_n = 0;
  double mean_lag_mm = 0,
         max_lag_mm = 0;  ///< while touching: distance of the proxy behind the device, along the surface
};
/// The frames by which forces are judged, [begin, end): from `settle_s` after the first contact, when the tool has
/// struck the surface, to the end, because a contact that is lost for good counts most. Empty where there is no
/// contact.
struct ForceWindow {
  std::size_t begin = 0, end = 0;
};
ForceWindow force_window(const std::vector<haptics::ServoFrame>& frames, double settle_s = 0.5);
/// The figures of the window; all are zero where it is empty.
ForceFigures force_figures(const std::vector<haptics::ServoFrame>& frames, const ForceWindow& window);
/// The frames that anomaly_ratio counts [Rizzi, Table III], by their places in `frames`.
std::vector<std::size_t> force_anomalies(const std::vector<haptics::ServoFrame>& frames, const ForceWindow& window);

}  // namespace trephine::session
