// SPDX-License-Identifier: GPL-3.0-or-later
// A real tool that a tracker sees, by the OpenIGTLink protocol.
#include <chrono>
#include <thread>

#include "base/error.h"
#include "cli/argument.h"
#include "device/device_type.h"
#include "track/pose_source.h"
#include "track/tracked_device.h"

namespace trephine::device {
namespace {

class LinkedTool : public track::TrackedDevice {
 public:
  LinkedTool(const track::Tracking& tracking, const std::vector<std::string>& lesson_tools,
             const track::TrackerParams& params)
      : TrackedDevice(tracking, lesson_tools, 1e-3 * params.tracker_lost_ms, 1e-3 * params.tracker_late_ms,
                      track::steady_s),
        wait_s_(params.tracker_wait_s),
        link_(
            params,
            [this](const track::IgtlHeader& header, const track::IgtlContent& content) { take(header, content); },
            [this] { begin_anew(); }) {}
  const track::TrackerLink& link() const { return link_; }
  void wait(const Progress& progress) const {
    const double since_s = track::steady_s();
    while (!seen()) {
      progress.check();
      if (track::steady_s() - since_s > wait_s_)
        throw track::no_pose(link_, first_body(), reference(), watched(), strangers());
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  std::vector<std::pair<std::string, std::uint64_t>> counts() const override {
    auto all = TrackedDevice::counts();
    all.emplace_back("connections", link_.connections());
    return all;
  }

 private:
  const double wait_s_;
  track::TrackerLink link_;  // ends first, for its thread calls the rest
};

}  // namespace

DeviceType openigtlink_device() {
  DeviceType type;
  type.name = "openigtlink";
  type.help = "a real tool in a printed case, which a tracker sees and sends by OpenIGTLink";
  type.example = "--device openigtlink --tracking head.tracking.json --tracker-host tracker.local --seconds 60";
  type.files = {
      cli::argument("tracking", cli::Argument::Kind::in_file,
                    "Where print and tools are before the tracker, as `trephine-sim track register` wrote it.")};
  type.groups = {cli::ParameterGroup::of<track::TrackerParams>("Tracker by OpenIGTLink")};
  type.lives = true;
  type.placed = type.first_only = true;
  type.make = [](const DeviceChoice& choice, const DeviceScene& scene) {
    const std::filesystem::path file = choice.files.at("tracking");
    const track::Tracking tracking = track::read_tracking(file);
    if (tracking.case_token != scene.case_token)
      throw Error(ExitCode::bad_input, file.string(), "case",
                  tracking.case_token + ", and the session is in " + scene.case_token +
                      ": the print of another case was registered");
    if (tracking.case_sha256 != scene.case_sha256)
      throw Error(ExitCode::bad_input, file.string(), "case_sha256",
                  "the case was made again since it was printed: its case.json is another; print this case, or use the "
                  "one that was printed");
    auto device = std::make_unique<LinkedTool>(tracking, scene.tools, choice.of<track::TrackerParams>());
    scene.say({texts::NoteId::waiting_for_tracker, {device->link().endpoint()}});
    device->wait(scene.progress);
    return device;
  };
  return type;
}

}  // namespace trephine::device
