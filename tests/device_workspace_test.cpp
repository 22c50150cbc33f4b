// SPDX-License-Identifier: GPL-3.0-or-later
// A device of another workspace: scale, offset, and a clutch.
#include <gtest/gtest.h>

#include "base/error.h"
#include "device/workspace.h"

using namespace trephine;

namespace {

struct Hand : device::Device {
  device::DeviceReading is;
  Vec3 felt;
  double damping_n_s_per_mm() const override { return 0.008; }
  bool read(double, device::DeviceReading& out) override {
    out = is;
    return true;
  }
  void send(Vec3 force_n) override { felt = force_n; }
};

}  // namespace

TEST(HapticsWorkspace, ScalesAndLetsGoWhileTheClutchIsDown) {
  auto owned = std::make_unique<Hand>();
  Hand& hand = *owned;
  device::WorkspaceParams params;
  params.workspace_scale = 0.5;
  params.workspace_offset_mm = {100, 0, 0};
  params.clutch_button = 2;
  const std::unique_ptr<device::Device> device = device::in_workspace(std::move(owned), params);
  EXPECT_DOUBLE_EQ(device->damping_n_s_per_mm(), 0.016);
  device::DeviceReading r;
  const auto at = [&](Vec3 tip, std::uint32_t buttons) {
    hand.is.tip_mm = tip;
    hand.is.buttons = buttons;
    EXPECT_TRUE(device->read(0.001, r));
    device->send({1, 2, 3});
    return r.tip_mm;
  };
  EXPECT_EQ(at({10, 20, 30}, 1), (Vec3{105, 10, 15}));
  EXPECT_EQ(r.buttons, 1u);
  EXPECT_EQ(hand.felt, (Vec3{1, 2, 3}));
  EXPECT_EQ(at({10, 20, 30}, 3), (Vec3{105, 10, 15}));
  EXPECT_EQ(r.buttons, 0u) << "the clutch is no button of the tool, and a tool that rests does not drill";
  EXPECT_EQ(at({-60, 0, 0}, 2 | 5u << 8), (Vec3{105, 10, 15})) << "the tool rests";
  EXPECT_EQ(r.buttons, 5u << 8) << "what else the device says counts at once";
  EXPECT_EQ(hand.felt, Vec3{});
  EXPECT_EQ(at({-60, 0, 0}, 0), (Vec3{105, 10, 15})) << "and goes on from there";
  EXPECT_EQ(at({-60, 0, 8}, 0), (Vec3{105, 10, 19}));
  EXPECT_EQ(hand.felt, (Vec3{1, 2, 3}));
  EXPECT_EQ(device->counts().back(), (std::pair<std::string, std::uint64_t>{"clutches", 1}));
}

// What is up for the hand is up for the patient, who faces it: motion, direction and force alike.
TEST(HapticsWorkspace, ADevicesAxesAreTurnedToThePatients) {
  const Vec3 left{1, 0, 0}, front{0, -1, 0}, up{0, 0, 1};
  struct Preset {
    const char* name;
    Vec3 right, to_operator, up;  ///< of the device
  };
  for (const Preset& p :
       {Preset{"touch", {1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, Preset{"omega", {0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
        Preset{"haply", {1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, Preset{"+x,-z,+y", {1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}) {
    auto owned = std::make_unique<Hand>();
    Hand& hand = *owned;
    device::WorkspaceParams params;
    params.workspace_axes = p.name;
    const std::unique_ptr<device::Device> device = device::in_workspace(std::move(owned), params);
    device::DeviceReading r;
    const std::pair<Vec3, Vec3> same[] = {{p.right, left}, {p.to_operator, front}, {p.up, up}};
    for (const auto& [of_device, of_patient] : same) {
      hand.is.tip_mm = of_device * 7;
      hand.is.axis = of_device;
      EXPECT_TRUE(device->read(0.001, r));
      EXPECT_EQ(r.tip_mm, of_patient * 7) << p.name;
      EXPECT_EQ(r.axis, of_patient) << p.name;
      device->send(of_patient * 2);
      EXPECT_EQ(hand.felt, of_device * 2) << p.name;
    }
  }
  for (const char* wrong : {"", "x,y,z", "+x,+y", "+x,+x,+z", "+y,+x,+z", "-x,+y,+z", "phantom"}) {
    device::WorkspaceParams params;
    params.workspace_axes = wrong;
    EXPECT_THROW(device::in_workspace(std::make_unique<Hand>(), params), Error) << wrong;
  }
}

TEST(HapticsWorkspace, IsTheDeviceItselfWhereItChangesNothing) {
  auto owned = std::make_unique<Hand>();
  const device::Device* hand = owned.get();
  EXPECT_EQ(device::in_workspace(std::move(owned), {}).get(), hand);
}
