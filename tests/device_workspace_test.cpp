// SPDX-License-Identifier: GPL-3.0-or-later
// A device of another workspace: scale, offset, and a clutch.
#include <gtest/gtest.h>

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

TEST(HapticsWorkspace, IsTheDeviceItselfWhereItChangesNothing) {
  auto owned = std::make_unique<Hand>();
  const device::Device* hand = owned.get();
  EXPECT_EQ(device::in_workspace(std::move(owned), {}).get(), hand);
}
