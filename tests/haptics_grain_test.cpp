// SPDX-License-Identifier: GPL-3.0-or-later
// Friction that depends on the direction: on planes against the ellipse that it should be.
#include <gtest/gtest.h>

#include "haptics/recording.h"
#include "haptics_half_space.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;
using walls::unit_vector;

namespace {

haptics::Feels grainy(Vec3 grain, double across, double at_rest, double sliding) {
  haptics::Feels feels = one_shape(1, face(1, at_rest, sliding), face(1));
  feels[1].front.across_grain_ratio = across;
  feels[1].grain_direction = grain;
  return feels;
}

struct Felt {
  double along = 0, beside = 0;  // of the normal force: against the motion, and across it
};

// The means on the last 10 mm of a straight way: until then a way that the surface turns aside has settled.
Felt felt_on(const contact::ContactVolume& contact, const haptics::Feels& feels, Vec3 normal, Vec3 way,
             const haptics::Tool& tool) {
  haptics::Proxy proxy(contact, feels, plain(), {}, tool);
  const Vec3 beside = cross(normal, way);
  Felt sum;
  int count = 0;
  for (double s = -9; s < 7; s += 0.02) {
    const haptics::HapticState& is = proxy.update(pose(way * s - normal * (s == -9 ? -3 : 1), normal));
    if (s < -3) continue;
    const double pressed = dot(is.force_n, normal);
    sum.along -= dot(is.force_n, way) / pressed;
    sum.beside -= dot(is.force_n, beside) / pressed;
    ++count;
  }
  return {sum.along / count, sum.beside / count};
}

// What the sliding rule says: of all friction f in the ellipse the one that takes most energy from a motion along w, f
// = N w / sqrt(w N w), where N is the ellipse's matrix in the surface, here as the inverse of how lengths count in it.
Felt truth(Vec3 normal, Vec3 way, Vec3 grain, double across, double sliding) {
  const Vec3 g = normalized(grain), beside = cross(normal, way);
  const auto product = [&](Vec3 a, Vec3 b) {
    return (dot(a, b) - dot(a, g) * dot(b, g)) / (across * across) + dot(a, g) * dot(b, g);
  };
  const double a = product(way, way), b = product(way, beside), c = product(beside, beside), d = a * c - b * b;
  const double f_along = c / d, f_beside = -b / d;  // N w
  const double size = sliding / std::sqrt(f_along);
  return {f_along * size, f_beside * size};
}

}  // namespace

// At seven angles between motion and grain, smoother and rougher across, on three planes; on one of them the grain
// leaves the surface.
TEST(HapticsGrain, ForcesAreThoseOfTheEllipse) {
  const double sliding = 0.3;
  const std::pair<Vec3, Vec3> planes[] = {{{0, 0, 1}, {1, 0, 0}},
                                          {normalized({1, 2, 2}), normalized({2, 1, -2})},
                                          {normalized({0, 1, 2}), normalized({1, 0.4, 0.8})}};
  for (const auto& [name, params] : held_tools()) {
    double worst = 0, most_beside = 0;
    for (const auto& [normal, grain] : planes) {
      voxel::HapticVolume volume = half_space(normal);
      const contact::ContactVolume contact(volume);
      const Vec3 u = normalized(grain - normal * dot(grain, normal)), v = cross(normal, u);
      for (const double across : {0.4, 2.5})
        for (int deg = 0; deg <= 90; deg += 15) {
          const Vec3 way = u * std::cos(deg * M_PI / 180) + v * std::sin(deg * M_PI / 180);
          const Felt is = felt_on(contact, grainy(grain * 0.7, across, 0.35, sliding), normal, way,
                                  haptics::make_tool(params)),
                     should = truth(normal, way, grain, across, sliding);
          const double off =
              std::hypot(is.along - should.along, is.beside - should.beside) / std::hypot(should.along, should.beside);
          worst = std::max(worst, off);
          most_beside = std::max(most_beside, std::abs(is.beside / is.along));
          EXPECT_LT(off, 0.01) << name << " across " << across << " at " << deg << " degrees";
        }
    }
    std::printf("  %-8s off by at most %.4f; at most %.2f of the friction is aside\n", name, worst, most_beside);
    EXPECT_GT(most_beside, 0.5) << "no angle of which the tool is turned";
  }
}

// How far a tool that rested may be drawn before it slides: the static ratio along the grain, and its share across.
TEST(HapticsGrain, TheOnsetIsThatOfTheDirection) {
  voxel::HapticVolume volume = half_space({0, 0, 1});
  const contact::ContactVolume contact(volume);
  for (const double across : {0.5, 1.0, 2.0})
    for (const Vec3 way : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
      haptics::Proxy proxy(contact, grainy({1, 0, 0}, across, 0.6, 0.3), plain());
      for (double z = 1; z > -1; z -= 0.05) proxy.update(at({0, 0, z}));
      double most = 0;
      for (double s = 0; s < 3; s += 0.002) {
        const haptics::HapticState& is = proxy.update(at(way * s - Vec3{0, 0, 1}));
        most = std::max(most, -dot(is.force_n, way) / is.force_n.z);
      }
      EXPECT_NEAR(most, 0.6 * (way.y > 0 ? across : 1), 0.01) << across;
    }
}

// Without a grain, and with one across which friction is the same, every bit is as it was.
TEST(HapticsGrain, ARatioOfOneChangesNoBit) {
  std::mt19937_64 rng(7);
  for (const auto& [name, params] : held_tools()) {
    const Vec3 normal = unit_vector(rng);
    voxel::HapticVolume volume = half_space(normal);
    const contact::ContactVolume contact(volume);
    haptics::Proxy plain_one(contact, one_shape(1, face(1, 0.35, 0.3), face(1)), plain(), {},
                             haptics::make_tool(params)),
        grain_one(contact, grainy({0, 1, 0}, 1, 0.35, 0.3), plain(), {}, haptics::make_tool(params));
    for (int n = 0; n < 2000; ++n) {
      const Vec3 p = haptics::frame_along(normal) *
                     Vec3{4 * std::sin(0.01 * n), 3 * std::sin(0.017 * n), 0.6 * std::sin(0.023 * n) - 0.4};
      const haptics::HapticState a = plain_one.update(pose(p, normal)), b = grain_one.update(pose(p, normal));
      ASSERT_EQ(a.force_n, b.force_n) << name << " " << n;
      ASSERT_EQ(a.proxy_mm, b.proxy_mm) << name << " " << n;
    }
  }
}

// Within the ellipse friction is a spring, which gives back what was put in; beyond it a closed way takes energy from
// the hand, in whatever direction it goes round.
TEST(HapticsGrain, NoEnergyFromFriction) {
  voxel::HapticVolume volume = half_space({0, 0, 1});
  const contact::ContactVolume contact(volume);
  std::mt19937_64 rng(11);
  for (int run = 0; run < 200; ++run) {
    const double across = std::pow(10, uniform(rng, -1, 1)), turn = uniform(rng, 0, 2 * M_PI);
    const bool sticks = run % 2 == 0;
    const double reach = sticks ? 0.9 * 0.5 * std::min(1.0, across) : uniform(rng, 0.5, 5);
    haptics::Proxy proxy(contact, grainy({std::cos(turn), std::sin(turn), 0}, across, 0.5, 0.4), plain());
    for (double z = 1; z > -1; z -= 0.05) proxy.update(at({0, 0, z}));
    Vec3 last{0, 0, -1}, force = proxy.update(at(last)).force_n;
    double given_mj = 0;  // to the hand
    const double a = uniform(rng, 1, 3), b = uniform(rng, 1, 3), way = uniform(rng, -1, 1);
    for (int n = 1; n <= 4000; ++n) {
      const double t = 2 * M_PI * n / 4000, grows = std::sin(t / 2);
      const Vec3 now{reach * grows * std::sin(std::round(a) * t) / 1.5,
                     reach * grows * std::sin(std::round(b) * t + way) / 1.5, -1};
      const Vec3 next = proxy.update(at(now)).force_n;
      given_mj += dot((force + next) * 0.5, now - last);
      force = next;
      last = now;
    }
    if (sticks)
      EXPECT_NEAR(given_mj, 0, 1e-6) << run;
    else
      EXPECT_LT(given_mj, 1e-6) << run;
  }
}

TEST(HapticsGrain, OnlyWhatIsFeltChangesTheDigest) {
  const haptics::Feels none = one_shape(1, face(1, 0.35, 0.3), face(1));
  haptics::Feels other = none;
  other[1].front.across_grain_ratio = 0.5;
  EXPECT_NE(haptics::feel_digest(other), haptics::feel_digest(none));
  other[1].grain_direction = {1, 0, 0};
  haptics::Feels turned = other;
  turned[1].grain_direction = {0, 1, 0};
  EXPECT_NE(haptics::feel_digest(other), haptics::feel_digest(turned));
}
