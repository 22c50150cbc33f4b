// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff a wall may be (H3), and that it gives no energy (H2), in the closed loop with the simulated hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

#include "device/screen_registration.h"
#include "device/simulated_hand.h"
#include "device/workspace.h"
#include "haptics_scene.h"

using namespace trephine;
using namespace trephine::haptic_scenes;
using walls::uniform;

namespace {

constexpr double device_damping = 0.002;  // N s/mm

// A wall across z = 0, without the limits of a device.
struct WallScene {
  voxel::HapticVolume volume = empty(24, {2, 2, 2});
  WallScene() {
    fill(volume, 1, [](Vec3 p) { return -p.z; });
  }
};

haptics::ForceParams unlimited() {
  haptics::ForceParams p = plain();
  p.max_force_n = 1e6;
  p.max_force_rate_n_per_s = 1e12;
  return p;
}

// What lies between hand and wall; its tool moves by `scale` mm for each of the hand.
struct Between {
  double scale = 1;
  std::function<std::unique_ptr<device::Device>(std::unique_ptr<device::Device>)> wrap;
};

// Whether the swing of a hand that presses on the wall, and that only the device damps, dies out.
bool comes_to_rest(const contact::ContactVolume& contact, double stiffness, double damping, double rate_hz,
                   const Between& between = {}) {
  device::HandParams h;
  h.device_damping_n_s_per_mm = device_damping;
  h.arm_damping_n_s_per_mm = h.tremor_mm = h.delay_s = 0;
  h.arm_stiffness_n_per_mm = 0.3;
  h.speed_mm_per_s = 20;
  const double hand_mm = 1 / between.scale;
  std::unique_ptr<device::Device> device = std::make_unique<device::SimulatedHand>(
      h, std::vector<Vec3>{Vec3{0.2, 0.1, 0.1} * hand_mm, Vec3{0.2 * hand_mm, 0.1 * hand_mm, -10}}, 1);
  if (between.wrap) device = between.wrap(std::move(device));
  device::Device& hand = *device;
  haptics::Proxy proxy(contact, one_shape(1, face(stiffness, 0, 0, 0, damping), face(1)), unlimited());
  const double dt = 1 / rate_hz;
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
  const int ticks = int(3 * rate_hz);
  for (int n = 0; n < ticks; ++n) {
    device::DeviceReading r;
    if (!hand.read(n == 0 ? 0 : dt, r)) return false;
    hand.send(proxy.update(at(r.tip_mm, dt)).force_n);
    const int part = n * 3 / ticks;
    low[part] = std::min(low[part], r.tip_mm.z);
    high[part] = std::max(high[part], r.tip_mm.z);
  }
  const double before = high[1] - low[1], after = high[2] - low[2];
  return after < 1e-3 || (after < 0.9 * before && after < 1);
}

double stiffest(const contact::ContactVolume& contact, double damping, double rate_hz, const Between& between = {}) {
  double low = 0.3, high = 200;
  while (high / low > 1.03) {
    const double middle = std::sqrt(low * high);
    (comes_to_rest(contact, middle, damping, rate_hz, between) ? low : high) = middle;
  }
  return low;
}

struct Energy {
  double min_j = 0, generated_j = 0, theory_j = 0;  // with the device's damping; without it; K T v depth
  int strokes = 0;
};

// Strokes into the wall and out, each as fast and as deep as it comes. The energy that the wall took from the hand, and
// the device's damping, from the moment before each stroke.
Energy strokes(const contact::ContactVolume& contact, double stiffness, const cases::CaseFace& feel, double rate_hz,
               int count, std::mt19937_64& rng) {
  Energy e;
  const double dt = 1 / rate_hz;
  cases::CaseFace wall = feel;
  wall.stiffness_n_per_mm = stiffness;
  haptics::Proxy proxy(contact, one_shape(1, wall, face(1)), unlimited());
  for (int s = 0; s < count; ++s) {
    device::HandParams h;
    h.device_damping_n_s_per_mm = device_damping;
    h.arm_stiffness_n_per_mm = std::pow(10.0, uniform(rng, -1.5, 0.5));
    h.arm_damping_n_s_per_mm = uniform(rng, 0, 0.002);
    h.delay_s = 0;
    h.tremor_mm = uniform(rng, 0, 0.5);
    h.tremor_hz = uniform(rng, 5, 50);
    h.speed_mm_per_s = std::pow(10.0, uniform(rng, 1.3, 3.3));
    const double depth = uniform(rng, 0.1, 6);
    device::SimulatedHand hand(h, {{0.2, 0.1, 1}, {0.2 + uniform(rng, -3, 3), 0.1, -depth}, {0, 0, 12}}, 2);
    proxy.reset();
    double with = 0, without = 0, deepest = 0, fastest = 0;
    Vec3 last, force;
    for (int n = 0; n < int(0.2 * rate_hz); ++n) {
      device::DeviceReading r;
      hand.read(n == 0 ? 0 : dt, r);
      if (n > 0) {
        const Vec3 d = r.tip_mm - last;
        without += -1e-3 * dot(force, d);
        with += -1e-3 * dot(force, d) + 1e-3 * device_damping * dot(d, d) / dt;
        if (r.tip_mm.z < 0) fastest = std::max(fastest, std::abs(d.z) / dt);
      }
      e.min_j = std::min(e.min_j, with);
      deepest = std::max(deepest, -r.tip_mm.z);
      last = r.tip_mm;
      force = proxy.update(at(r.tip_mm, dt)).force_n;
      hand.send(force);
    }
    ++e.strokes;
    if (-without > e.generated_j) {
      e.generated_j = -without;
      e.theory_j = 1e-3 * stiffness * dt * fastest * deepest;
    }
  }
  return e;
}

}  // namespace

TEST(HapticsLimits, TheStiffestWallIsWhatTheoryAllows) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  std::printf("  rate Hz  damping N s/mm  stiffest N/mm  2 (b - B) / T\n");
  for (const double rate : {250.0, 1000.0, 4000.0, 10000.0})
    for (const double damping : {0.0, 0.0005}) {
      const double found = stiffest(contact, damping, rate), theory = 2 * (device_damping - damping) * rate;
      std::printf("  %7.0f  %14.4f  %13.2f  %13.2f\n", rate, damping, found, theory);
      EXPECT_GT(found, 0.9 * theory);
      if (damping == 0) {
        EXPECT_LT(found, 1.15 * theory);  // else nothing was measured
      }
    }
}

// A device of another scale says with damping_n_s_per_mm() how stiff a wall may be: 2 b / T, as its hand finds it.
TEST(HapticsLimits, AScaledDeviceSaysWhichWallItBears) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  constexpr double rate_hz = 1000;
  for (const double scale : {0.4, 2.5})
    for (const bool screen : {false, true}) {
      double said = 0;
      const Between between{scale, [&](std::unique_ptr<device::Device> hand) -> std::unique_ptr<device::Device> {
                              std::unique_ptr<device::Device> whole;
                              if (screen) {
                                device::ScreenRegistration r;
                                r.height_mm = 100;
                                r.turn.column[0] = {1, 0, 0};
                                r.turn.column[1] = {0, 1, 0};
                                r.turn.column[2] = {0, 0, 1};
                                auto view = std::make_shared<device::Mailbox<device::ScreenView>>();
                                view->write({{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 100 * scale});
                                whole = std::make_unique<device::ScreenDevice>(std::move(hand), r, view);
                                device::DeviceReading begin;
                                whole->read(0, begin);
                              } else {
                                device::WorkspaceParams w;
                                w.workspace_scale = scale;
                                whole = device::in_workspace(std::move(hand), w);
                              }
                              said = whole->damping_n_s_per_mm();
                              return whole;
                            }};
      const double found = stiffest(contact, 0, rate_hz, between), theory = 2 * said * rate_hz;
      std::printf("  %s, %.1f mm a mm: stiffest %.2f N/mm, 2 b / T with the damping it says %.2f\n",
                  screen ? "screen" : "workspace", scale, found, theory);
      EXPECT_GT(found, 0.9 * theory);
      EXPECT_LT(found, 1.15 * theory);
    }
}

TEST(HapticsLimits, AWallGivesNoEnergy) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  std::mt19937_64 rng(21);
  for (const double rate : {1000.0, 4000.0}) {
    const double stiffness = 0.8 * 2 * device_damping * rate;
    const Energy e = strokes(contact, stiffness, face(1), rate, 300, rng);
    std::printf(
        "  %.0f Hz, %.1f N/mm: least energy %.2g J; without the device's damping up to %.3g J generated, K T v depth "
        "%.3g J\n",
        rate, stiffness, e.min_j, e.generated_j, e.theory_j);
    EXPECT_GE(e.min_j, -1e-6);
    EXPECT_GT(e.generated_j, 1e-5) << "the strokes were too soft to show anything";
    EXPECT_LT(e.generated_j, 3 * e.theory_j);
    EXPECT_GE(strokes(contact, stiffness, face(1, 0.3, 0.2), rate, 300, rng).min_j, -1e-6) << "with friction";
  }
}

// Beyond what theory allows the same strokes must show it, else they show nothing below it either.
TEST(HapticsLimits, ATooStiffWallIsFoundOut) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  std::mt19937_64 rng(23);
  const Energy e = strokes(contact, 2 * 2 * device_damping * 1000, face(1), 1000, 300, rng);
  std::printf("  twice the limit: least energy %.3g J\n", e.min_j);
  EXPECT_LT(e.min_j, -1e-4);
}

// Dampers see a velocity behind a low pass, which theory knows nothing of: the materials that are shipped
// (configs/materials.yaml), and as stiff and damped as theory allows.
TEST(HapticsLimits, DampedWallsWithFrictionGiveNoEnergy) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  std::mt19937_64 rng(24);
  for (const cases::CaseFace& wall :
       {face(1, 0.35, 0.30, 0, 0.0003), face(0.30, 0.35, 0.30, 0, 0.0003), face(0.08, 0.30, 0.25, 0, 0.0002),
        face(0.12, 0.20, 0.15, 0, 0.0002), face(0.8 * 2 * (device_damping - 0.0005) * 1000, 0.35, 0.30, 0, 0.0005)}) {
    const Energy e = strokes(contact, wall.stiffness_n_per_mm, wall, 1000, 300, rng);
    std::printf("  %.2f N/mm, %.4f N s/mm: least energy %.3g J\n", wall.stiffness_n_per_mm, wall.damping_n_s_per_mm,
                e.min_j);
    EXPECT_GE(e.min_j, -1e-6) << wall.stiffness_n_per_mm;
  }
}

TEST(LongHapticsLimits, AWallGivesNoEnergyInAMillionStrokes) {
  WallScene s;
  const contact::ContactVolume contact(s.volume);
  std::mt19937_64 rng(22);
  const Energy e = strokes(contact, 0.8 * 2 * device_damping * 1000, face(1), 1000, 1000000, rng);
  std::printf("  %d strokes: least energy %.3g J\n", e.strokes, e.min_j);
  EXPECT_GE(e.min_j, -1e-6);
}
