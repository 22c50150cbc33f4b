// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "render/coarse.h"
#include "scene/view_params.h"
#include "window/texts.h"

namespace trephine {

/// Where pictures take longer than they should, their quality is reduced step by step, beginning with what is missed
/// least: smooth edges and the darkening of creases; grain; triangles far from the tool; the tool's shadow and half of
/// the pixels. No surface is ever left out. Where pictures are then much quicker than they need to be, the last step is
/// taken back, at most twice.
class Reduction {
 public:
  /// `target_ms` 0: nothing is ever left out. `software`: the processor draws, so the first step is taken at once.
  Reduction(double target_ms, const ViewParams& whole, const Coarseness& coarse, bool software);
  /// Of each picture: how long it took. Returns whether another step holds from now on.
  bool look(double ms);

  int level() const { return level_; }
  ViewParams view() const;
  double scale() const { return level_ >= 4 ? 0.5 : 1; }
  Coarseness coarse() const { return level_ >= 3 ? coarse_ : Coarseness{0, coarse_.fine_mm}; }
  /// What is left out; empty where nothing is.
  std::string text(Language language) const;

 private:
  static constexpr int most = 4;
  double target_ms_;
  ViewParams whole_;
  Coarseness coarse_;
  int level_ = 0, quick_ = 0, raised_ = 0;
  std::vector<double> times_;
};

}  // namespace trephine
