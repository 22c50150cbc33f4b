// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/device_type.h"

#include <algorithm>

#include "base/error.h"

namespace trephine::device {
namespace {

const DeviceType& type_of(const std::string& name) {
  for (const DeviceType& type : device_types())
    if (type.name == name) return type;
  throw Error(ExitCode::usage, "", "--device", name + ": there is no such kind of device");
}

std::string flag_of(const DeviceChoice& choice, const cli::Argument& file) {
  std::string flag = "--" + choice.flags + file.name;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

void check_files(const DeviceChoice& choice) {
  const std::string device = "--" + choice.flags + "device ";
  for (const DeviceType& type : device_types())
    for (const cli::Argument& file : type.files) {
      const bool chosen = type.name == choice.name, given = choice.files.count(file.name) > 0;
      if (chosen && !given)
        throw Error(ExitCode::usage, "", flag_of(choice, file), "is needed with " + device + type.name);
      if (given && !chosen) throw Error(ExitCode::usage, "", flag_of(choice, file), "needs " + device + type.name);
    }
}

}  // namespace

bool is_placed(const std::string& name) {
  return std::any_of(device_types().begin(), device_types().end(),
                     [&](const DeviceType& type) { return type.placed && type.name == name; });
}

std::string seat_of(const DeviceChoice& choice) {
  const DeviceType& type = type_of(choice.name);
  return type.seat ? type.seat(choice) : "";
}

std::unique_ptr<Device> make_device(const DeviceChoice& choice, const DeviceScene& scene) {
  const DeviceType& type = type_of(choice.name);
  check_files(choice);
  if (type.lives && !scene.paced)
    throw Error(ExitCode::usage, "", "--no-paced", "a device that is there keeps to the clock");
  return type.make(choice, scene);
}

}  // namespace trephine::device
