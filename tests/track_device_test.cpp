// SPDX-License-Identifier: GPL-3.0-or-later
// A tracked tool as a device: by a clock of the test, and through a socket of libopenigtlink's own server.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "base/write_file.h"
#include "haptics/haptic_state.h"
#include "scratch_folder.h"
#include "track/pose_source.h"
#include "track/tracked_device.h"
#include "track_fake.h"

using namespace track_fake;
using track::TrackedDevice;
using track::Tracking;

namespace {

Tracking tracking_of(const Theatre& t) {
  Tracking tracking;
  tracking.case_token = "head";
  tracking.reference = "Head";
  tracking.reference_to_case = rows_of(inverse(t.case_to_reference));
  tracking.target_error_mm = 0.3;
  track::TrackedTool tool;
  tool.body = "Pointer";
  tool.tip_mm = t.tip_mm;
  tool.axis = t.axis;
  tool.tip_error_mm = 0.4;
  tracking.tools.push_back(tool);
  tool.body = "Drill";
  tool.lesson_tool = "burr";
  tracking.tools.push_back(tool);
  return tracking;
}

/// A tool that is tracked at 50 Hz, and a loop of 1 kHz, both by one clock.
struct Scene {
  Theatre theatre;
  double now_s = 10;
  TrackedDevice device;
  track::MessageStream stream;
  device::DeviceReading reading;
  Vec3 last_mm;
  double most_step_mm = 0;
  explicit Scene(const std::vector<std::string>& lesson_tools = {})
      : device(tracking_of(theatre), lesson_tools, 0.2, 0.2, [this] { return now_s; }) {}
  void come(const Bytes& bytes) {
    ASSERT_TRUE(feed(stream, bytes, [this](const auto& h, const auto& c) { device.take(h, c); }));
  }
  void pose(const std::string& body, Vec3 tip_mm, Vec3 axis = {0, 0, 1}) {
    come(transform(body, theatre.body_at(tip_mm, axis), 500 + now_s));
    come(transform("Head", theatre.reference_to_tracker, 500 + now_s));
  }
  void ticks(int count) {
    for (int n = 0; n < count; ++n) {
      now_s += 0.001;
      EXPECT_TRUE(device.read(0.001, reading)) << "it is lost for good";
      most_step_mm = std::max(most_step_mm, norm(reading.tip_mm - last_mm));
      last_mm = reading.tip_mm;
    }
  }
};

TEST(TrackedDevice, ItsPosesAreThoseOfTheCase) {
  Scene s;
  s.pose("Pointer", {1, 2, 3}, normalized(Vec3{0.2, -0.1, 1}));
  s.ticks(1);
  EXPECT_FALSE(s.reading.silent);
  EXPECT_LT(norm(s.reading.tip_mm - Vec3{1, 2, 3}), 2e-3);
  EXPECT_LT(norm(s.reading.axis - normalized(Vec3{0.2, -0.1, 1})), 1e-4);
  EXPECT_EQ(s.reading.buttons, 0u);
  EXPECT_NEAR(s.device.place_error_mm(), 0.5, 1e-12);
  EXPECT_TRUE(s.device.seen());
  s.pose("Drill", {50, 50, 50});  // not in hand
  s.ticks(1);
  EXPECT_LT(norm(s.reading.tip_mm - Vec3{1, 2, 3}), 2e-3);
}

// 200 mm/s at 50 Hz are steps of 4 mm; no tick sees one.
// It was turned about the ball's middle, and touches with its foremost point.
TEST(TrackedDevice, ATipThatIsABallIsItsForemostPoint) {
  const Theatre theatre;
  Tracking ball = tracking_of(theatre);
  ball.tools[0].tip_ball_mm = 4;
  double now_s = 10;
  TrackedDevice device(ball, {}, 0.2, 0.2, [&] { return now_s; });
  track::MessageStream stream;
  const Vec3 axis = normalized(Vec3{0.2, -0.1, 1});
  device::DeviceReading reading;
  EXPECT_TRUE(device.read(0.001, reading));
  EXPECT_TRUE(reading.silent && (reading.buttons & haptics::haptic_button::lifted)) << "it was never seen";
  for (const Bytes& bytes : {transform("Pointer", theatre.body_at({1, 2, 3}, axis), 510),
                             transform("Head", theatre.reference_to_tracker, 510)})
    ASSERT_TRUE(feed(stream, bytes, [&](const auto& h, const auto& c) { device.take(h, c); }));
  now_s += 0.001;
  EXPECT_TRUE(device.read(0.001, reading));
  EXPECT_LT(norm(reading.tip_mm - (Vec3{1, 2, 3} - axis * 2)), 2e-3);
  EXPECT_EQ(reading.buttons, 0u);
}

TEST(TrackedDevice, BetweenPosesItMovesEvenly) {
  Scene s;
  for (int n = 0; n < 40; ++n) {
    s.pose("Pointer", {4.0 * n, 0, 0});
    s.ticks(20);
    if (n == 1) s.most_step_mm = 0;
  }
  EXPECT_GT(s.reading.tip_mm.x, 4.0 * 38 - 0.5);
  EXPECT_LT(s.most_step_mm, 0.25);
}

TEST(TrackedDevice, ATrackerThatSaysNothingLeavesItAtRest) {
  Scene s;
  s.pose("Pointer", {1, 2, 3});
  s.ticks(150);
  EXPECT_FALSE(s.reading.silent);
  s.ticks(100);
  EXPECT_TRUE(s.reading.silent);
  const Vec3 rests = s.reading.tip_mm;
  s.ticks(500);
  EXPECT_EQ(s.reading.tip_mm, rests);
  s.pose("Pointer", {90, 2, 3});  // it comes again, elsewhere, and is there at once
  s.ticks(1);
  EXPECT_FALSE(s.reading.silent);
  EXPECT_LT(norm(s.reading.tip_mm - Vec3{90, 2, 3}), 2e-3);
  const auto counts = s.device.counts();
  EXPECT_EQ(counts.back(), (std::pair<std::string, std::uint64_t>{"gaps", 1}));
}

// A tool that is seen without its reference is nowhere.
TEST(TrackedDevice, WithoutItsReferenceItIsLost) {
  Scene s;
  s.pose("Pointer", {1, 2, 3});
  for (int n = 0; n < 20; ++n) {
    s.ticks(20);
    s.come(transform("Pointer", s.theatre.body_at({1, 2, 3.0 + n}, {0, 0, 1}), 500 + s.now_s));
  }
  EXPECT_TRUE(s.reading.silent);
}

TEST(TrackedDevice, AStatusThatIsNotWellLosesItUntilThereIsAPose) {
  Scene s;
  s.pose("Pointer", {1, 2, 3});
  s.ticks(10);
  s.come(status(13, 500 + s.now_s));
  s.ticks(1);
  EXPECT_TRUE(s.reading.silent);
  s.pose("Pointer", {1, 2, 3});
  s.ticks(1);
  EXPECT_FALSE(s.reading.silent);
}

// What is refused does not count as a sign of life.
TEST(TrackedDevice, PosesThatAreRefusedDoNotKeepItAlive) {
  for (const int kind : {0, 1, 2, 3}) {
    Scene s;
    s.pose("Pointer", {1, 2, 3});
    for (int n = 0; n < 20; ++n) {
      s.ticks(20);
      RigidMap body = s.theatre.body_at({1, 2, 3}, {0, 0, 1});
      double stamp = 500 + s.now_s;
      if (kind == 0) body.turn.column[0] = -body.turn.column[0];
      if (kind == 1) body.offset_mm.x = std::nan("");
      if (kind == 2) stamp -= 0.5;
      Bytes bytes = transform("Pointer", body, stamp);
      if (kind == 3) bytes.back() ^= 1;
      s.come(bytes);
      s.come(transform("Head", s.theatre.reference_to_tracker, 500 + s.now_s));
    }
    EXPECT_TRUE(s.reading.silent) << kind;
    EXPECT_LT(norm(s.reading.tip_mm - Vec3{1, 2, 3}), 2e-3) << kind;
  }
}

TEST(TrackedDevice, TheBodyFollowsTheToolInHand) {
  Scene s({"marker", "burr"});
  const auto both = [&] {
    s.pose("Pointer", {1, 0, 0});
    s.pose("Drill", {0, 70, 0});
  };
  both();
  s.ticks(1);
  EXPECT_LT(norm(s.reading.tip_mm - Vec3{1, 0, 0}), 2e-3);
  device::DeviceNews news;
  news.tool = 1;
  s.device.tell(news);
  s.ticks(1);
  EXPECT_TRUE(s.reading.silent) << "the pose of another tool is taken for this one's";
  both();
  s.ticks(1);
  EXPECT_FALSE(s.reading.silent);
  EXPECT_LT(norm(s.reading.tip_mm - Vec3{0, 70, 0}), 2e-3);
}

void until(const std::function<bool()>& is) {
  for (int n = 0; n < 60000 && !is(); ++n) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ASSERT_TRUE(is());
}

TEST(TrackedDevice, AServerMayGoAndComeBack) {
  Theatre t;
  Server server;
  track::TrackerParams params;
  params.tracker_port = server.port();
  TrackedDevice device(tracking_of(t), {}, 0.5, 0.2, track::steady_s);
  std::atomic<int> begun{0};
  track::TrackerLink link(
      params, [&](const auto& h, const auto& c) { device.take(h, c); }, [&] { ++begun, device.begin_anew(); });
  device::DeviceReading reading;
  const auto reads = [&](bool silent) {
    until([&] { return device.read(0.001, reading) && reading.silent == silent; });
  };
  reads(true);
  const auto frame_of = [&](Vec3 tip, double clock_s) {
    return [&t, tip, clock_s](double now_s) {
      return std::vector<Bytes>{
          tdata({{"Pointer", t.body_at(tip, {0, 0, 1})}, {"Head", t.reference_to_tracker}}, clock_s + now_s)};
    };
  };
  server.start(frame_of({1, 2, 3}, 9000));
  reads(false);
  EXPECT_LT(norm(reading.tip_mm - Vec3{1, 2, 3}), 2e-3);
  server.stop();
  reads(true);
  EXPECT_LT(norm(reading.tip_mm - Vec3{1, 2, 3}), 2e-3);
  server.start(frame_of({5, 2, 3}, 100));  // with another clock
  reads(false);
  EXPECT_LT(norm(reading.tip_mm - Vec3{5, 2, 3}), 2e-3);
  EXPECT_EQ(begun, 2);
}

TEST(TrackedDevice, PosesAreTakenForCalibrationsAndTheLackOfThemIsExplained) {
  Theatre t;
  Server server;
  server.start([&](double now_s) {
    return std::vector<Bytes>{transform("Pointer", t.body_at({1, 2, 3}, {0, 0, 1}), now_s),
                              transform("Head", t.reference_to_tracker, now_s), status(1, now_s)};
  });
  track::TrackerParams params;
  params.tracker_port = server.port();
  params.tracker_wait_s = 60;
  {
    track::PoseSource source(params, {"Pointer"}, "Head");
    const std::vector<RigidMap> poses = source.take(0, 25, {});
    ASSERT_EQ(poses.size(), 25u);
    for (const RigidMap& p : poses) EXPECT_LT(norm(p(t.tip_mm) - t.case_to_reference({1, 2, 3})), 2e-3);
  }
  params.tracker_wait_s = 1;
  // On a machine that does much else the connection may take longer than that.
  const auto says = [&](const std::string& tool, const std::string& part) {
    for (int n = 0; n < 30; ++n) {
      track::PoseSource none(params, {tool}, "Head");
      try {
        none.take(0, 1, {});
        ADD_FAILURE() << "a pose of " << tool;
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::no_input);
        if (std::string(e.what()).find(part) != std::string::npos) return true;
      }
    }
    return false;
  };
  EXPECT_TRUE(says("Stylus", "it sends other bodies: Pointer"));
  server.stop();
  EXPECT_TRUE(says("Pointer", "nobody answers"));
}

TEST(TrackingFile, IsWrittenAndReadAgain) {
  const ScratchFolder folder;
  const auto file = folder.path() / "t.json";
  const Tracking is = tracking_of({});
  write_file(file, track::to_json(is));
  EXPECT_EQ(track::to_json(track::read_tracking(file)), track::to_json(is));
  EXPECT_EQ(track::tool_for(is, "burr"), 1);
  EXPECT_EQ(track::tool_for(is, "catheter"), 0);
  const auto refuses = [&](const std::function<void(Tracking&)>& spoil) {
    Tracking t = is;
    spoil(t);
    write_file(file, track::to_json(t));
    EXPECT_THROW(track::read_tracking(file), Error);
  };
  refuses([](Tracking& t) { t.tools.clear(); });
  refuses([](Tracking& t) { t.reference_to_case[0] *= -1; });
  refuses([](Tracking& t) { t.reference_to_case[5] = 2; });
  refuses([](Tracking& t) { t.tools[0].axis = {0, 0, 2}; });
  refuses([](Tracking& t) { t.tools[1].body = t.reference; });
  refuses([](Tracking& t) { t.trephine_tracking = 2; });
}

}  // namespace
