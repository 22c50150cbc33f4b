// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "base/vec3.h"
#include "cases/case.h"
#include "haptics/frame.h"

namespace trephine::lessons {

/// A tool that gave way through the dura.
struct DuraPop {
  double time_s = 0;
  Vec3 at_mm;          ///< where it was held before
  double force_n = 0;  ///< in the tick before
};

/// What happened to the dura, in a case that has one.
struct DuraFacts {
  std::vector<DuraPop> pops;  ///< of the catheter, and of whatever else is pointed
  double burr_s = 0;          ///< how long a running burr pressed on it
  double burr_n = 0;          ///< its largest force in that time
  double burr_first_s = -1;   ///< when it first did; -1: never
  /// When it had pressed with more than the dura bears (pop_through_n of its material) for breach_s on end.
  std::optional<DuraPop> breach;
};
/// A shorter press is none that cuts: decision 20 of docs/developers/decisions.md.
constexpr double breach_s = 0.01;

/// Watches the dura, frame by frame.
class DuraWatch {
 public:
  /// Looks for the shape named dura, and begins its facts; a case without one has none.
  DuraWatch(const cases::CaseManifest& manifest, std::optional<DuraFacts>& facts);
  /// `drilling`: the tool in hand cuts and its pedal is down. `facts` are those that were begun.
  void tick(const haptics::ServoFrame& frame, bool drilling, std::optional<DuraFacts>& facts);

 private:
  int shape_ = 0;
  double bears_n_ = 0, over_s_ = 0;  ///< over_s_: since when it presses with more than that
  bool held_ = false;                ///< in the tick before, by the dura
  DuraPop last_;
};

}  // namespace trephine::lessons
