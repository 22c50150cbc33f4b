// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

namespace trephine::tissue {

/// A shaft that tissue holds on a line bends between there and the hand: a beam that is clamped where it enters, as
/// long as what is still outside, with the tissue's own spring in series. Its energy is that of one spring, K off^2 / 2
/// with 1 / K = 1 / wall + free^3 / (3 rigidity), so the force has a part along the shaft: a shaft that is bent and
/// pushed on becomes shorter and stiffer, which the hand pays for.
struct BentShaft {
  double rigidity_n_mm2 = 0;  ///< E I; 0: rigid
  double length_mm = 0;

  struct Springs {
    double across_n_per_mm = 0;  ///< K
    double along_n_per_mm2 = 0;  ///< times off^2: the force that pushes the shaft out
  };
  Springs at(double wall_n_per_mm, double depth_mm) const {
    if (!(rigidity_n_mm2 > 0) || !(wall_n_per_mm > 0)) return {wall_n_per_mm, 0};
    const double free_mm = std::max(0.0, length_mm - std::max(0.0, depth_mm));
    const double k = 1 / (1 / wall_n_per_mm + free_mm * free_mm * free_mm / (3 * rigidity_n_mm2));
    const bool moves = depth_mm > 0 && free_mm > 0;
    return {k, moves ? 0.5 * k * k * free_mm * free_mm / rigidity_n_mm2 : 0};
  }
};

}  // namespace trephine::tissue
