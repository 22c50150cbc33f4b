// SPDX-License-Identifier: GPL-3.0-or-later
// The UDP device between a client and a running servo loop.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <random>
#include <thread>

#include "base/error.h"
#include "device/udp_device.h"
#include "device_udp_client.h"
#include "haptics/servo.h"
#include "haptics_only_sleep.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;

namespace {

const std::atomic<bool> no_stop{false};

device::UdpParams free_port(double timeout_ms) {
  device::UdpParams p;
  p.port = 0;
  p.timeout_ms = timeout_ms;
  p.wait_s = 300;
  return p;
}

// A floor below z = 0 and a servo over it, from the first pose until this ends.
struct Loop {
  voxel::HapticVolume volume = empty(24, {2, 2, 2});
  contact::ContactVolume contact;
  haptics::Feels feels = one_shape(1, face(0.5), face(0.5));
  haptics::ForceParams force;
  device::UdpDevice device;
  haptics::Proxy proxy;
  haptics::FrameQueue queue{1 << 16};
  haptics::Servo servo;
  std::atomic<bool> stop{false};
  std::thread thread;

  static voxel::HapticVolume& filled(voxel::HapticVolume& v) {
    fill(v, 1, [](Vec3 p) { return -p.z; });
    return v;
  }
  static haptics::ForceParams no_ramp() {
    haptics::ForceParams p;
    p.ramp_s = 0;
    p.max_step_s = 3600;  // a busy machine may stand still for a second
    return p;
  }
  static haptics::ServoParams normal() {
    haptics::ServoParams p;
    p.realtime = false;
    return p;
  }
  explicit Loop(double timeout_ms)
      : contact(filled(volume)),
        force(no_ramp()),
        device(free_port(timeout_ms)),
        proxy(contact, feels, force),
        servo(proxy, device, normal(), &queue) {}
  void start() {
    device.wait(Progress{});
    thread = std::thread([this] { servo.run(60000, stop); });
  }
  std::vector<haptics::ServoFrame> end() {
    stop = true;
    if (thread.joinable()) thread.join();
    std::vector<haptics::ServoFrame> frames;
    queue.drain(frames);
    return frames;
  }
  ~Loop() { end(); }
  std::uint64_t count(const std::string& name) const {
    for (const auto& [n, c] : device.counts())
      if (n == name) return c;
    ADD_FAILURE() << name;
    return 0;
  }
  // Nothing that was sent is still on its way.
  void settle(const std::string& name, std::uint64_t until) const {
    for (int n = 0; n < 60000 && count(name) < until; ++n) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
};

// The client touches down from 1 mm above and presses half a millimetre deep: 0.25 N.
constexpr Vec3 above{0, 0, 1}, pressed{0, 0, -0.5};
void press(Loop& loop, UdpClient& client, device::UdpForce& answer) {
  client.send_pose(above);
  loop.start();
  // A second pose would take the first one's place where the servo's first tick comes late.
  ASSERT_TRUE(client.receive(answer)) << "the first pose was not answered";
  ASSERT_EQ(answer.answers, client.next.sequence);
  ASSERT_TRUE(client.ask(pressed, answer));
  ASSERT_NEAR(answer.force_n.z, 0.25, 0.01);
}

}  // namespace

// Every answer is the force of the very tick that took the pose, bit for bit, and no pose is answered twice.
TEST(HapticsUdp, AnswersAreTheForcesOfTheTicksThatTookThePoses) {
  Loop loop(60000);
  UdpClient client(loop.device.port());
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  std::map<std::uint64_t, std::pair<Vec3, device::UdpForce>> answers;
  for (int n = 0; n < 300; ++n) {
    const Vec3 tip{0.01 * n, 0.003 * n, -0.5 + 0.4 * std::sin(0.1 * n)};
    ASSERT_TRUE(client.ask(tip, answer)) << n;
    EXPECT_EQ(answer.news.faults, 0u);
    EXPECT_TRUE(answers.emplace(answer.answers, std::make_pair(tip, answer)).second);
  }
  const std::vector<haptics::ServoFrame> frames = loop.end();
  for (const auto& [sequence, a] : answers) {
    const auto same = [&](const haptics::ServoFrame& f) {
      return std::memcmp(f.tip_mm, &a.first, 24) == 0 && std::memcmp(f.force_n, &a.second.force_n, 24) == 0 &&
             std::memcmp(f.proxy_mm, &a.second.news.proxy_mm, 24) == 0 && f.time_s == a.second.news.time_s;
    };
    EXPECT_EQ(std::count_if(frames.begin(), frames.end(), same), 1) << sequence;
  }
  EXPECT_EQ(loop.count("poses"), 302u);
  EXPECT_EQ(loop.count("answers"), 302u);
}

// Whoever has an answer in hand finds it counted, however late the device's own thread goes on.
TEST(HapticsUdp, AnAnswerIsCountedBeforeItIsSent) {
  Loop loop(60000);
  UdpClient client(loop.device.port());
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  int missing = 0;
  for (std::uint64_t n = 3; n < 1500; ++n) {
    ASSERT_TRUE(client.ask(pressed, answer));
    missing += loop.count("answers") < n;
  }
  EXPECT_EQ(missing, 0);
}

TEST(HapticsUdp, DuplicatesAndLatePosesAreDropped) {
  Loop loop(60000);
  UdpClient client(loop.device.port());
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  const std::uint64_t newest = client.next.sequence;
  client.next.reading.tip_mm = {0, 0, -3};
  client.again();  // the same number
  client.next.sequence = 1;
  client.again();  // an old one
  client.next.sequence = newest + 10;
  ASSERT_TRUE(client.ask(pressed, answer));  // a gap is no fault
  EXPECT_EQ(loop.count("late"), 2u);
  for (const haptics::ServoFrame& f : loop.end()) EXPECT_GT(f.tip_mm[2], -1) << "a late pose was taken";
}

// Random bytes, cut and damaged packets, from the client's own socket and from others: nothing changes.
TEST(HapticsUdp, RandomDatagramsChangeNothing) {
  Loop loop(60000);
  UdpClient client(loop.device.port()), other(loop.device.port(), 1);
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  const Vec3 force = answer.force_n;
  std::mt19937_64 rng(5);
  std::uint64_t malformed = 0;
  for (int n = 0; n < 20000; ++n) {
    device::UdpPose p = client.next;
    p.sequence += 1 + rng() % 1000;
    p.reading.tip_mm = {0, 0, -4};
    const auto good = device::encode_pose(p);
    std::vector<std::uint8_t> bytes(good.data(), good.data() + good.size());
    switch (rng() % 4) {
      case 0:  // anything at all
        bytes.resize(rng() % 1600);
        for (std::uint8_t& b : bytes) b = std::uint8_t(rng());
        break;
      case 1:  // cut, or followed by something
        bytes.resize(rng() % 2 ? rng() % 96 : 97 + rng() % 100, 0);
        break;
      case 2:  // a bit of magic or version
        bytes[rng() % 6] ^= std::uint8_t(1 << rng() % 8);
        break;
      case 3:  // the right magic, and noise
        for (std::size_t b = 6; b < 56; ++b) bytes[b] = std::uint8_t(rng());
        for (std::size_t b = 56; b < 64; ++b) bytes[b] = std::uint8_t(0x70 + b % 8);  // an axis of 1e240
    }
    (n % 2 ? client : other).send_bytes(bytes.data(), bytes.size());
    if (++malformed % 50 != 0) continue;
    loop.settle("malformed", malformed);  // a full socket would drop them unseen
    ASSERT_EQ(loop.count("malformed"), malformed) << n;
  }
  EXPECT_EQ(loop.count("malformed"), malformed);
  ASSERT_TRUE(client.ask(pressed, answer));
  EXPECT_LT(norm(answer.force_n - force), 1e-9);
  EXPECT_EQ(answer.news.faults, 0u);
  bool down = false;
  for (const haptics::ServoFrame& f : loop.end()) {
    down = down || f.tip_mm[2] == pressed.z;
    const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]};
    EXPECT_LT(norm(is - (down ? force : Vec3{})), 1e-9);
  }
}

// H5: a client that dies. The timeout is long, so that a busy machine keeps it between the two poses of press().
TEST(HapticsUdp, ALostClientIsZeroForceWithinTheTimeout) {
  constexpr double timeout_s = 2;
  Loop loop(1000 * timeout_s);
  device::UdpForce answer;
  {
    UdpClient client(loop.device.port());
    ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  }
  UdpClient late(loop.device.port(), 2);
  for (answer.busy = true; answer.busy; std::this_thread::sleep_for(std::chrono::milliseconds(20)))
    ASSERT_TRUE(late.ask(pressed, answer)) << "who comes later is told";
  EXPECT_EQ(answer.force_n, Vec3{});
  EXPECT_EQ(answer.news.faults, haptics::haptic_fault::device_lost);
  const std::vector<haptics::ServoFrame> frames = loop.end();
  const auto begin =
      std::find_if(frames.begin(), frames.end(), [](const haptics::ServoFrame& f) { return f.tip_mm[2] < 0; });
  const auto lost = std::find_if(begin, frames.end(), [](const haptics::ServoFrame& f) { return f.faults != 0; });
  ASSERT_NE(lost, frames.end());
  for (auto f = begin; f != lost; ++f) EXPECT_GT(f->force_n[2], 0.2) << f->time_s - begin->time_s;
  for (auto f = lost; f != frames.end(); ++f) {
    EXPECT_EQ(f->force_n[2], 0) << f->time_s - begin->time_s;
    EXPECT_EQ(f->faults, haptics::haptic_fault::device_lost);
  }
  // At the first tick after the timeout. A tick that woke late saw the clock, which was further than the loop's time.
  EXPECT_GT(lost->time_s + 1e-6 * lost->late_us - begin->time_s, 0.5 * timeout_s);
  EXPECT_LT((lost - 1)->time_s - begin->time_s, timeout_s + 1e-6 * begin->late_us + 0.1);
}

TEST(HapticsUdp, OneClientAtATime) {
  Loop loop(60000);
  UdpClient first(loop.device.port(), 1), second(loop.device.port(), 2);
  device::UdpForce answer, refused;
  ASSERT_NO_FATAL_FAILURE(press(loop, first, answer));
  const Vec3 force = answer.force_n;
  for (int n = 0; n < 20; ++n) {
    ASSERT_TRUE(second.ask({0, 0, -3}, refused));
    EXPECT_TRUE(refused.busy);
    EXPECT_EQ(refused.force_n, Vec3{});
  }
  EXPECT_EQ(loop.count("strangers"), 20u);
  // Another run behind the first one's socket is another client, too.
  first.next.session = 3;
  ASSERT_TRUE(first.ask({0, 0, -3}, refused));
  EXPECT_TRUE(refused.busy);
  first.next.session = 1;
  ASSERT_TRUE(first.ask(pressed, answer));
  EXPECT_FALSE(answer.busy);
  EXPECT_LT(norm(answer.force_n - force), 1e-9);
  for (const haptics::ServoFrame& f : loop.end()) EXPECT_GT(f.tip_mm[2], -1);
}

// H1
TEST(HapticsUdp, APoseThatIsNotFiniteLatchesZeroForce) {
  for (const bool axis : {false, true}) {
    Loop loop(60000);
    UdpClient client(loop.device.port());
    device::UdpForce answer;
    ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    client.next.version = 2;
    if (axis) client.next.reading.axis.x = nan;
    ASSERT_TRUE(client.ask(axis ? pressed : Vec3{0, nan, 0}, answer));
    EXPECT_EQ(answer.force_n, Vec3{});
    EXPECT_EQ(answer.news.faults, haptics::haptic_fault::pose);
    client.next.reading.axis = {0, 0, 1};
    ASSERT_TRUE(client.ask(pressed, answer));
    EXPECT_EQ(answer.force_n, Vec3{}) << "latched";
  }
}

// A client of version 1 is answered in its own version, and stays with it.
TEST(HapticsUdp, Version1IsStillAnswered) {
  Loop loop(60000);
  UdpClient client(loop.device.port());
  client.next.version = 1;
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  EXPECT_EQ(answer.version, 1);
  EXPECT_FALSE(loop.device.knows_across());
  client.next.version = 2;
  client.send_pose({0, 0, -3});
  loop.settle("malformed", 1);
  EXPECT_EQ(loop.count("malformed"), 1u);
  client.next.version = 1;
  ASSERT_TRUE(client.ask(pressed, answer));
  for (const haptics::ServoFrame& f : loop.end()) {
    EXPECT_GT(f.tip_mm[2], -1);
    EXPECT_EQ(f.across[0], 0);
  }
}

// Every event of every tick is told once, though many ticks have no answer.
TEST(HapticsUdp, EventsComeBackOnce) {
  Loop loop(60000);
  UdpClient client(loop.device.port());
  device::UdpForce answer;
  ASSERT_NO_FATAL_FAILURE(press(loop, client, answer));
  EXPECT_EQ(answer.version, 2);
  std::uint64_t touches = 0, untouches = 0;
  for (int n = 0; n < 40; ++n) {
    client.next.pedals = n % 2;
    ASSERT_TRUE(client.ask(n % 2 ? pressed : above, answer));
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    ASSERT_TRUE(client.ask(n % 2 ? pressed : above,
                           answer));  // what came in between is in this one at the latest
    touches += (answer.news.events & haptics::haptic_event::touch) != 0;
    untouches += (answer.news.events & haptics::haptic_event::untouch) != 0;
  }
  std::uint64_t was_touched = 0, pedal = 0;
  const std::vector<haptics::ServoFrame> frames = loop.end();
  for (const haptics::ServoFrame& f : frames) {
    was_touched += (f.events & haptics::haptic_event::touch) != 0;
    pedal += (f.buttons & haptics::Drilling::pedal) != 0 && f.touched != 0;
    EXPECT_NEAR(f.across[0] * f.across[0] + f.across[1] * f.across[1] + f.across[2] * f.across[2], 1, 1e-9);
  }
  EXPECT_EQ(was_touched, 21u);
  EXPECT_LE(touches, was_touched);
  EXPECT_GE(pedal, 20u);  // one of the ticks of each press at least: a busy machine has few
}

TEST(HapticsUdp, AddressesAreChecked) {
  device::UdpParams p = free_port(50);
  p.address = "localhost";
  EXPECT_THROW(device::UdpDevice{p}, Error);
  p.address = "192.0.2.1";  // of no machine (RFC 5737)
  EXPECT_THROW(device::UdpDevice{p}, Error);
  p.address = "127.0.0.1";
  const device::UdpDevice device(p);
  p.port = device.port();
  EXPECT_THROW(device::UdpDevice{p}, Error) << "in use";
  p.port = 0;
  p.wait_s = 0.02;
  const device::UdpDevice alone(p);
  EXPECT_THROW(alone.wait(Progress{}), Error);
}

// H6, as for the other devices: the thread of the socket is not the servo's.
TEST(HapticsUdp, TheServoMakesNoSystemCallForIt) {
  if (sanitized) GTEST_SKIP() << "sanitizers make calls of their own";
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    Loop loop(60000);
    const int port = loop.device.port();
    (void)!write(ends[1], &port, sizeof port);
    loop.device.wait(Progress{});
    allow_only_sleep();
    counting_allocations = true;
    loop.servo.run(300, no_stop);
    counting_allocations = false;
    syscall(SYS_exit_group, allocations != 0 ? 1 : loop.servo.statistics().touching < 10 ? 2 : 0);
  }
  int port = 0, status = 0;
  ASSERT_EQ(read(ends[0], &port, sizeof port), ssize_t(sizeof port));
  UdpClient client(port);
  device::UdpForce answer;
  client.send_pose(above);
  int answers = 0;
  while (waitpid(child, &status, WNOHANG) == 0) answers += client.ask(pressed, answer, 5);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: allocated; 2: no contact; 3: no filter";
  EXPECT_GT(answers, 10);
  close(ends[0]);
  close(ends[1]);
}
