// SPDX-License-Identifier: GPL-3.0-or-later
// Random sessions with every thread that a servo has beside it: a recorder, a device's socket with a client that may
// vanish, one that comes after it, and a stranger; a servo that drills beside a mesher and somebody who settles, or
// somebody else who removes voxels; somebody who looks. What sanitizers watch (presets headless-tsan, headless-asan).
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>
#include <thread>

#include "base/progress.h"
#include "device/hand_path.h"
#include "device/simulated_hand.h"
#include "device/udp_device.h"
#include "device_udp_client.h"
#include "drill/live_surface.h"
#include "haptics/servo.h"
#include "haptics/tool.h"
#include "haptics_scene.h"
#include "voxel/raw_voxel.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;
using Clock = std::chrono::steady_clock;

namespace {

void sleep_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

// Two nested, bumpy balls.
voxel::HapticVolume balls(std::mt19937_64& rng) {
  voxel::HapticVolume v = empty(48, {uniform(rng, 0.3, 1.2), uniform(rng, 0.3, 1.2), uniform(rng, 0.3, 1.2)});
  const Vec3 s = v.voxels.spacing_mm;
  const double r = 18 * std::min({s.x, s.y, s.z}), bumps = uniform(rng, 0, 1);
  fill(v, 1, [&](Vec3 p) { return r + bumps * std::sin(p.x) - norm(p); });
  fill(v, 2, [&](Vec3 p) { return 0.6 * r - norm(p); });
  return v;
}

// What a servo that drills has beside it, and what must hold of the voxels when it has ended.
class Cutting {
 public:
  Cutting(voxel::HapticVolume& volume, contact::ContactVolume& contact, const haptics::ToolParams& tool)
      : volume_(volume), contact_(contact), before_(volume.voxels), marks_(volume.voxels) {
    drill::DrillShapes shapes;
    shapes[1] = {true, 0.05};
    shapes[2] = {true, 0};  // cut by the incision alone
    haptics::DrillingParams params;
    params.drill = true;
    params.incision_radius_mm = 4;
    drilling_ = std::make_unique<haptics::Drilling>(volume, contact, shapes, params, drill::DrillParams{},
                                                    haptics::cutter_of(params, haptics::own_tool(tool)), &marks_);
    for (const int number : {1, 2}) surfaces_.push_back(std::make_unique<drill::LiveSurface>(volume, number));
  }
  haptics::Drilling* drilling() { return drilling_.get(); }

  void mesh(const std::atomic<bool>& stop) {
    while (!stop) {
      follow();
      sleep_ms(16);
    }
  }
  void settle(std::uint64_t seed, const std::atomic<bool>& stop) {
    std::mt19937_64 rng(seed);
    while (!stop) {
      grid::Box box;
      for (std::size_t a = 0; a < 3; ++a) {
        box.begin[a] = int(rng() % std::uint64_t(volume_.voxels.size[a] - 10));
        box.end[a] = box.begin[a] + 10;
      }
      contact_.settle(box);
      sleep_ms(int(rng() % 10));
    }
  }
  // When all threads have ended: no shape's share is larger anywhere, and the bricks are those of a surface made anew.
  std::int64_t finish() {
    follow();
    int risen = 0, differ = 0;
    for (int k = 0; k < before_.size[2]; ++k)
      for (int j = 0; j < before_.size[1]; ++j)
        for (int i = 0; i < before_.size[0]; ++i) {
          if (before_.at(i, j, k) == volume_.voxels.at(i, j, k)) continue;
          for (const int shape : {1, 2})
            risen += voxel::detail::share_of(volume_.voxels, shape, i, j, k) >
                     voxel::detail::share_of(before_, shape, i, j, k);
        }
    EXPECT_EQ(risen, 0);
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
      const drill::LiveSurface fresh(volume_, int(n) + 1);
      for (std::size_t b = 0; b < fresh.layout().count(); ++b) {
        const drill::BrickMesh &is = surfaces_[n]->brick(b), &wanted = fresh.brick(b);
        differ += is.indices != wanted.indices || is.vertices.size() != wanted.vertices.size() ||
                  (!is.vertices.empty() && std::memcmp(is.vertices.data(), wanted.vertices.data(),
                                                       is.vertices.size() * sizeof(drill::LiveVertex)) != 0);
      }
    }
    EXPECT_EQ(differ, 0) << "bricks";
    return drilling_->outcome().units[1] + drilling_->outcome().units[2];
  }

 private:
  void follow() {
    marked_.clear();
    marks_.take(marked_);
    for (const auto& s : surfaces_) s->update(marked_);
  }
  voxel::HapticVolume& volume_;
  contact::ContactVolume& contact_;
  const grid::Grid<std::int16_t> before_;
  drill::DirtyBricks marks_;
  std::unique_ptr<haptics::Drilling> drilling_;
  std::vector<std::unique_ptr<drill::LiveSurface>> surfaces_;
  std::vector<std::size_t> marked_;
};

// Lowers voxels along a random way, as a drill does, and lets the contact volume know.
void drill(voxel::HapticVolume& volume, contact::ContactVolume& contact, std::uint64_t seed,
           const std::atomic<bool>& stop) {
  std::mt19937_64 rng(seed);
  grid::Grid<std::int16_t>& v = volume.voxels;
  while (!stop) {
    grid::Box box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.begin[a] = int(rng() % std::uint64_t(v.size[a] - 3));
      box.end[a] = box.begin[a] + 3;
    }
    contact.loosen(box);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i)
          __atomic_store_n(&v.at(i, j, k), std::int16_t(voxel::haptic_empty), __ATOMIC_RELAXED);
    grid::Box around;
    for (std::size_t a = 0; a < 3; ++a) {
      around.begin[a] = std::max(0, box.begin[a] - 2);
      around.end[a] = std::min(v.size[a], box.end[a] + 2);
    }
    contact.settle(around);
    sleep_ms(int(rng() % 20));
  }
}

// A client that strokes, jumps and rests, sends some poses twice, may vanish after some of them, and whose last pose
// may not be finite.
void client_of(int port, std::uint64_t seed, bool ends_badly, const std::atomic<bool>& stop) {
  std::mt19937_64 rng(seed);
  const std::uint64_t vanishes = rng() % 3 == 0 ? 20 + rng() % 800 : std::uint64_t(-1);
  UdpClient client(port, std::uint32_t(seed));
  device::UdpForce answer;
  Vec3 at{0, 0, 30}, to = at;
  for (std::uint64_t n = 0; !stop; ++n) {
    if (n == vanishes) return;
    if (rng() % 50 == 0) to = Vec3{uniform(rng, -25, 25), uniform(rng, -25, 25), uniform(rng, -25, 25)};
    if (rng() % 500 == 0) at = to;
    at += (to - at) * 0.05;
    if (rng() % 20 == 0)
      client.next.reading.axis = normalized(Vec3{uniform(rng, -1, 1), uniform(rng, -1, 1), 1 + uniform(rng, 0, 1)});
    if (rng() % 40 == 0) client.next.pedals = std::uint32_t(rng() % 4);
    client.send_pose(at);
    if (rng() % 30 == 0) client.again();
    client.receive(answer, 1);
    EXPECT_TRUE(is_finite(answer.force_n));
  }
  if (ends_badly) client.send_pose(Vec3{} / 0.0);
}

void stranger_of(int port, std::uint64_t seed, const std::atomic<bool>& stop) {
  std::mt19937_64 rng(seed);
  UdpClient client(port, 99);
  while (!stop) {
    std::vector<std::uint8_t> bytes(rng() % 200);
    for (std::uint8_t& b : bytes) b = std::uint8_t(rng());
    client.send_bytes(bytes.data(), bytes.size());
    if (rng() % 10 == 0) client.send_pose({0, 0, 0});
    sleep_ms(int(rng() % 5));
  }
}

struct Seen {
  std::uint64_t episodes = 0, ticks = 0, touching = 0, poses = 0, lost = 0, drilled = 0;
  double removed_mm3 = 0;
};

// One scene, one device, one tool, for about that long.
void episode(std::uint64_t seed, double seconds, Seen& seen) {
  std::mt19937_64 rng(seed);
  voxel::HapticVolume volume = balls(rng);
  contact::ContactParams contact_params;
  if (rng() % 3 == 0) contact_params.surface = contact::ContactParams::Surface::nearest;
  if (rng() % 4 == 0) contact_params.walk = contact::ContactParams::Walk::stepped;
  contact::ContactVolume contact(volume, contact_params);
  haptics::Feels feels = untouchable();
  for (const std::size_t n : {1u, 2u}) {
    feels[n].front = face(uniform(rng, 0.1, 1.5), 0.4, 0.3, rng() % 2 ? uniform(rng, 0.2, 2) : 0, 0.0005);
    feels[n].back = face(0.3, 0.2, 0.1);
    feels[n].drag_n_s_per_mm = 0.001;
    feels[n].shaft_friction_n_per_mm = 0.01;
  }
  haptics::ToolParams tool_params;
  const haptics::ToolKind& kind = haptics::all_tool_kinds()[rng() % haptics::all_tool_kinds().size()];
  if (!kind.from_file) tool_params.tool = kind.name;
  const bool cuts = rng() % 2 == 0;  // the servo itself
  if (cuts) {
    std::vector<const haptics::ToolKind*> cutters;
    for (const haptics::ToolKind& each : haptics::all_tool_kinds())
      if (each.cuts()) cutters.push_back(&each);
    const haptics::ToolKind& cutter = *cutters[rng() % cutters.size()];
    tool_params.tool = cutter.name;
    if (cutter.rotates() && rng() % 2) tool_params.tool_diameter_mm = uniform(rng, 1.5, 7);
  }
  haptics::ShaftParams shaft;
  shaft.shaft_length_mm = rng() % 2 ? 30 : 0;
  const haptics::ForceParams force;
  haptics::Proxy proxy(contact, feels, force, shaft, haptics::make_tool(tool_params));

  const bool by_udp = rng() % 2 == 0;
  haptics::ServoParams params;
  params.realtime = false;
  params.paced = by_udp || rng() % 2 == 0;
  params.rate_hz = params.paced ? 500.0 * double(1 + rng() % 4) : 1000;
  std::unique_ptr<device::Device> device;
  device::UdpDevice* udp = nullptr;
  std::vector<std::thread> threads;
  std::atomic<bool> stop{false}, client_stop{false};
  const bool ends_badly = rng() % 3 == 0, drilled = !cuts && rng() % 2 == 0;
  std::unique_ptr<Cutting> cutting;
  if (cuts) cutting = std::make_unique<Cutting>(volume, contact, tool_params);
  if (by_udp) {
    device::UdpParams p;
    p.port = 0;
    p.timeout_ms = rng() % 4 == 0 ? 20 : 2000;
    auto made = std::make_unique<device::UdpDevice>(p);
    udp = made.get();
    device = std::move(made);
    threads.emplace_back(client_of, udp->port(), rng(), ends_badly, std::cref(client_stop));
    threads.emplace_back(stranger_of, udp->port(), rng(), std::cref(stop));
    if (rng() % 2)  // somebody who holds the tool when the first one is gone
      threads.emplace_back([&client_stop, port = udp->port(), after_ms = 100 + int(rng() % 600), seed2 = rng()] {
        sleep_ms(after_ms);
        client_of(port, seed2, false, client_stop);
      });
    udp->wait(Progress{});
  } else {
    device::HandPathParams task;
    task.radius_mm = uniform(rng, 0, 4);
    task.depth_mm = uniform(rng, 0, 6);
    device::HandPath path = device::path_over(contact, haptics::touchable_of(feels), task);
    auto hand =
        std::make_unique<device::SimulatedHand>(device::HandParams{}, std::move(path.points_mm), path.loop_from);
    hand->drills = cuts;
    device = std::move(hand);
  }
  haptics::FrameQueue queue(1 << 12);
  haptics::Servo servo(proxy, *device, params, &queue, cutting ? cutting->drilling() : nullptr);
  std::atomic<bool> done{false};
  std::thread servo_thread([&] {
    servo.run(std::uint64_t(-1), stop);
    done = true;
  });
  if (drilled) threads.emplace_back(drill, std::ref(volume), std::ref(contact), rng(), std::cref(stop));
  if (cutting) {
    threads.emplace_back([&] { cutting->mesh(stop); });
    threads.emplace_back([&, settles = rng()] { cutting->settle(settles, stop); });
  }

  std::vector<haptics::ServoFrame> frames;
  Vec3 last;
  std::uint64_t next = 0, ticks = 0;
  const auto end = Clock::now() + std::chrono::milliseconds(std::int64_t(1000 * seconds));
  const auto look = [&] {
    frames.clear();
    queue.drain(frames);
    for (const haptics::ServoFrame& f : frames) {
      const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]};
      ASSERT_TRUE(is_finite(is)) << "seed " << seed;
      ASSERT_LE(norm(is), force.max_force_n + 1e-9) << "seed " << seed;
      if (f.faults != 0) {
        ASSERT_EQ(is, Vec3{}) << "seed " << seed;
      } else if (f.tick == next && f.tick > 0) {  // none was dropped between
        ASSERT_LE(norm(is - last), force.force_rate_n_per_s() * f.dt_s + 1e-9) << "seed " << seed;
      }
      next = f.tick + 1;
      last = is;
    }
    ASSERT_GE(servo.ticks_done(), ticks);
    ticks = servo.ticks_done();
    (void)device->counts();
  };
  while (Clock::now() < end && !testing::Test::HasFatalFailure()) {
    look();
    sleep_ms(5);
  }
  client_stop = true;
  if (udp) sleep_ms(60);
  stop = true;
  servo_thread.join();
  for (std::thread& t : threads) t.join();
  look();
  if (cutting) {
    const std::int64_t units = cutting->finish();
    seen.removed_mm3 += double(units) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
    seen.drilled += units > 0;
  }
  ++seen.episodes;
  seen.ticks += servo.statistics().ticks;
  seen.touching += servo.statistics().touching;
  seen.lost += (servo.statistics().faults & haptics::haptic_fault::device_lost) != 0;
  if (udp) seen.poses += device->counts()[0].second;
}

void random_session(double seconds, std::uint64_t seed) {
  Seen seen;
  const auto begin = Clock::now();
  while (Clock::now() - begin < std::chrono::duration<double>(seconds) && !testing::Test::HasFatalFailure())
    episode(seed++, std::min(2.0, 0.25 * seconds), seen);
  std::printf(
      "  %llu episodes, %llu ticks, %llu in contact, %llu poses by UDP, %llu devices lost; %llu drilled, %.0f mm3\n",
      static_cast<unsigned long long>(seen.episodes), static_cast<unsigned long long>(seen.ticks),
      static_cast<unsigned long long>(seen.touching), static_cast<unsigned long long>(seen.poses),
      static_cast<unsigned long long>(seen.lost), static_cast<unsigned long long>(seen.drilled), seen.removed_mm3);
  EXPECT_GT(seen.ticks, 100u);
  EXPECT_GT(seen.touching, 0u);
  if (seconds < 30) return;
  EXPECT_GT(seen.lost, 0u);
  EXPECT_GT(seen.drilled, 0u);
}

}  // namespace

TEST(HapticsSession, RandomForThreeSeconds) { random_session(3, 1); }

TEST(LongHapticsSession, RandomForTenMinutes) { random_session(600, 1000); }
