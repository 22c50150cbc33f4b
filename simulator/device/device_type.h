// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "cli/command.h"
#include "contact/contact.h"
#include "device/device.h"
#include "device/mailbox.h"
#include "texts/note.h"

namespace trephine::device {

/// The chosen kind of device, by its name, and the values of its options.
struct DeviceChoice {
  std::string name = "hand";
  std::vector<AnyParams> params;                       ///< of any kind of device; those of other kinds are ignored
  std::map<std::string, std::filesystem::path> files;  ///< by the argument's name; only what was given
  std::string flags = {};                              ///< what its flags begin with: "second-" of a second hand's

  /// The first of params whose type is P; its defaults where there is none.
  template <class P>
  P of() const {
    for (const AnyParams& p : params)
      if (p.set == &parameters_of<P>()) return p.as<P>();
    return P();
  }
};

/// How the picture lies in the case, unit: what a device that is pushed means by right and up.
struct ViewAxes {
  Vec3 right{1, 0, 0}, up{0, 0, 1};
  double min_most_n = 0;  ///< a led hand may always pull this hard: what the tool needs to pierce
};
/// Where a tool is held at first.
struct HandBegin {
  Vec3 tip_mm, axis{0, 0, 1};
};

/// What a device is made for: the volume over which it moves, how the loop runs, and how to report a wait.
struct DeviceScene {
  const contact::ContactVolume& contact;
  contact::TouchableFaces faces;
  bool paced = true, realtime = false;  ///< as in ServoParams
  std::function<void(const texts::Note&)> say;
  Progress progress;          ///< ends a wait
  std::uint64_t drilled = 0;  ///< the shapes that the tool drills, bit n for shape n; 0: it does not
  double tool_radius_mm = 0;
  std::vector<std::pair<std::string, Vec3>> sites;    ///< the case's landmarks and burr holes, mm
  std::shared_ptr<Mailbox<ViewAxes>> view = nullptr;  ///< of a window; read by the servo thread alone
  std::optional<HandBegin> begin = std::nullopt;      ///< of a hand that is led; none: it finds its own
  std::string case_token = {}, case_sha256 = {};      ///< the second of its case.json
  std::vector<std::string> tools = {};                ///< names of a lesson's tools, by number; none: there is one
};

/// A kind of device, declared once. The values of --device, the help, the reference pages and the completion come from
/// it.
///
/// Each source of this folder whose name ends in _device.cpp defines one kind: NAME_device.cpp has `DeviceType
/// NAME_device()`, and CMake lists them all in a generated source. No other place names a kind of device.
struct DeviceType {
  std::string name;                         ///< its value for --device, also used in recordings
  std::string help;                         ///< ends the sentence "The device is ..."
  std::string example;                      ///< the flags of a call, for the command's examples; empty: no example
  std::vector<cli::Argument> files;         ///< of kind in_file: required with this kind, refused with others
  std::vector<cli::ParameterGroup> groups;  ///< its options
  bool lives = false;                       ///< it runs in real time, so the loop must keep to the clock
  bool placed = false;                      ///< its poses are of the case's frame, and no workspace moves them
  bool first_only = false;                  ///< no second hand has it
  /// What of it one hand alone can hold, such as "port 20517"; without it, or "": it is of as many as ask.
  std::function<std::string(const DeviceChoice&)> seat;
  /// Makes the device, ready to be read. It may wait for a client, and then says so.
  std::function<std::unique_ptr<Device>(const DeviceChoice&, const DeviceScene&)> make;
};

/// All kinds, in the order of their names.
const std::vector<DeviceType>& device_types();
/// Whether the kind of that name is `placed`; false where there is none of that name.
bool is_placed(const std::string& name);

/// DeviceType::seat of the chosen kind.
std::string seat_of(const DeviceChoice& choice);

/// Throws Error 64 where a file is missing or belongs to another kind, where there is no such kind, and where a kind
/// that runs in real time is used without a clock; else what its kind throws.
std::unique_ptr<Device> make_device(const DeviceChoice& choice, const DeviceScene& scene);

}  // namespace trephine::device
