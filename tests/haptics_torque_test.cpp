// SPDX-License-Identifier: GPL-3.0-or-later
// Torque on the hand about the tip, tools that are turned about their axis, and tools of a user's own points.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/write_file.h"
#include "haptics/recording.h"
#include "haptics_tools.h"
#include "scratch_folder.h"

using namespace trephine;
using namespace trephine::tools;

namespace {

haptics::ForceParams with_torque(double most = 1e4, double stiffness = 500) {
  haptics::ForceParams p = plain();
  p.max_torque_n_mm = most;
  p.turn_stiffness_n_mm_per_rad = stiffness;
  return p;
}

// A wall that begins at that x.
voxel::HapticVolume wall(double x) {
  voxel::HapticVolume v = empty(60, {1, 1, 1});
  fill(v, 1, [&](Vec3 p) { return p.x - x; });
  return v;
}

std::string points_file(const ScratchFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder.path() / "points.txt";
  write_file(file, text);
  return file.string();
}

haptics::ToolParams points_of(const std::string& file) {
  haptics::ToolParams p;
  p.tool = "points";
  p.tool_points = file;
  return p;
}

}  // namespace

// A ball whose axis leans is pressed where the surface's normal meets it, and not at its tip.
TEST(HapticsTorque, OfABallIsThatOfItsContact) {
  voxel::HapticVolume v = floor_volume(48);
  const contact::ContactVolume contact(v);
  for (const double lean : {0.0, 0.5, -1.0}) {
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), with_torque(), {},
                         haptics::make_tool(params_of("ball", 4)));
    const Vec3 axis = normalized(Vec3{std::sin(lean), 0, std::cos(lean)});
    haptics::HapticState s;
    for (double z = 4; z > -1; z -= 0.02) s = proxy.update(pose(Vec3{0, 0, z + 2} - axis * 2, axis));
    ASSERT_GT(s.force_n.z, 0.8);
    const Vec3 expected = cross((axis - Vec3{0, 0, 1}) * 2, s.force_n);
    EXPECT_LT(norm(s.torque_n_mm - expected), 0.15) << lean;
    if (lean != 0) {
      EXPECT_GT(norm(s.torque_n_mm), 0.5);
    }
  }
}

// A needle that stands before a wall is turned into it: the hand is turned back, within its limits; a free one and a
// point feel no torque.
TEST(HapticsTorque, OfAToolThatIsHeldTurnsTheHandBack) {
  voxel::HapticVolume v = wall(3);
  const contact::ContactVolume contact(v);
  const haptics::Feels feels = one_shape(1, face(1), face(1));
  for (const double most : {1e4, 40.0}) {
    haptics::Proxy proxy(contact, feels, with_torque(most), {}, haptics::make_tool(params_of("needle", 2, 25)));
    haptics::HapticState s;
    for (int n = 0; n < 100; ++n) {
      s = proxy.update(pose({0, 0, -10}, {0, 0, 1}));
      ASSERT_EQ(s.torque_n_mm, Vec3{});
    }
    for (int n = 0; n <= 600; ++n) {
      const double turn = 0.001 * n;
      s = proxy.update(pose({0, 0, -10}, {std::sin(turn), 0, std::cos(turn)}));
    }
    // Turned from z towards x about +y: the wall turns it back about -y.
    EXPECT_LT(s.torque_n_mm.y, -20);
    EXPECT_LT(std::abs(s.torque_n_mm.x) + std::abs(s.torque_n_mm.z), 0.2 * -s.torque_n_mm.y);
    EXPECT_LE(norm(s.torque_n_mm), most * (1 + 1e-12));
    haptics::HapticInput bad = pose({0, 0, -10}, {0, 0, 1});
    bad.tip_mm.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(proxy.update(bad).torque_n_mm, Vec3{}) << "a fault";
  }
  haptics::Proxy point(contact, feels, with_torque());
  point.update(pose({0, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(point.update(pose({4, 0, 0}, {1, 0, 1})).torque_n_mm, Vec3{});
  EXPECT_GT(norm(point.state().force_n), 0.5);
}

// It rises no faster than the limits allow, also after a stall.
TEST(HapticsTorque, ItsRateIsLimitedAsTheForcesIs) {
  voxel::HapticVolume v = wall(3);
  const contact::ContactVolume contact(v);
  haptics::ForceParams force = with_torque(100, 2000);
  force.max_force_n = 3;
  force.max_force_rate_n_per_s = 300;  // the whole in 10 ms, so a tenth of it in a tick of 1 ms
  haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), force, {},
                       haptics::make_tool(params_of("needle", 2, 25)));
  proxy.update(pose({0, 0, -10}, {0, 0, 1}));
  Vec3 before;
  for (int n = 0; n < 40; ++n) {
    haptics::HapticInput in = pose({0, 0, -10}, {0.5, 0, 1});
    in.period_s = 0.001;
    in.dt_s = n == 20 ? 0.05 : 0.001;
    const Vec3 now = proxy.update(in).torque_n_mm;
    if (n == 20) {
      EXPECT_LT(norm(now), norm(before)) << "the device let it decay";
    } else {
      EXPECT_LE(norm(now - before), 10 + 1e-9) << n;
    }
    before = now;
  }
  EXPECT_GT(norm(before), 90);
}

// What is known of the turn about the axis turns a tool that is not round, and stands in its recording.
TEST(HapticsTorque, AToolIsTurnedAboutItsAxis) {
  const ScratchFolder folder;
  // A blade: it reaches 4 mm to one side.
  const haptics::Tool blade =
      haptics::make_tool(points_of(points_file(folder, "# x y z\n0 0 0\n2 0 1\n4,0,2\n\n0\t0\t20\r\n")));
  ASSERT_EQ(blade.points_mm.size(), 4u);
  EXPECT_EQ(blade.points_mm[2], (Vec3{4, 0, 2}));
  EXPECT_EQ(blade.length_mm, 20);
  voxel::HapticVolume v = wall(2);
  const contact::ContactVolume contact(v);
  const auto new_proxy = [&] {
    return haptics::Proxy(contact, one_shape(1, face(1), face(1)), with_torque(), {}, blade);
  };
  haptics::Proxy proxy = new_proxy();
  haptics::HapticInput in = pose({0, 0, 0}, {0, 0, 1});
  std::vector<haptics::ServoFrame> frames;
  haptics::HapticState s;
  for (int n = 0; n <= 1600; ++n) {
    const double turn = 3.14 - 0.002 * std::min(n, 1250);  // from away from the wall towards it
    in.across = {std::cos(turn), std::sin(turn), 0};
    in.period_s = 0.001;
    s = proxy.update(in);
    if (n < 600) {
      EXPECT_LT(norm(s.across - in.across), 1e-9) << n;
      EXPECT_EQ(s.touched, 0);
    }
    haptics::ServoFrame f;
    f.tick = std::uint64_t(n);
    f.time_s = 0.001 * (n + 1);
    f.dt_s = 0.001;
    haptics::put_input(in, f);
    haptics::put_answer(s, f);
    frames.push_back(f);
  }
  // The wall at x = 2 stops the edge, which is 4 mm away from the axis.
  EXPECT_EQ(s.touched, 1);
  EXPECT_LT(4 * s.across.x, 2.1 - s.proxy_mm.x);
  EXPECT_GT(s.force_n.x, -2);
  EXPECT_LT(s.force_n.x, -0.5);
  EXPECT_NEAR(s.torque_n_mm.z, -4 * s.across.y * s.force_n.x, 0.2) << "back the way it came";

  haptics::RecordingHeader header;
  header.knows_across = true;
  const auto file = folder.path() / "blade.servo";
  const auto write = [&](const std::vector<haptics::ServoFrame>& all) {
    haptics::RecordingWriter writer(file, header);
    writer.add(all);
    writer.finish();
    return haptics::read_recording(file);
  };
  const haptics::Recording read = write(frames);
  ASSERT_TRUE(read.header.knows_across);
  ASSERT_EQ(read.frames.size(), frames.size());
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(read.frames[n], frames[n]));
  haptics::Proxy again = new_proxy();
  const std::vector<haptics::ServoFrame> replayed = haptics::replay_frames(read.frames, 1000, again);
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(replayed[n], frames[n])) << n;
  header.knows_across = false;
  EXPECT_EQ(write(frames).frames[100].across[0], 0);
}

// Another version is refused with both named, and so is a header without one of its keys.
TEST(HapticsTorque, OnlyItsOwnVersionIsRead) {
  const ScratchFolder folder;
  const auto file = folder.path() / "a.servo";
  haptics::RecordingWriter writer(file, {});
  writer.add({haptics::ServoFrame()});
  writer.finish();
  const std::vector<char> written = read_file(file);
  const auto refused = [&](const std::string& bytes) -> std::string {
    write_file(file, bytes);
    try {
      haptics::read_recording(file);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field() + ": " + e.what();
    }
    return "read";
  };
  const std::string text(written.begin(), written.end());
  ASSERT_EQ(refused(text), "read");
  for (const int version : {1, int(haptics::recording_version) - 1, int(haptics::recording_version) + 1}) {
    std::string other = text;
    other[8] = char(version);
    EXPECT_EQ(refused(other), "version: " + std::to_string(version) + ", this program reads version " +
                                  std::to_string(haptics::recording_version) + ": record it anew");
  }
  std::string without = text;
  without.replace(without.find("\"max_step_s\""), 12, "\"max_step_x\"");
  EXPECT_EQ(refused(without).rfind("force.max_step_s: ", 0), 0u) << refused(without);
}

// The digest by which a recording knows its case's materials: of all that is felt, and of nothing that is only seen.
TEST(HapticsTorque, ARecordingKnowsTheMaterials) {
  const haptics::Feels feels = one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2));
  const std::string recorded = haptics::feel_digest(feels);
  EXPECT_EQ(haptics::feel_digest(feels), recorded);
  haptics::Feels seen = feels;
  seen[1].colour_rgb = {0, 0, 0};
  EXPECT_EQ(haptics::feel_digest(seen), recorded) << "what is only seen is not felt";
  for (double cases::MaterialParams::*value :
       {&cases::MaterialParams::drag_n_s_per_mm, &cases::MaterialParams::shaft_friction_n_per_mm}) {
    haptics::Feels other = feels;
    other[2].*value += 0.001;
    EXPECT_NE(haptics::feel_digest(other), recorded);
  }
  haptics::Feels other = feels;
  other[1].back.touchable = !other[1].back.touchable;
  EXPECT_NE(haptics::feel_digest(other), recorded);
}

// A time that is not finite is neither written nor read: a playback would never come to its end.
TEST(HapticsTorque, TimesThatAreNotFiniteAreRefused) {
  const ScratchFolder folder;
  const auto file = folder.path() / "a.servo";
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const std::size_t count : {1u, 3u}) {
      std::vector<haptics::ServoFrame> frames(count);
      for (std::size_t n = 0; n < count; ++n) {
        frames[n].tick = n;
        frames[n].time_s = 0.001 * double(n + 1);
      }
      {
        haptics::RecordingWriter writer(file, {});
        writer.add(frames);
        writer.finish();
        ASSERT_EQ(haptics::read_recording(file).frames.size(), count);
      }
      std::vector<char> bytes = read_file(file);
      std::memcpy(bytes.data() + bytes.size() - haptics::short_frame_bytes + offsetof(haptics::ServoFrame, time_s),
                  &bad, 8);
      write_file(file, {bytes.data(), bytes.size()});
      EXPECT_THROW(haptics::read_recording(file), Error) << bad << " in the last of " << count;
      frames.back().time_s = bad;
      haptics::RecordingWriter writer(file, {});
      EXPECT_THROW(writer.add(frames), Error) << bad;
    }
}

TEST(HapticsTorque, FilesOfPointsAreChecked) {
  const ScratchFolder folder;
  const auto code = [&](const haptics::ToolParams& p) {
    try {
      haptics::make_tool(p);
    } catch (const Error& e) {
      return int(e.code());
    }
    return 0;
  };
  EXPECT_EQ(code(points_of(points_file(folder, "1 2 3\n"))), 0);
  for (const char* text : {"", "0 0 0\n", "1 2\n", "1 2 3 4\n", "1 2 x\n", "1 2 nan\n", "1 2 401\n", "1 2 1e999\n"})
    EXPECT_EQ(code(points_of(points_file(folder, text))), 65) << text;
  std::string many;
  for (int n = 1; n < 2048; ++n) many += "1 0 " + std::to_string(n / 10.0) + "\n";
  EXPECT_EQ(code(points_of(points_file(folder, many))), 0);
  EXPECT_EQ(code(points_of(points_file(folder, many + "1 1 1\n"))), 65);
  EXPECT_EQ(code(points_of((folder.path() / "none").string())), 66);
  haptics::ToolParams p = params_of("needle");
  p.tool_points = "points.txt";
  EXPECT_EQ(code(p), 64);
  p = {};
  p.tool = "points";
  EXPECT_EQ(code(p), 64);
  // A recording's hash holds a replay to the same points.
  const haptics::ToolParams own = haptics::own_tool(points_of(points_file(folder, "1 2 3\n")));
  EXPECT_EQ(own.tool_points_sha256.size(), 64u);
  EXPECT_EQ(code(own), 0);
  points_file(folder, "1 2 4\n");
  EXPECT_EQ(code(own), 65);
}
