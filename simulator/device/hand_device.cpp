// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/device_type.h"
#include "device/hand_path.h"
#include "device/simulated_hand.h"

namespace trephine {
namespace {

std::unique_ptr<Device> make_hand(const DeviceChoice& choice, const DeviceScene& scene) {
  const auto task = choice.of<HandPathParams>();
  HandPath path = path_over(scene.contact, scene.faces, task);
  auto hand = std::make_unique<SimulatedHand>(choice.of<HandParams>(), std::move(path.points_mm), path.loop_from);
  hand->axis = normalized(Vec3{task.from[0], task.from[1], task.from[2]});
  return hand;
}

}  // namespace

DeviceType hand_device() {
  DeviceType type;
  type.name = "hand";
  type.help = "a simulated hand, which presses on the first surface that it meets and moves over it in a circle";
  type.groups = {ParameterGroup::of<HandParams>("Simulated hand"),
                 ParameterGroup::of<HandPathParams>("The hand's task")};
  type.make = make_hand;
  return type;
}

}  // namespace trephine
