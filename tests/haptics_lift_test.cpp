// SPDX-License-Identifier: GPL-3.0-or-later
// A tool that the hand takes away and puts to another place, as a window's user does with one key.
#include <gtest/gtest.h>

#include "haptics/proxy.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

haptics::HapticInput lifted(Vec3 tip_mm) {
  haptics::HapticInput in = at(tip_mm);
  in.buttons = haptics::haptic_button::lifted;
  return in;
}

TEST(HapticsLift, ALiftedToolMeetsNothingAndFeelsNothing) {
  voxel::HapticVolume volume = empty(40, {0.5, 0.5, 0.5});
  fill(volume, 1, [](Vec3 p) { return 2 - std::abs(p.z); });  // a plate from z = -2 to 2
  const contact::ContactVolume contact(volume);
  haptics::Proxy proxy(contact, one_shape(1, face(0.6), face(0.6)), plain());
  proxy.update(at({0, 0, 5}));
  proxy.update(at({0, 0, 1}));
  EXPECT_NEAR(proxy.state().force_n.z, 0.6, 0.05);  // the plate holds it
  EXPECT_NEAR(proxy.state().proxy_mm.z, 2, 0.05);

  // Lifted it goes through the plate, and is shown where it is.
  const haptics::HapticState away = proxy.update(lifted({1, 0, -6}));
  EXPECT_EQ(away.force_n, Vec3());
  EXPECT_EQ(away.proxy_mm, (Vec3{1, 0, -6}));
  EXPECT_EQ(away.touched, 0);
  EXPECT_EQ(away.faults, 0u);
  // So it is as it is turned about its axis.
  haptics::HapticInput turned = lifted({1, 0, -6});
  turned.axis = {0, 0, 1};
  turned.across = {0, 1, 0};
  EXPECT_EQ(proxy.update(turned).across, (Vec3{0, 1, 0}));

  // Put down below the plate, it meets the plate from below.
  proxy.update(at({1, 0, -6}));
  proxy.update(at({1, 0, -1}));
  EXPECT_NEAR(proxy.state().proxy_mm.z, -2, 0.05);
  EXPECT_NEAR(proxy.state().force_n.z, -0.6, 0.05);

  // A fault stays, however often the tool is lifted.
  proxy.latch(haptics::haptic_fault::device_lost);
  EXPECT_EQ(proxy.update(lifted({0, 0, 5})).faults, haptics::haptic_fault::device_lost);
  EXPECT_EQ(proxy.update(at({0, 0, 1})).force_n, Vec3());
}

}  // namespace
