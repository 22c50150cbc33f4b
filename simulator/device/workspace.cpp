// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/workspace.h"

#include "haptics/drilling.h"

namespace trephine::device {

WorkspaceDevice::WorkspaceDevice(std::unique_ptr<Device> device, const WorkspaceParams& params)
    : device_(std::move(device)),
      params_(params),
      offset_mm_{params.workspace_offset_mm[0], params.workspace_offset_mm[1], params.workspace_offset_mm[2]} {}

double WorkspaceDevice::damping_n_s_per_mm() const {
  return device_->damping_n_s_per_mm() / params_.workspace_scale;  // the same force, at the tool's speed
}

bool WorkspaceDevice::read(double dt_s, DeviceReading& out) {
  if (!device_->read(dt_s, out)) return false;
  const Vec3 scaled = out.tip_mm * params_.workspace_scale;
  const bool down = params_.clutch_button > 0 && (out.buttons >> (params_.clutch_button - 1) & 1) != 0;
  if (down && !clutched_) {
    rests_ = out;
    rests_.tip_mm = scaled + offset_mm_;
    ++clutches_;
  }
  clutched_ = down;
  if (down) {
    const std::uint32_t clutch = std::uint32_t{1} << (params_.clutch_button - 1);
    offset_mm_ = rests_.tip_mm - scaled;
    const std::uint32_t buttons = out.buttons;
    const bool silent = out.silent;
    out = rests_;
    out.silent = silent;
    out.buttons = buttons & ~(clutch | haptics::Drilling::pedal);
    return true;
  }
  out.tip_mm = scaled + offset_mm_;
  return true;
}

void WorkspaceDevice::send(Vec3 force_n) { device_->send(clutched_ ? Vec3{} : force_n); }

void WorkspaceDevice::tell(const DeviceNews& news) {
  if (!clutched_) return device_->tell(news);
  DeviceNews rests = news;
  rests.torque_n_mm = {};
  device_->tell(rests);
}

std::vector<std::pair<std::string, std::uint64_t>> WorkspaceDevice::counts() const {
  auto all = device_->counts();
  if (params_.clutch_button > 0) all.emplace_back("clutches", clutches_.load());
  return all;
}

std::unique_ptr<Device> in_workspace(std::unique_ptr<Device> device, const WorkspaceParams& params) {
  const WorkspaceParams none;
  if (params.workspace_scale == none.workspace_scale && params.workspace_offset_mm == none.workspace_offset_mm &&
      params.clutch_button == 0)
    return device;
  return std::make_unique<WorkspaceDevice>(std::move(device), params);
}

}  // namespace trephine::device
