// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "device/device_type.h"
#include "device/hand_path.h"
#include "device/simulated_hand.h"

namespace trephine::device {
namespace {

std::unique_ptr<Device> make_hand(const DeviceChoice& choice, const DeviceScene& scene) {
  const auto task = choice.of<HandPathParams>();
  const bool drills = task.hand_task == HandPathParams::Task::drill ||
                      (task.hand_task == HandPathParams::Task::own && scene.drilled != 0);
  if (drills && scene.drilled == 0)
    throw Error(ExitCode::usage, "", "--hand-task", "drill needs --drill, and a shape that can be drilled");
  HandPath path = drills ? drill_path(scene.contact, scene.drilled, scene.sites, scene.tool_radius_mm, task)
                         : path_over(scene.contact, scene.faces, task);
  auto hand = std::make_unique<SimulatedHand>(choice.of<HandParams>(), std::move(path.points_mm), path.loop_from);
  hand->axis = path.axis;
  hand->drills = drills;
  if (drills) hand->feed_force_n = task.feed_force_n;
  if (drills) hand->press_n = task.press_n;
  return hand;
}

}  // namespace

DeviceType hand_device() {
  DeviceType type;
  type.name = "hand";
  type.help =
      "a simulated hand, which presses on the first surface that it meets and moves over it in a circle, or drills a "
      "hole";
  type.groups = {cli::ParameterGroup::of<HandParams>("Simulated hand"),
                 cli::ParameterGroup::of<HandPathParams>("The hand's task")};
  type.first_only = true;
  type.make = make_hand;
  return type;
}

}  // namespace trephine::device
