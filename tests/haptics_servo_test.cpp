// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <limits>
#include <new>
#include <thread>

#include "base/error.h"
#include "base/write_file.h"
#include "device/hand_path.h"
#include "device/simulated_hand.h"
#include "device/trajectory_device.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "haptics_only_sleep.h"
#include "haptics_scene.h"
#include "scratch_folder.h"
#include "session/force_figures.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

struct Scene {
  voxel::HapticVolume volume = empty(40, {0.5, 0.5, 0.5});
  haptics::Feels feels = one_shape(1, face(0.6, 0.3, 0.2, 0, 0.0003), face(0.6, 0.3, 0.2));
  haptics::ForceParams force;
  Scene() {
    fill(volume, 1, [](Vec3 p) { return -p.z + 0.3 * std::sin(p.x); });
  }
};

haptics::ServoParams unpaced() {
  haptics::ServoParams p;
  p.paced = p.realtime = false;
  return p;
}

device::SimulatedHand hand_over(const contact::ContactVolume& contact, const haptics::Feels& feels) {
  device::HandPathParams task;
  task.radius_mm = 4;
  device::HandPath path = device::path_over(contact, haptics::touchable_of(feels), task);
  return device::SimulatedHand(device::HandParams{}, std::move(path.points_mm), path.loop_from);
}

const std::atomic<bool> never{false};

// Answers from a list, then is lost.
class FailingDevice : public device::Device {
 public:
  int good = 100;
  Vec3 tip_mm{0, 0, -1};
  std::vector<Vec3> sent;
  double damping_n_s_per_mm() const override { return 0; }
  bool read(double, device::DeviceReading& out) override {
    out.tip_mm = tip_mm;
    return good-- > 0;
  }
  void send(Vec3 force_n) override { sent.push_back(force_n); }
};

}  // namespace

TEST(HapticsServo, AHandPressesAndFollowsAPath) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  device::SimulatedHand hand = hand_over(contact, s.feels);
  haptics::Proxy proxy(contact, s.feels, s.force);
  haptics::FrameQueue queue(20000);
  haptics::Servo servo(proxy, hand, unpaced(), &queue);
  servo.run(20000, never);
  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  ASSERT_EQ(frames.size(), 20000u);
  EXPECT_EQ(queue.dropped(), 0u);
  const session::ForceFigures f = session::force_figures(frames, session::force_window(frames));
  EXPECT_GT(f.touching, 15000u);
  EXPECT_EQ(f.anomaly_ratio, 0);
  EXPECT_LT(f.zero_force_ratio, 1e-9);
  EXPECT_LT(f.max_step_n, 0.05);
  // The aim lies 1 mm in: spring against arm.
  EXPECT_NEAR(f.mean_force_n, 0.6 * 0.4 / (0.6 + 0.4), 0.08);
  EXPECT_EQ(servo.statistics().faults, 0u);
}

TEST(HapticsServo, ReplayIsBitForBit) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  device::SimulatedHand hand = hand_over(contact, s.feels);
  haptics::ShaftParams shaft;
  shaft.shaft_length_mm = 40;
  haptics::Proxy proxy(contact, s.feels, s.force, shaft);
  haptics::FrameQueue queue(5000);
  haptics::Servo servo(proxy, hand, unpaced(), &queue);
  servo.run(5000, never);
  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  const ScratchFolder folder;
  haptics::RecordingHeader header;
  header.case_token = "sample";
  header.device = "hand";
  header.contact.step_ratio = 0.3;
  header.force.max_force_n = 1.0 / 3;
  header.shaft = shaft;
  const auto file = folder.path() / "a.servo";
  haptics::RecordingWriter writer(file, header);
  writer.add(frames);
  writer.finish();
  const haptics::Recording read = haptics::read_recording(file);
  EXPECT_EQ(read.header.case_token, "sample");
  EXPECT_EQ(read.header.contact.step_ratio, 0.3);
  EXPECT_EQ(read.header.force.max_force_n, 1.0 / 3);
  EXPECT_EQ(read.header.shaft.shaft_length_mm, 40);
  ASSERT_EQ(read.frames.size(), frames.size());
  haptics::Proxy again(contact, s.feels, s.force, shaft);
  const std::vector<haptics::ServoFrame> replayed = haptics::replay_frames(read.frames, read.header.rate_hz, again);
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(frames[n], replayed[n])) << n;
  // With another spring it is not.
  haptics::Proxy other(contact, one_shape(1, face(0.61), face(0.6)), s.force, shaft);
  EXPECT_FALSE(
      haptics::same_frame(frames.back(), haptics::replay_frames(read.frames, read.header.rate_hz, other).back()));

  // Damaged in every way that shows.
  const std::vector<char> good = read_file(file);
  const auto refused = [&](std::vector<char> bytes) {
    write_file(file, {bytes.data(), bytes.size()});
    try {
      haptics::read_recording(file);
    } catch (const Error& e) {
      return e.code() == ExitCode::bad_input && e.file() == file.string();
    }
    return false;
  };
  std::vector<char> b = good;
  std::fill_n(b.end() - static_cast<std::ptrdiff_t>(haptics::short_frame_bytes), 8,
              char(-1));  // the last tick: 2^64 - 1
  EXPECT_TRUE(refused(b));
  b = good;
  b.resize(good.size() - 1);
  EXPECT_TRUE(refused(b));
  b.resize(100);
  EXPECT_TRUE(refused(b));
  b.resize(0);
  EXPECT_TRUE(refused(b));
  for (const std::size_t at : {0u, 8u, 15u, 16u}) {
    b = good;
    b[at] = char(0x7f);
    EXPECT_TRUE(refused(b)) << at;
  }
}

// H5
TEST(HapticsServo, ALostDeviceIsZeroForceWithinTwoTicks) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  s.force.ramp_s = 0;
  FailingDevice device;
  device.tip_mm = {0, 0, 1};
  haptics::Proxy proxy(contact, s.feels, s.force);
  haptics::Servo servo(proxy, device, unpaced(), nullptr);
  servo.run(1, never);
  device.tip_mm = {0, 0, -1};
  servo.run(50, never);
  ASSERT_GT(norm(device.sent.back()), 0.3);
  device.good = 0;
  servo.run(2, never);
  EXPECT_EQ(device.sent.back(), Vec3{});
  EXPECT_EQ(servo.statistics().faults, haptics::haptic_fault::device_lost);
  device.good = 1000;
  servo.run(100, never);
  EXPECT_EQ(device.sent.back(), Vec3{}) << "latched";
}

// H1, through the loop: whatever a device says, what it is sent is finite.
TEST(HapticsServo, ADeviceThatSaysNonsenseIsSentZero) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    FailingDevice device;
    haptics::Proxy proxy(contact, s.feels, s.force);
    haptics::Servo servo(proxy, device, unpaced(), nullptr);
    servo.run(20, never);
    device.tip_mm.y = bad;
    servo.run(1, never);
    EXPECT_EQ(device.sent.back(), Vec3{});
    EXPECT_EQ(servo.statistics().faults, haptics::haptic_fault::pose);
  }
}

// A light hand with a strong damper, within its own ranges, follows its aim and does not diverge.
TEST(HapticsServo, ALightHandUnderStrongDampingComesToRest) {
  device::HandParams params;
  params.mass_kg = 0.005;
  params.arm_damping_n_s_per_mm = params.device_damping_n_s_per_mm = 1;
  params.arm_stiffness_n_per_mm = 10;
  params.tremor_mm = params.delay_s = 0;
  device::SimulatedHand hand(params, {Vec3{}, Vec3{5, 0, 0}}, 1);
  device::DeviceReading r;
  for (int n = 0; n < 3000; ++n) ASSERT_TRUE(hand.read(0.001, r)) << n;
  EXPECT_NEAR(r.tip_mm.x, 5, 0.01);
}

// H5: what nobody renews is held, then decays.
TEST(HapticsServo, AStalledServoLetsTheForceDecay) {
  const device::ForceHold hold;
  EXPECT_EQ(hold.share(0), 1);
  EXPECT_EQ(hold.share(hold.hold_s), 1);
  EXPECT_NEAR(hold.share(hold.hold_s + hold.decay_s), std::exp(-1), 1e-12);
  device::HandParams params;
  params.arm_stiffness_n_per_mm = params.tremor_mm = 0;
  device::SimulatedHand hand(params, {Vec3{}});
  device::DeviceReading r;
  hand.read(0, r);
  hand.send({1, 0, 0});
  hand.read(0.3, r);
  const double early = r.tip_mm.x;
  hand.read(3, r);
  // The impulse is 15 ms of 1 N; after that only damping acts: m v / b.
  EXPECT_GT(early, 0.5);
  EXPECT_NEAR(r.tip_mm.x, 0.015 / 0.006, 0.02);
}

// H6: under a filter that kills at any system call but the sleep; and no allocation.
__attribute__((noinline)) void* operator new(std::size_t size) {
  if (counting_allocations) ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void* p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void* p, std::size_t) noexcept { std::free(p); }

TEST(HapticsServo, ItsTicksSleepAndMakeNoOtherSystemCall) {
  if (sanitized) GTEST_SKIP() << "sanitizers make calls of their own";
  Scene s;
  s.feels[1].front.pop_through_n = 0.2;
  s.feels[1].shaft_friction_n_per_mm = 0.01;
  haptics::ShaftParams shaft;
  shaft.shaft_length_mm = 30;
  const contact::ContactVolume contact(s.volume);
  for (const char* kind : {"point", "burr"}) {
    device::SimulatedHand hand = hand_over(contact, s.feels);
    haptics::ToolParams tool;
    tool.tool = kind;
    haptics::Proxy proxy(contact, s.feels, s.force, shaft, haptics::make_tool(tool));
    haptics::FrameQueue queue(4096);
    haptics::ServoParams params;
    params.realtime = false;
    haptics::Servo servo(proxy, hand, params, &queue);
    const pid_t child = fork();
    if (child == 0) {
      allow_only_sleep();
      counting_allocations = true;
      servo.run(700, never);
      counting_allocations = false;
      syscall(SYS_exit_group, allocations != 0 ? 1 : servo.statistics().touching < 10 ? 2 : 0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << "1: allocated; 2: no contact; 3: no filter";
  }
}

// A tool that is turned while it presses; its recording replays bit for bit, and not with another tool.
TEST(Recording, ReplacesARecordingAndNothingElse) {
  const ScratchFolder folder;
  const auto file = folder.path() / "a.servo", other = folder.path() / "case.json";
  for (int n = 0; n < 2; ++n) {
    haptics::RecordingWriter writer(file, {});
    writer.finish();
  }
  EXPECT_EQ(haptics::read_recording(file).frames.size(), 0u);
  write_file(other, "{}");
  try {
    haptics::RecordingWriter writer(other, {});
    FAIL() << "a file that is no recording is replaced";
  } catch (const Error& e) {
    EXPECT_EQ(int(e.code()), 73);
    EXPECT_NE(std::string(e.what()).find("no recording"), std::string::npos);
  }
  EXPECT_EQ(std::filesystem::file_size(other), 2u);
}

TEST(HapticsServo, ReplayWithAToolIsBitForBit) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  std::vector<device::TrajectoryPoint> path;
  for (int n = 0; n < 40; ++n)
    path.push_back({0.1 * n,
                    {{3 * std::sin(0.7 * n), 3 * std::cos(0.9 * n), n % 5 == 0 ? 3.0 : -1.0},
                     normalized(Vec3{std::sin(0.5 * n), 0.5 * std::cos(n), 1}),
                     0,
                     {}}});
  device::Trajectory device(path);
  haptics::RecordingHeader header;
  header.tool.tool = "craniotome";
  header.tool.tool_search = haptics::ToolParams::Search::tail_to_tip;
  header.tool = haptics::own_tool(header.tool);
  haptics::Proxy proxy(contact, s.feels, s.force, {}, haptics::make_tool(header.tool));
  haptics::FrameQueue queue(4096);
  haptics::Servo servo(proxy, device, unpaced(), &queue);
  servo.run(4000, never);
  EXPECT_GT(servo.statistics().touching, 1000u);
  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  const ScratchFolder folder;
  haptics::RecordingWriter writer(folder.path() / "a.servo", header);
  writer.add(frames);
  writer.finish();
  const haptics::Recording read = haptics::read_recording(folder.path() / "a.servo");
  EXPECT_EQ(read.header.tool.tool, "craniotome");
  EXPECT_EQ(read.header.tool.tool_search, haptics::ToolParams::Search::tail_to_tip);
  EXPECT_EQ(read.header.tool.tool_diameter_mm, header.tool.tool_diameter_mm);
  haptics::Proxy again(contact, s.feels, s.force, {}, haptics::make_tool(read.header.tool));
  const std::vector<haptics::ServoFrame> replayed = haptics::replay_frames(read.frames, read.header.rate_hz, again);
  for (std::size_t n = 0; n < frames.size(); ++n) ASSERT_TRUE(haptics::same_frame(frames[n], replayed[n])) << n;
  haptics::Proxy point(contact, s.feels, s.force);
  EXPECT_FALSE(
      haptics::same_frame(frames.back(), haptics::replay_frames(read.frames, read.header.rate_hz, point).back()));
}

TEST(HapticsServo, KeepsToTheClock) {
  Scene s;
  const contact::ContactVolume contact(s.volume);
  device::SimulatedHand hand = hand_over(contact, s.feels);
  haptics::Proxy proxy(contact, s.feels, s.force);
  haptics::FrameQueue queue(4096);
  haptics::ServoParams params;
  params.realtime = false;
  haptics::Servo servo(proxy, hand, params, &queue);
  std::thread thread([&] { servo.run(300, never); });
  std::vector<haptics::ServoFrame> frames;  // drained while it runs
  while (frames.size() < 300) {
    queue.drain(frames);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  thread.join();
  EXPECT_EQ(servo.statistics().ticks, 300u);
  EXPECT_EQ(servo.statistics().late.count(), 300u);
  double time = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    EXPECT_EQ(frames[n].tick, n);
    const double periods = frames[n].dt_s * 1000;
    EXPECT_NEAR(periods, std::round(periods), 1e-9);  // a late tick stands for whole periods
    time += frames[n].dt_s;
  }
  EXPECT_NEAR(frames.back().time_s, time, 1e-9);
}

TEST(HapticsServo, TrajectoriesAreReadAndPlayed) {
  const ScratchFolder folder;
  const auto file = folder.path() / "path.txt";
  write_file(file, "# time x y z\n0 1 2 3\n\n1, 3, 2, 3, 0, 0, 2, 5 # with an axis\r\n3 3 2 -1\n");
  device::Trajectory t(device::read_trajectory(file));
  device::DeviceReading r;
  t.read(0, r);
  EXPECT_EQ(r.tip_mm, (Vec3{1, 2, 3}));
  t.read(0.5, r);
  EXPECT_EQ(r.tip_mm, (Vec3{2, 2, 3}));
  t.read(0.5, r);
  EXPECT_EQ(r.buttons, 5u);
  EXPECT_EQ(r.axis, (Vec3{0, 0, 1}));
  t.read(1, r);
  EXPECT_EQ(r.tip_mm, (Vec3{3, 2, 1}));
  t.read(100, r);
  EXPECT_EQ(r.tip_mm, (Vec3{3, 2, -1}));
  for (const char* bad : {"", "0 1 2\n", "0 1 2 nan\n", "0 1 2 3\n0 1 2 3\n", "0 1 2 3 0 0 0\n", "0 1 2 3x\n",
                          "0 1 2 3 0 0 1 -1\n", "0 1 2 1e999\n", "a\n"}) {
    write_file(file, bad);
    EXPECT_THROW(device::read_trajectory(file), Error) << bad;
  }
}

TEST(HapticsServo, HistogramsGiveQuantiles) {
  haptics::Histogram h;
  for (int n = 1; n <= 10000; ++n) h.add(n);
  EXPECT_NEAR(h.mean_ns(), 5000.5, 1e-9);
  EXPECT_NEAR(h.quantile_ns(0.5), 5000, 200);
  EXPECT_NEAR(h.quantile_ns(0.99), 9900, 400);
  EXPECT_EQ(h.quantile_ns(1), 10000);
  EXPECT_EQ(h.max_ns(), 10000);
}
