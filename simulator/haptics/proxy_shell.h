// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "haptics/drawn_out.h"
#include "haptics/proxy_body.h"
#include "haptics/tool_lock.h"

namespace trephine::haptics {

/// The proxy of a tool of many points, its point shell [McNeely1999] [Rizzi, chapter 5]. All planes hold back the tip:
/// where a wall holds back a point that lies `arm` away from the tip, the tip may not go behind that wall moved by
/// -arm.
class ProxyShell : public ProxyBody {
 public:
  ProxyShell(ProxyGround& ground, const Tool& tool);
  bool begin(const HapticInput& in) override;
  void follow(const HapticInput& in) override;
  Vec3 across(const HapticInput&) const override { return body_.frame().column[0]; }
  std::optional<Vec3> kept_from_turning(const HapticInput& in) const override;
  const ToolBody* points() const override { return &body_; }

 private:
  struct Wall {
    contact::Plane plane;  // for the tip
    int point;
  };
  void move_to(const HapticInput& in, Vec3 axis);
  bool meet(const ToolBody::Meeting& m, Vec3 device_mm, Vec3& goal_mm, Mat3& aim, int pass);
  int find_walls(const ToolBody::Meeting& m, Wall* walls) const;
  contact::Plane tip_plane(int point, Vec3 normal) const;
  void approach(const ToolBody::Meeting& m);
  bool step_over(Vec3 normal, bool straight, Vec3 device_mm, Vec3 goal_mm);
  void pop_into(const contact::Contact& contact);
  void hold_turn(Vec3 device_mm, Vec3& goal_mm, Mat3& aim);
  void open_behind();
  contact::TouchableFaces closed_faces() const { return open_.closed(ground_.faces); }
  void unlock(Vec3 axis);
  void slide_out(Vec3 device_mm);
  void work_loose();
  void show();

  static constexpr double max_turn_rad = 0.5;  // in a frame
  const ToolParams::Search search_;
  const double length_mm_;
  ToolBody body_;
  OpenFaces open_;
  contact::TouchableFaces crossed_{0, 0};  // of the open faces, those found along the axis in this round
  int slice_ = 0;                          // of the axis, to be examined next
  ToolLock lock_;
  DrawnOut drawn_;
};

}  // namespace trephine::haptics
