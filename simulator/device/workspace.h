// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <string>

#include "base/params.h"
#include "device/device.h"

namespace trephine::device {

/// How a device's workspace lies in the case's space.
struct WorkspaceParams {
  std::string workspace_axes = "lps";
  double workspace_scale = 1;
  std::array<double, 3> workspace_offset_mm{0, 0, 0};
  int clutch_button = 0;
  template <class V>
  static void describe(V& v) {
    using P = WorkspaceParams;
    v.text(
        &P::workspace_axes, "workspace_axes",
        "Which axes of the device point to the patient's left, back and head, such as +x,-z,+y; or a name: lps or "
        "haply (its y points away from the operator and its z up: +x,+y,+z), touch (its y points up and its z to the "
        "operator: +x,-z,+y), omega (its x points to the operator and its z up: +y,-x,+z). With these three the "
        "patient faces the operator, upright.");
    v.number(&P::workspace_scale, "workspace_scale", Range{0.01, 100},
             "How far the tool moves for each mm of the device.");
    v.numbers(&P::workspace_offset_mm, "workspace_offset_mm", Range{-1e5, 1e5},
              "Where the device's origin lies in the case, LPS.");
    v.integer(&P::clutch_button, "clutch_button", Range{0, 32},
              "While this button of the device (from 1) is down the tool rests and the device moves freely; 0: none.");
  }
};

/// Whether positions are passed on as they are, and no button is the clutch. Throws as workspace_axes does.
bool is_unmoved(const WorkspaceParams& params);
/// The rotation that workspace_axes names: `axes * p` is a device's direction p in the case's axes (LPS). Throws Error
/// 64 where the text is none, or would mirror the hand.
Mat3 workspace_axes(const WorkspaceParams& params);

/// A device of another workspace: positions are turned, scaled and shifted, directions and forces turned, and while the
/// clutch is down the tool rests where it is, without force on the hand and with the pedal up, and takes the device's
/// new place for its own; the device's other buttons count. Forces are those at the tool, so a wall is workspace_scale
/// times as stiff at the hand, and the damping that the tool sees is the device's divided by it: both say how stiff a
/// wall may be (acceptance case H3).
class WorkspaceDevice : public Device {
 public:
  WorkspaceDevice(std::unique_ptr<Device> device, const WorkspaceParams& params);
  double damping_n_s_per_mm() const override;
  bool read(double dt_s, DeviceReading& out) override;
  void send(Vec3 force_n) override;
  void tell(const DeviceNews& news) override;
  bool knows_across() const override { return device_->knows_across(); }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override;

 private:
  std::unique_ptr<Device> device_;
  WorkspaceParams params_;
  Mat3 axes_;
  Vec3 offset_mm_;
  DeviceReading rests_;
  bool clutched_ = false;
  std::atomic<std::uint64_t> clutches_{0};
};

/// The device itself where the parameters change nothing.
std::unique_ptr<Device> in_workspace(std::unique_ptr<Device> device, const WorkspaceParams& params);

}  // namespace trephine::device
