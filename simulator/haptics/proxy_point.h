// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/proxy_body.h"

namespace trephine::haptics {

/// The proxy of a point [Zilles1995].
class ProxyPoint : public ProxyBody {
 public:
  explicit ProxyPoint(ProxyGround& ground);
  bool begin(const HapticInput& in) override;
  void follow(const HapticInput& in) override;

 private:
  void walk(Vec3 device_mm);
  bool meet(const contact::Contact& c, Vec3 device_mm, Vec3& goal_mm, int pass);
  bool step_over(const contact::Contact& c, Vec3 device_mm, Vec3 goal_mm);
  void approach(const contact::Contact& c);
  const bool stepped_;  // the walk
};

}  // namespace trephine::haptics
