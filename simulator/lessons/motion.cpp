// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/motion.h"

#include "base/hash.h"
#include "haptics/haptic_state.h"

namespace trephine::lessons {

std::string motion_digest(const std::vector<haptics::ServoFrame>& frames) {
  Sha256 digest;
  digest.text("trephine motion 1");
  for (const haptics::ServoFrame& f : frames) {
    for (const double* v : {f.tip_mm, f.axis, f.across})
      for (int a = 0; a < 3; ++a) digest.number(v[a]);
    digest.number(f.dt_s).integer(f.buttons).integer(f.faults & haptics::haptic_fault::device_lost);
  }
  return digest.hex();
}

}  // namespace trephine::lessons
