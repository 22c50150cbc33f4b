// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "render/coarse.h"
#include "scene/view_params.h"
#include "window/texts.h"

namespace trephine::window {

/// What a picture costs where the processor draws: its time by the clock, or what all threads of the program took of
/// CPU as half of the cores would have done it, whichever is more. The other half is left to the servo loop.
double software_cost_ms(double ms, double cpu_ms, unsigned cores);

/// Where pictures take longer than they should, their quality is reduced step by step, beginning with what is missed
/// least: smooth edges and the darkening of creases; grain; triangles far from the tool, which become larger from step
/// to step (coarse_sizes_mm), or at once where pictures take much too long; the tool's shadow and half of the pixels.
/// No surface is ever left out. Where pictures are then much quicker than they need to be, the last step is taken back,
/// at most twice.
class Reduction {
 public:
  /// `target_ms` 0: nothing is ever left out. `whole`: the view as it is wanted; its coarse_mm, if there is one, is the
  /// only size of triangles. `software`: the processor draws, so the first step is taken at once.
  Reduction(double target_ms, const scene::ViewParams& whole, double fine_mm, bool software);
  /// Of each picture: how long it took. Returns whether another step holds from now on.
  bool look(double ms);

  int level() const { return level_; }
  scene::ViewParams view() const;
  double scale() const { return level_ >= most ? 0.5 : 1; }
  render::Coarseness coarse() const { return {level_ >= coarse_level ? sizes_mm_[size_] : 0, fine_mm_}; }
  /// What is left out; empty where nothing is.
  std::string text(texts::Language language) const;

 private:
  static constexpr int coarse_level = 3, most = 4;
  void reduce(double too_long);
  void raise();
  double target_ms_;
  scene::ViewParams whole_;
  double fine_mm_;
  std::vector<double> sizes_mm_;
  std::size_t size_ = 0;
  int level_ = 0, quick_ = 0, raised_ = 0;
  std::vector<double> times_;
};

}  // namespace trephine::window
