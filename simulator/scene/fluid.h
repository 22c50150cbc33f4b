// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "scene/scene.h"

namespace trephine::scene {

/// CSF that drains from a head under pressure: an exponential curve of pressure and volume [Marmarou1975], a tube of
/// laminar flow, and the height of its end against both. A look alone: what is judged does not depend on it.
struct CsfPressure {
  double opening_mmhg = 25;  ///< of acute hydrocephalus; 20 to 22 are treated
  double pvi_ml = 25;        ///< pressure-volume index: draining so much leaves a tenth
  double bore_mm = 1.3;      ///< within the tube
  double tube_mm = 350;
  double viscosity_mpa_s = 0.8, density_kg_per_m3 = 1007;  ///< of CSF in a body
};
class CsfDrain {
 public:
  explicit CsfDrain(const CsfPressure& params = {});
  /// For that time the tube's end is so high above its tip.
  void step(double height_mm, double dt_s);
  double drained_ml() const { return drained_ml_; }
  double pressure_mmhg() const;
  double ml_per_s(double height_mm) const;  ///< 0 where the pressure does not lift it so high

 private:
  CsfPressure params_;
  double ml_per_s_mmhg_;  // through the tube
  double drained_ml_ = 0;
};

/// A tube whose tip lies in a fluid: from its tip along `axis` (unit) to its end, `to_mm` away; drops fall along
/// `down`.
struct Tube {
  Vec3 tip_mm, axis, down;
  double radius_mm = 1.25, to_mm = 100;
};
/// A fluid as it comes out of a tube through which so much has come, and so much comes now: beads that move outwards
/// along it, and drops of 0.05 ml that swell at its end and fall. None where nothing flows. The same numbers give the
/// same drops.
std::vector<Marker> drops_of(const Tube& tube, double drained_ml, double ml_per_s,
                             const std::array<float, 3>& colour_rgb);

}  // namespace trephine::scene
