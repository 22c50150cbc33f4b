// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"

namespace trephine::drill {

struct HeatParams {
  double irrigation_ml_per_min = 40, irrigation_c = 22, heat_into_bone_ratio = 0.2;
  template <class V>
  static void describe(V& v) {
    using P = HeatParams;
    v.number(&P::irrigation_ml_per_min, "irrigation_ml_per_min", Range{0, 1000},
             "Saline that flows over the cutter while it runs; 0: it drills dry.");
    v.number(&P::irrigation_c, "irrigation_c", Range{0, 45}, "Its temperature, in degrees Celsius.");
    v.number(&P::heat_into_bone_ratio, "heat_into_bone_ratio", Range{0, 1},
             "Share of the drill's power that stays in the bone as heat; chips carry the rest away.");
  }
};

/// How warm the bone at a cutter becomes: a figure to compare strokes by, not a forecast. The bone is a shell of 1 mm
/// around the half of the cutter's ball that lies in it, of one temperature. It gains a share of the power that
/// removes bone, and loses heat through the half space of bone around it, whose conductance is 2 pi k R, and to the
/// saline, by its film but by no more than what flows can take. Conductivity, density and heat capacity of cortical
/// bone are measured values [Davidson2000] [Davidson2003]; the film's coefficient and the share are ours. The dose is
/// the equivalent minutes at 43 degrees [Sapareto1984]; bone was seen to suffer from a minute at 47 [Eriksson1983].
class BoneHeat {
 public:
  static constexpr double body_c = 37, harm_c = 47, harm_s = 60;
  BoneHeat(const HeatParams& params, double cutter_radius_mm);
  /// Another burr is in hand: the bone about it is as warm as that about the last one was.
  void set_radius(double cutter_radius_mm);
  /// `power_w`: what removes bone in that step; `runs`: the saline flows. It does not allocate.
  void step(double power_w, bool runs, double dt_s);

  double now_c() const { return now_c_; }
  double max_c() const { return max_c_; }
  double above_harm_s() const { return above_s_; }
  double dose_min() const { return dose_min_; }  ///< at most 1e6

 private:
  const double into_bone_ratio_, saline_c_, water_ml_per_min_;
  double capacity_j_per_k_, bone_w_per_k_, saline_w_per_k_;
  double now_c_ = body_c, max_c_ = body_c, above_s_ = 0, dose_min_ = 0;
};

}  // namespace trephine::drill
