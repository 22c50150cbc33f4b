// SPDX-License-Identifier: GPL-3.0-or-later
// Drilling within the tick: forces, replay, breach, and what a tick may not do.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "device/simulated_hand.h"
#include "drill/live_surface.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "haptics_only_sleep.h"
#include "haptics_tools.h"
#include "voxel/raw_voxel.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

const std::atomic<bool> no_stop{false};
constexpr double inner_table = -4;  // of the bone, whose outer surface is at 0

// Bone of 4 mm, a gap, and brain below; voxels of 0.5 mm, ramps as voxelize makes them.
voxel::HapticVolume plate() {
  voxel::HapticVolume v = empty(48, {0.5, 0.5, 0.5});
  fill(v, 1, [](Vec3 p) { return 0.5 * std::min(-p.z, p.z - inner_table); });
  fill(v, 2, [](Vec3 p) { return 0.5 * (-6 - p.z); });
  return v;
}

struct DrillingScene {
  voxel::HapticVolume volume = plate();
  contact::ContactVolume contact{volume};
  haptics::Feels feels = untouchable();
  drill::DrillShapes shapes;
  haptics::ForceParams force;
  haptics::DrillingParams params;
  drill::DrillParams law;
  haptics::ToolParams tool = params_of("ball", 3);
  drill::DirtyBricks marks{volume.voxels};
  DrillingScene() {
    feels[1].front = feels[1].back = face(1, 0.35, 0.3, 0, 0.0003);
    feels[2].front = face(0.08, 0.3, 0.25, 0, 0.0002);
    shapes[1] = {true, 0.1};
    params.drill = true;
    law.power_w = 3;
  }
  std::unique_ptr<haptics::Drilling> drilling() {
    return std::make_unique<haptics::Drilling>(volume, contact, shapes, params, law,
                                               haptics::cutter_of(params, haptics::own_tool(tool)), &marks);
  }
};

// A hand that feeds down to 7 mm, with a small circle.
device::SimulatedHand feeding(double to_mm = -4.6) {
  std::vector<Vec3> path{{0, 0, 2}};
  for (int n = 0; n <= 60; ++n) path.push_back({std::cos(0.5 * n), std::sin(0.5 * n), 1 + (to_mm - 1) * n / 60.0});
  device::HandParams p;
  p.speed_mm_per_s = 8;
  p.arm_stiffness_n_per_mm = 1;
  device::SimulatedHand hand(p, path, path.size() - 1);
  hand.drills = true;
  hand.feed_force_n = 1;
  return hand;
}

}  // namespace

// The hand comes through; the breach is where the inner table is; forces keep to the device's limits; brain is not cut.
TEST(HapticsDrilling, AHandDrillsThroughAPlate) {
  DrillingScene s;
  const grid::Grid<std::int16_t> before = s.volume.voxels;
  const auto drilling = s.drilling();
  haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
  device::SimulatedHand hand = feeding();
  haptics::FrameQueue queue(1 << 15);
  haptics::ServoParams servo_params;
  servo_params.paced = false;
  haptics::Servo servo(proxy, hand, servo_params, &queue, drilling.get());
  servo.run(9000, no_stop);
  std::vector<haptics::ServoFrame> frames;
  queue.drain(frames);
  const haptics::DrillingOutcome& o = drilling->outcome();
  const double removed = double(o.units[1]) / 255 * 0.125;
  std::printf("  %.1f mm3 in %.1f s, through at %.2f s, z %.3f mm; most force %.2f N on bone, %.2f N on brain\n",
              removed, o.drilled_s, o.breach_time_s, o.breach_mm.z, o.most_force_n[1], o.most_force_n[2]);
  ASSERT_TRUE(o.breached);
  EXPECT_NEAR(o.breach_mm.z, inner_table, 0.3);
  EXPECT_GT(removed, 25);
  EXPECT_EQ(o.units[2], 0);
  EXPECT_GT(o.most_force_n[1], 0.2);
  Vec3 last;
  for (const haptics::ServoFrame& f : frames) {
    const Vec3 is{f.force_n[0], f.force_n[1], f.force_n[2]};
    EXPECT_LE(norm(is), s.force.max_force_n + 1e-12);
    EXPECT_LE(norm(is - last), s.force.force_rate_n_per_s() * 0.001 + 1e-9) << f.tick;
    EXPECT_EQ(f.faults, 0u);
    last = is;
  }
  int cut = 0;
  for (std::size_t n = 0; n < before.voxels.size(); ++n)
    cut += before.voxels[n] / 1000 == 2 && s.volume.voxels.voxels[n] != before.voxels[n];
  EXPECT_EQ(cut, 0) << "brain was cut";

  // 11: the replay, from a volume as it was.
  DrillingScene again;
  const auto drills_again = again.drilling();
  haptics::Proxy proxy_again(again.contact, again.feels, again.force, {}, haptics::make_tool(again.tool));
  const std::vector<haptics::ServoFrame> replayed =
      haptics::replay_frames(frames, 1000, proxy_again, drills_again.get());
  std::size_t different = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) different += !haptics::same_frame(frames[n], replayed[n]);
  EXPECT_EQ(different, 0u);
  EXPECT_EQ(haptics::volume_digest(again.volume), haptics::volume_digest(s.volume));
  EXPECT_NE(haptics::volume_digest(plate()), haptics::volume_digest(s.volume));
}

// "What must be shown", 12: bone that vanishes under the tip. The force falls within the rate limit, and the tool takes
// no energy out of nothing: what the hand gets back is no more than it put in.
TEST(HapticsDrilling, BoneThatVanishesUnderTheTip) {
  DrillingScene s;
  s.params.vibration_n = 0;
  s.force.ramp_s = 0;
  haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
  const auto drilling = s.drilling();
  haptics::HapticInput in = pose({0, 0, 1}, {0, 0, 1});
  double energy = 0, most = 0;
  Vec3 last = in.tip_mm, force;
  for (int n = 0; n < 3000; ++n) {
    in.tip_mm.z = std::max(-1.5, 1 - 0.005 * n);
    energy -= dot(force, in.tip_mm - last);
    last = in.tip_mm;
    if (n == 1500) {  // all at once
      for (std::int16_t& v : s.volume.voxels.voxels)
        if (v / 1000 == 1) v = voxel::haptic_empty;
      s.contact.loosen(grid::whole_box(s.volume.voxels));
    }
    in.buttons = n > 1000 && n < 1500 ? haptics::Drilling::pedal : 0;
    drilling->prepare(in);
    const Vec3 before = force;
    const haptics::HapticState& is = proxy.update(in);
    drilling->tick(in, is);
    force = is.force_n;
    ASSERT_LE(norm(force - before), s.force.force_rate_n_per_s() * 0.001 + 1e-9) << n;
    most = std::max(most, norm(force));
    ASSERT_GE(energy, -1e-6) << n;
  }
  EXPECT_GT(most, 0.5);
  EXPECT_EQ(proxy.state().touched, 0);
  EXPECT_LT(norm(force), 1e-6);
}

// A mastoid's worth of drilling, felt: 60 s of winding strokes with a burr of 2 mm through bone full of air cells, as
// far as a tick of each ms allows. The hand never gets back more than it put in, no voxel rises, and the bricks that
// followed are closed and those of a surface made anew.
TEST(HapticsDrilling, AMinuteThroughCellularBone) {
  voxel::HapticVolume volume = empty(90, {0.4, 0.4, 0.4});
  fill(volume, 1, [](Vec3 p) {
    Vec3 cell;
    for (int a = 0; a < 3; ++a) cell[a] = p[a] - 4 * std::round(p[a] / 4);
    return 0.5 * std::min(2 - p.z + 0.5 * std::sin(p.x), norm(cell) - 1.2);
  });
  const grid::Grid<std::int16_t> first = volume.voxels;
  contact::ContactVolume contact(volume);
  haptics::Feels feels = one_shape(1, face(1, 0.35, 0.3, 0, 0.0003), face(1, 0.35, 0.3, 0, 0.0003));
  drill::DrillShapes shapes;
  shapes[1] = {true, 0.1};
  haptics::DrillingParams params;
  params.drill = true;
  params.vibration_n = 0;  // it does work of its own
  params.stall_force_n = 8;
  haptics::ForceParams force;
  force.ramp_s = 0;
  const haptics::ToolParams tool = params_of("ball", 2);
  drill::DirtyBricks marks(volume.voxels);
  haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, haptics::own_tool(tool)),
                             &marks);
  haptics::Proxy proxy(contact, feels, force, {}, haptics::make_tool(tool));
  drill::LiveSurface bone(volume, 1);
  std::vector<std::size_t> marked;
  double energy = 0, least = 0;
  int risen = 0, touching = 0;
  Vec3 last, sent;
  grid::Grid<std::int16_t> before = first;
  for (int tick = 0; tick < 60000; ++tick) {
    const double t = 0.001 * tick, r = 4 + 0.12 * t;
    haptics::HapticInput in = pose({r * std::cos(2.3 * t), r * std::sin(2.1 * t), 4 - 0.25 * t + 0.8 * std::sin(5 * t)},
                                   {0.2 * std::sin(t), 0.2, 1});
    in.buttons = haptics::Drilling::pedal;
    drilling.prepare(in);
    if (tick > 0) energy -= dot(sent, in.tip_mm - last);
    least = std::min(least, energy);
    last = in.tip_mm;
    const haptics::HapticState& is = proxy.update(in);
    ASSERT_EQ(is.faults, 0u);
    sent = is.force_n;
    touching += is.touched != 0;
    drilling.tick(in, is);
    if (tick % 17 == 0) {
      marked.clear();
      marks.take(marked);
      bone.update(marked);
    }
    if (tick % 6000 != 0) continue;
    for (std::size_t n = 0; n < before.voxels.size(); ++n) {
      const voxel::detail::RawVoxel was = voxel::detail::split(before.voxels[n]),
                                    now = voxel::detail::split(volume.voxels.voxels[n]);
      risen += now.share > was.share || (now.number != 0 && now.number != was.number);
    }
    before = volume.voxels;
  }
  marked.clear();
  marks.take(marked);
  bone.update(marked);
  const double removed = double(drilling.outcome().units[1]) / voxel::haptic_full * volume.voxels.voxel_volume_mm3();
  std::printf("  %.0f mm3 removed, in contact %.0f %%, the hand put in %.1f N mm, at least %.4f at any time\n", removed,
              touching / 600.0, energy, least);
  EXPECT_GT(removed, 300);
  EXPECT_GT(touching, 10000);
  EXPECT_GE(least, -1e-6);
  EXPECT_EQ(risen, 0);
  const drill::LiveSurface anew(volume, 1);
  int differ = 0;
  std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
  for (std::size_t n = 0; n < anew.layout().count(); ++n) {
    const drill::BrickMesh &a = anew.brick(n), &b = bone.brick(n);
    differ += a.indices != b.indices || a.vertices.size() != b.vertices.size() ||
              (!a.vertices.empty() &&
               std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(drill::LiveVertex)) != 0);
    for (std::size_t t = 0; t < b.indices.size(); ++t) {
      const auto at = [&](std::size_t corner) {
        const float* p = b.vertices[b.indices[corner]].position_mm;
        return std::array<float, 3>{p[0], p[1], p[2]};
      };
      const auto p = at(t), q = at(t % 3 == 2 ? t - 2 : t + 1);
      p < q ? ++edges[{p, q}] : --edges[{q, p}];
    }
  }
  EXPECT_EQ(differ, 0);
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; }), 0) << "open edges";
}

// "What must be shown", 8: the whole tick, contact and removal, with a burr of 7 mm that lies in the bowl which it
// drills. CPU time, printed for the documents, for what a tick costs hangs on the machine.
TEST(HapticsDrilling, ATickWithABurrOf7Mm) {
  for (const double side : {0.8, 0.4}) {
    const int n = int(28 / side);
    voxel::HapticVolume volume = empty(n, {side, side, side});
    fill(volume, 1, [](Vec3 p) { return 0.5 * (4 - p.z); });
    contact::ContactVolume contact(volume);
    drill::DrillShapes shapes;
    shapes[1] = {true, 0.1};
    haptics::DrillingParams params;
    params.drill = true;
    const haptics::ToolParams tool = params_of("ball", 7);
    drill::DirtyBricks marks(volume.voxels);
    haptics::Drilling drilling(volume, contact, shapes, params, {}, haptics::cutter_of(params, haptics::own_tool(tool)),
                               &marks);
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.35, 0.3), face(1, 0.35, 0.3)), plain(), {},
                         haptics::make_tool(tool));
    std::vector<double> us;
    int touching = 0;
    for (int tick = 0; tick < 4000; ++tick) {
      const double t = 0.001 * tick;
      haptics::HapticInput in = pose({4 * std::cos(5 * t), 4 * std::sin(5 * t), 5 - 1.5 * t}, {0, 0, 1});
      in.buttons = haptics::Drilling::pedal;
      timespec before{}, after{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
      drilling.prepare(in);
      const haptics::HapticState& is = proxy.update(in);
      drilling.tick(in, is);
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
      us.push_back(1e6 * double(after.tv_sec - before.tv_sec) + 1e-3 * double(after.tv_nsec - before.tv_nsec));
      touching += is.touched != 0;
    }
    std::sort(us.begin(), us.end());
    std::printf("  %.1f mm: p50 %.1f, p99 %.1f, max %.1f us, in contact %.0f %%, %.0f mm3\n", side, us[us.size() / 2],
                us[us.size() * 99 / 100], us.back(), touching / 40.0,
                double(drilling.outcome().units[1]) / voxel::haptic_full * volume.voxels.voxel_volume_mm3());
    EXPECT_GT(touching, 400);
  }
}

// Where the feed is too hard the drill stalls and removes nothing.
TEST(HapticsDrilling, StallsWhereTheFeedIsTooHard) {
  for (const double stall : {0.5, 50.0}) {
    DrillingScene s;
    s.params.stall_force_n = stall;
    s.force.ramp_s = 0;
    haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
    const auto drilling = s.drilling();
    haptics::HapticInput in = pose({0, 0, 1}, {0, 0, 1});
    for (int n = 0; n < 400; ++n) {
      in.tip_mm.z = n < 50 ? 1 : -2;
      in.buttons = n >= 100 && n < 110 ? haptics::Drilling::pedal : 0;
      in.extra_n = drilling->force_n();
      drilling->tick(in, proxy.update(in));
    }
    EXPECT_EQ(drilling->outcome().stalled_s > 0, stall < 1);
    EXPECT_EQ(drilling->outcome().units[1] > 0, stall > 1);
  }
}

// The pedal alone lets it cut; the second button cuts what is not drilled, once for each time that it goes down.
TEST(HapticsDrilling, PedalAndIncision) {
  DrillingScene s;
  s.shapes[2] = {true, 0};  // brain stands for skin here
  s.params.incision_radius_mm = 3;
  haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
  const auto drilling = s.drilling();
  haptics::HapticInput in = pose({0, 0, -2}, {0, 0, 1});
  for (int n = 0; n < 100; ++n) drilling->tick(in, proxy.update(in));
  EXPECT_EQ(drilling->outcome().units[1], 0) << "no pedal";
  in.tip_mm = {0, 0, -6};
  in.buttons = haptics::Drilling::mark;
  for (int n = 0; n < 100; ++n) drilling->tick(in, proxy.update(in));
  EXPECT_EQ(drilling->outcome().incisions, 1);
  EXPECT_GT(drilling->outcome().units[2], 0);
  EXPECT_EQ(drilling->outcome().units[1], 0);
  in.buttons = haptics::Drilling::pedal;
  for (int n = 0; n < 100; ++n) drilling->tick(in, proxy.update(in));
  EXPECT_GT(drilling->outcome().units[1], 0) << "the burr reaches bone";
}

// What a recording of another program says of the tool's turn may be no direction across it: then it is not known.
TEST(HapticsDrilling, ATurnThatIsNoneLeavesTheCutAsItIs) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto cut = [](Vec3 across) {
    DrillingScene s;
    s.tool = params_of("craniotome");
    s.params.cutter_width_ratio = 0.3;
    const auto drilling = s.drilling();
    haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
    haptics::ServoFrame f;
    f.dt_s = 0.001;
    f.axis[2] = 1;
    for (int a = 0; a < 3; ++a) f.across[a] = across[a];
    f.buttons = haptics::Drilling::pedal;
    std::vector<haptics::ServoFrame> frames(400, f);
    for (std::size_t n = 0; n < frames.size(); ++n) frames[n].tip_mm[2] = 2 - 0.01 * double(n);
    haptics::replay_frames(frames, 1000, proxy, drilling.get());
    EXPECT_GT(drilling->outcome().units[1], 0);
    return s.volume.voxels.voxels;
  };
  const auto unknown = cut({});
  for (const Vec3 across :
       {Vec3{nan, 0, 0}, Vec3{1, 0, nan}, Vec3{inf, 0, 0}, Vec3{0, -inf, 1}, Vec3{1e300, 0, 0}, Vec3{0, 0, 1}})
    EXPECT_TRUE(cut(across) == unknown) << across.x << " " << across.y << " " << across.z;
  EXPECT_FALSE(cut(normalized({1, 1, 0})) == unknown) << "a turn that is one counts";
}

// H6 with a drill: no system call but the sleep, and no allocation.
TEST(HapticsDrilling, ItsTicksSleepAndMakeNoOtherSystemCall) {
  if (sanitized) GTEST_SKIP() << "sanitizers make calls of their own";
  DrillingScene s;
  const auto drilling = s.drilling();
  haptics::Proxy proxy(s.contact, s.feels, s.force, {}, haptics::make_tool(s.tool));
  device::SimulatedHand hand = feeding();
  haptics::FrameQueue queue(4096);
  haptics::ServoParams params;
  params.realtime = false;
  params.rate_hz = 4000;
  haptics::Servo servo(proxy, hand, params, &queue, drilling.get());
  const pid_t child = fork();
  if (child == 0) {
    allow_only_sleep();
    counting_allocations = true;
    servo.run(5000, no_stop);
    counting_allocations = false;
    syscall(SYS_exit_group, allocations != 0 ? 1 : drilling->outcome().units[1] == 0 ? 2 : 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "killed by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0) << "1: allocated; 2: nothing drilled; 3: no filter";
}

TEST(HapticsDrilling, OnlySomeToolsCut) {
  for (const char* kind : {"point", "needle", "catheter", "jamshidi"})
    EXPECT_ANY_THROW(haptics::cutter_of({}, haptics::own_tool(params_of(kind)))) << kind;
  EXPECT_EQ(haptics::cutter_of({}, haptics::own_tool(params_of("burr", 7))).radius_mm, 3.5);
  EXPECT_EQ(haptics::cutter_of({}, haptics::own_tool(params_of("craniotome"))).kind, drill::Cutter::Kind::cylinder);
}
