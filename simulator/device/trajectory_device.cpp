// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/trajectory_device.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "device/device_type.h"

namespace trephine::device {
namespace {

// The numbers of a line; false where something else is in it.
bool read_numbers(std::string_view line, std::vector<double>& out) {
  out.clear();
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t,\r");
    if (begin == std::string_view::npos || line[begin] == '#') return true;
    line.remove_prefix(begin);
    double v = 0;
    const auto [end, fault] = std::from_chars(line.data(), line.data() + line.size(), v);
    if (fault != std::errc() || !std::isfinite(v)) return false;
    line.remove_prefix(std::size_t(end - line.data()));
    if (!line.empty() && std::string_view(" \t,\r#").find(line[0]) == std::string_view::npos) return false;
    out.push_back(v);
  }
}

}  // namespace

bool Trajectory::read(double dt_s, DeviceReading& out) {
  time_s_ += dt_s;
  while (next_ < points_.size() && points_[next_].time_s <= time_s_) ++next_;
  if (next_ == 0 || next_ == points_.size()) {
    out = points_[next_ == 0 ? 0 : next_ - 1].reading;
    return true;
  }
  const TrajectoryPoint &a = points_[next_ - 1], &b = points_[next_];
  const double t = (time_s_ - a.time_s) / (b.time_s - a.time_s);
  out.tip_mm = a.reading.tip_mm + (b.reading.tip_mm - a.reading.tip_mm) * t;
  out.axis = normalized(a.reading.axis + (b.reading.axis - a.reading.axis) * t);
  if (out.axis == Vec3{}) out.axis = a.reading.axis;
  out.buttons = a.reading.buttons;
  return true;
}

std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& file) {
  const std::vector<char> bytes = read_file(file, std::uint64_t{1} << 30);
  std::string_view rest(bytes.data(), bytes.size());
  std::vector<TrajectoryPoint> points;
  std::vector<double> v;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const auto refuse = [&](const std::string& what) {
      throw Error(ExitCode::bad_input, file.string(), "line " + std::to_string(number), what);
    };
    if (!read_numbers(line, v)) refuse("must be finite numbers");
    if (v.empty()) continue;
    if (v.size() != 4 && v.size() != 7 && v.size() != 8)
      refuse("must be time_s x_mm y_mm z_mm [ax ay az [buttons]], not " + std::to_string(v.size()) + " numbers");
    TrajectoryPoint p;
    p.time_s = v[0];
    p.reading.tip_mm = {v[1], v[2], v[3]};
    if (v.size() >= 7) p.reading.axis = normalized(Vec3{v[4], v[5], v[6]});
    if (p.reading.axis == Vec3{}) refuse("the axis must have a length");
    if (v.size() == 8) {
      if (!(v[7] >= 0 && v[7] < 4294967296.0) || v[7] != std::floor(v[7])) refuse("buttons must be a 32-bit number");
      p.reading.buttons = std::uint32_t(v[7]);
    }
    if (!points.empty() && !(p.time_s > points.back().time_s)) refuse("times must ascend");
    points.push_back(p);
  }
  if (points.empty()) throw Error(ExitCode::bad_input, file.string(), "", "holds no point");
  return points;
}

DeviceType trajectory_device() {
  DeviceType type;
  type.name = "trajectory";
  type.help = "a trajectory from a file";
  type.example = "--device trajectory --trajectory path.txt --seconds 2";
  type.files = {cli::argument(
      "trajectory", cli::Argument::Kind::in_file,
      "Lines of time_s x_mm y_mm z_mm [ax ay az [buttons]], LPS; the axis points from the tip to the tail.")};
  type.make = [](const DeviceChoice& choice, const DeviceScene&) {
    return std::make_unique<Trajectory>(read_trajectory(choice.files.at("trajectory")));
  };
  return type;
}

}  // namespace trephine::device
