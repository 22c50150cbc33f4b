// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of devices and tools as they are declared, and a session as a window would run one: without a command.
#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "base/write_file.h"
#include "case_samples.h"
#include "device/hand_path.h"
#include "haptics/drilling.h"
#include "haptics_scene.h"
#include "scratch_folder.h"
#include "session/session.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

Error error_of(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& e) {
    return e;
  }
  return Error(ExitCode::ok, "", "", "");
}

session::SessionOptions short_session(const std::filesystem::path& case_folder) {
  session::SessionOptions options;
  options.case_folder = case_folder;
  options.seconds = 0.5;
  options.servo.paced = false;
  device::HandPathParams task;
  task.approach_mm = 0;
  options.device.params = {AnyParams::make(task)};
  return options;
}

const std::atomic<bool> never{false}, at_once{true};
const auto silent = [](const texts::Note&) {};

}  // namespace

TEST(HapticsKinds, DevicesSayWhatTheyAre) {
  std::set<std::string> names;
  for (const device::DeviceType& type : device::device_types()) {
    SCOPED_TRACE(type.name);
    EXPECT_TRUE(names.insert(type.name).second) << "twice";
    EXPECT_FALSE(type.help.empty());
    EXPECT_TRUE(type.make);
    EXPECT_TRUE(type.example.empty() || type.example.find("--device " + type.name) == 0) << type.example;
    for (const cli::Argument& file : type.files) EXPECT_EQ(file.kind, cli::Argument::Kind::in_file) << file.name;
  }
  EXPECT_EQ(names.count(device::DeviceChoice().name), 1u) << "the default is one";
}

TEST(HapticsKinds, DevicesThatCannotBeAreRefused) {
  voxel::HapticVolume v = empty(8, {1, 1, 1});
  fill(v, 1, [](Vec3 p) { return -p.z; });
  const contact::ContactVolume contact(v);
  const device::DeviceScene unpaced{contact, {}, false, false, silent, {}, 0, 0, {}};
  const auto refused = [&](const device::DeviceChoice& choice) {
    return error_of([&] { device::make_device(choice, unpaced); });
  };
  device::DeviceChoice choice;
  choice.name = "mouse";
  EXPECT_EQ(refused(choice).field(), "--device");
  choice.name = "udp";
  EXPECT_EQ(refused(choice).field(), "--no-paced") << "somebody is there";
  choice.name = "trajectory";
  EXPECT_EQ(refused(choice).field(), "--trajectory") << "without its file";
  choice.name = "hand";
  choice.files["trajectory"] = "path.txt";
  EXPECT_EQ(refused(choice).field(), "--trajectory") << "the file of another";
  EXPECT_EQ(refused(choice).code(), ExitCode::usage);
}

TEST(HapticsKinds, ToolsHaveAShape) {
  std::set<std::string> names;
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    SCOPED_TRACE(kind.name);
    EXPECT_TRUE(names.insert(kind.name).second) << "twice";
    EXPECT_NE(std::string(haptics::tool_help()).find(std::string(kind.name) + " (" + kind.help + ")"),
              std::string::npos);
    haptics::ToolParams params;
    params.tool = kind.name;
    if (kind.from_file) continue;  // HapticsTorque.FilesOfPointsAreChecked
    EXPECT_EQ(haptics::make_tool(params).points_mm.empty(), !(kind.length_mm > 0) || kind.exact);
    EXPECT_EQ(!haptics::make_tool(params).round.empty(), kind.exact);
  }
  EXPECT_EQ(names.count(haptics::ToolParams().tool), 1u) << "the default is one";
  haptics::ToolParams params;
  params.tool = "spoon";
  EXPECT_EQ(error_of([&] { haptics::make_tool(params); }).code(), ExitCode::bad_config);
}

// What a tool can do is in its entry alone: whatever cuts has a cutter of that shape, and no other tool has one.
TEST(HapticsKinds, WhatAKindCutsWithIsWhatItsToolCutsWith) {
  haptics::DrillingParams params;
  params.drill = true;
  int cutting = 0;
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) {
    SCOPED_TRACE(kind.name);
    if (kind.from_file) continue;
    haptics::ToolParams tool;
    tool.tool = kind.name;
    tool = haptics::own_tool(tool);
    const Error refused = error_of([&] {
      const drill::Cutter cutter = haptics::cutter_of(params, tool);
      ++cutting;
      if (kind.rotates()) {
        EXPECT_EQ(cutter.kind == drill::Cutter::Kind::ball, kind.cut == haptics::ToolKind::Cut::ball);
      }
    });
    EXPECT_EQ(refused.code() == ExitCode::usage, !kind.cuts());
    if (!kind.cuts()) {
      EXPECT_NE(std::string(refused.what()).find("burr, "), std::string::npos) << refused.what();
    }
  }
  EXPECT_GE(cutting, 5);
}

TEST(HapticsSession, EqualOptionsGiveEqualBytes) {
  const ScratchFolder scratch;
  case_samples::minimal_case().write(scratch.path() / "sample");
  session::SessionOptions options = short_session(scratch.path() / "sample");
  options.tool.tool = "burr";
  for (const char* name : {"a", "b"}) {
    options.record = scratch.path() / name;
    session::Session session(options, never, silent);
    EXPECT_GT(session.tool_points(), 0);
    session.start();
    const session::SessionResult result = session.finish();
    EXPECT_FALSE(session.running());
    EXPECT_EQ(result.statistics.ticks, 500u);
    EXPECT_GT(result.statistics.touching, 0u);
    EXPECT_EQ(result.frames_lost, 0u);
    EXPECT_EQ(result.header.device, "hand");
    EXPECT_EQ(result.header.tool.tool_diameter_mm, 5) << "the tool's own";
  }
  EXPECT_EQ(read_file(scratch.path() / "a"), read_file(scratch.path() / "b"));
}

TEST(HapticsSession, WhatIsNotFinishedLeavesNoFile) {
  const ScratchFolder scratch;
  case_samples::minimal_case().write(scratch.path() / "sample");
  session::SessionOptions options = short_session(scratch.path() / "sample");
  options.record = scratch.path() / "a";
  { session::Session session(options, never, silent); }  // never started
  {
    session::Session session(options, never, silent);
    session.start();
  }
  EXPECT_FALSE(std::filesystem::exists(options.record));
  session::Session stopped(options, at_once, silent);
  stopped.start();
  EXPECT_EQ(stopped.finish().statistics.ticks, 0u);
  EXPECT_TRUE(haptics::read_recording(options.record).frames.empty()) << "a shorter session is one";
}
