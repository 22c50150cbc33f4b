// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <vector>

namespace trephine::tissue {

/// How the spring of a tissue relaxes, as a standard linear solid does: one spring, and beside it another one in series
/// with a damper. Together they give the whole force at once; of a deformation that is held, `rest_ratio` of it
/// remains, and what is above that decreases by a factor of e in `time_s`.
struct SolidLaw {
  double rest_ratio = 1, time_s = 0;
  bool relaxes() const { return time_s > 0 && rest_ratio < 1; }
};

/// One contact with such a tissue. A tissue that is left faster than it comes back gives no force, and never pulls; one
/// that is met anew is as if it had never been touched. Over any path of the tool it gives no more than it took: with
/// the force between two ticks taken as their mean, exactly so, whatever the ticks. The force is never above that of
/// the whole spring.
class Relaxation {
 public:
  /// What is left of the spring's force in a tick, 0 to 1. `whole_n`: the force of the whole spring, so that ramps and
  /// springs that give way count as deformations do.
  double share(const SolidLaw& law, double whole_n, double dt_s) const {
    return whole_n > 0 ? law.rest_ratio + (1 - law.rest_ratio) * delayed(law, whole_n, dt_s) / whole_n : 1;
  }
  /// That tick has been.
  void pass(const SolidLaw& law, double whole_n, double dt_s) {
    delayed_n_ = delayed(law, whole_n, dt_s);
    whole_n_ = whole_n;
  }
  void reset() { whole_n_ = delayed_n_ = 0; }

 private:
  // Of the spring with the damper, in forces of the whole spring. The mean of two ticks flows through the damper, so
  // that it takes energy in every tick; a tick as long as twice the time takes all of it.
  double delayed(const SolidLaw& law, double whole_n, double dt_s) const {
    const double half = 0.5 * std::min(2.0, dt_s / law.time_s);
    const double next = ((1 - half) * delayed_n_ + (whole_n - whole_n_)) / (1 + half);
    return std::max(next, -law.rest_ratio / (1 - law.rest_ratio) * whole_n);
  }
  double whole_n_ = 0, delayed_n_ = 0;
};

/// Those of all shapes that are touched, by number. A tick asks share() of any force, notes the one that is, and
/// passes. Only the constructor allocates.
class Relaxations {
 public:
  explicit Relaxations(std::vector<SolidLaw> laws) : laws_(std::move(laws)), of_(laws_.size()), noted_n_(laws_.size()) {
    for (std::size_t n = 0; n < laws_.size(); ++n)
      if (laws_[n].relaxes()) relaxing_.push_back(n);
  }
  void begin_tick(double dt_s) { dt_s_ = dt_s; }
  bool relaxes(int shape) const { return laws_[std::size_t(shape)].relaxes(); }
  double share(int shape, double whole_n) const {
    const std::size_t n = std::size_t(shape);
    return laws_[n].relaxes() ? of_[n].share(laws_[n], whole_n, dt_s_) : 1;
  }
  void note(int shape, double whole_n) { noted_n_[std::size_t(shape)] = whole_n; }
  void end_tick() {
    for (const std::size_t n : relaxing_) {
      if (noted_n_[n] > 0)
        of_[n].pass(laws_[n], noted_n_[n], dt_s_);
      else
        of_[n].reset();
      noted_n_[n] = 0;
    }
  }
  void reset() {
    for (const std::size_t n : relaxing_) of_[n].reset();
  }

 private:
  std::vector<SolidLaw> laws_;
  std::vector<Relaxation> of_;
  std::vector<double> noted_n_;
  std::vector<std::size_t> relaxing_;
  double dt_s_ = 0.001;
};

}  // namespace trephine::tissue
