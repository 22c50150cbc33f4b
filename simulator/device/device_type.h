// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "cli/command.h"
#include "contact/contact.h"
#include "device/device.h"

namespace trephine {

/// What was chosen: a kind of device by its name, and what was given for its options.
struct DeviceChoice {
  std::string name = "hand";
  std::vector<AnyParams> params;                       ///< of any kind of device, and others, which are passed over
  std::map<std::string, std::filesystem::path> files;  ///< by the argument's name; only what was given

  /// The first of params whose type is P; its defaults where there is none.
  template <class P>
  P of() const {
    for (const AnyParams& p : params)
      if (p.set == &parameters_of<P>()) return p.as<P>();
    return P();
  }
};

/// Where a device is made: the volume that it is moved over, how its loop runs, and who waits for it.
struct DeviceScene {
  const ContactVolume& contact;
  TouchableFaces faces;
  bool paced = true, realtime = false;  ///< as in ServoParams
  std::function<void(const std::string& line)> say;
  Progress progress;  ///< ends a wait
};

/// A kind of device, declared once: what --device takes, the help, the reference pages and the completion come from it.
///
/// A source of this folder whose name ends in _device.cpp defines one: NAME_device.cpp has `DeviceType NAME_device()`,
/// and CMake lists them all in a source that it writes. Nothing else names a kind of device.
struct DeviceType {
  std::string name;                    ///< for --device and in recordings
  std::string help;                    ///< ends the sentence "The device is ..."
  std::string example;                 ///< the flags of a call, for the command's examples; empty: none
  std::vector<Argument> files;         ///< of kind in_file: needed with this kind, refused with others
  std::vector<ParameterGroup> groups;  ///< its options
  bool lives = false;                  ///< it is there in its own time, so that the loop must keep to the clock
  /// The device, ready to be read. May wait for somebody, and then says so.
  std::function<std::unique_ptr<Device>(const DeviceChoice&, const DeviceScene&)> make;
};

/// In the order of their names.
const std::vector<DeviceType>& device_types();

/// Throws Error 64 where a file is missing or is another kind's, for a kind that is none, and for one that lives in a
/// loop without a clock; else what its kind throws.
std::unique_ptr<Device> make_device(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace trephine
