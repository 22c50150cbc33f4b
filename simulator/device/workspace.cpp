// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/workspace.h"

#include "base/error.h"
#include "base/text.h"
#include "haptics/drilling.h"

namespace trephine::device {

Mat3 workspace_axes(const WorkspaceParams& params) {
  const std::string& text = params.workspace_axes;
  const std::vector<std::string> rows = split_at(text == "lps"     ? "+x,+y,+z"
                                                 : text == "haply" ? "+x,+y,+z"
                                                 : text == "touch" ? "+x,-z,+y"
                                                 : text == "omega" ? "+y,-x,+z"
                                                                   : text,
                                                 ',');
  Mat3 m{{Vec3{}, Vec3{}, Vec3{}}};
  bool good = rows.size() == 3;
  for (std::size_t r = 0; good && r < 3; ++r) {
    const std::string& row = rows[r];
    good = row.size() == 2 && (row[0] == '+' || row[0] == '-') && row[1] >= 'x' && row[1] <= 'z';
    if (good) m.column[std::size_t(row[1] - 'x')][int(r)] = row[0] == '+' ? 1 : -1;
  }
  const double turns = determinant(m);
  if (!good || turns == 0)
    throw Error(ExitCode::usage, "", "workspace_axes",
                text +
                    ", must be lps, haply, touch, omega, or three axes of the device with their signs, each once, such "
                    "as +x,-z,+y");
  if (turns < 0)
    throw Error(ExitCode::usage, "", "workspace_axes", text + ", would mirror the hand; turn the sign of one axis");
  return m;
}

WorkspaceDevice::WorkspaceDevice(std::unique_ptr<Device> device, const WorkspaceParams& params)
    : device_(std::move(device)),
      params_(params),
      axes_(workspace_axes(params)),
      offset_mm_{params.workspace_offset_mm[0], params.workspace_offset_mm[1], params.workspace_offset_mm[2]} {}

double WorkspaceDevice::damping_n_s_per_mm() const {
  return device_->damping_n_s_per_mm() / params_.workspace_scale;  // the same force, at the tool's speed
}

bool WorkspaceDevice::read(double dt_s, DeviceReading& out) {
  if (!device_->read(dt_s, out)) return false;
  const Vec3 scaled = axes_ * out.tip_mm * params_.workspace_scale;
  out.axis = axes_ * out.axis;
  out.across = axes_ * out.across;
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

void WorkspaceDevice::send(Vec3 force_n) { device_->send(clutched_ ? Vec3{} : transpose_times(axes_, force_n)); }

void WorkspaceDevice::tell(const DeviceNews& news) {
  DeviceNews own = news;
  own.torque_n_mm = clutched_ ? Vec3{} : transpose_times(axes_, news.torque_n_mm);
  own.axis = transpose_times(axes_, news.axis);
  own.across = transpose_times(axes_, news.across);
  device_->tell(own);
}

std::vector<std::pair<std::string, std::uint64_t>> WorkspaceDevice::counts() const {
  auto all = device_->counts();
  if (params_.clutch_button > 0) all.emplace_back("clutches", clutches_.load());
  return all;
}

bool is_unmoved(const WorkspaceParams& params) {
  const WorkspaceParams none;
  return workspace_axes(params) == workspace_axes(none) && params.workspace_scale == none.workspace_scale &&
         params.workspace_offset_mm == none.workspace_offset_mm && params.clutch_button == 0;
}

std::unique_ptr<Device> in_workspace(std::unique_ptr<Device> device, const WorkspaceParams& params) {
  if (is_unmoved(params)) return device;
  return std::make_unique<WorkspaceDevice>(std::move(device), params);
}

}  // namespace trephine::device
