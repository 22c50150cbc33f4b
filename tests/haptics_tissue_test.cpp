// SPDX-License-Identifier: GPL-3.0-or-later
// Tissue that relaxes, tips that cut, and shafts that bend, beside the laws that they follow.
#include <gtest/gtest.h>

#include <cstring>

#include "haptics_half_space.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;

namespace {

constexpr double stiffness = 0.5;

// Tissue below z = 0.
struct Tissue {
  voxel::HapticVolume volume = half_space({0, 0, 1});
  contact::ContactVolume contact{volume};
  haptics::Feels feels = one_shape(1, face(stiffness), face(stiffness));
  haptics::Proxy proxy(const haptics::ShaftParams& shaft = {}, std::uint64_t locks = 0) const {
    return haptics::Proxy(touch::FeltSpace(contact, {nullptr, nullptr, locks}), feels, plain(), shaft);
  }
};

double depth_of(const haptics::Proxy& proxy, Vec3 hand) { return norm(proxy.state().proxy_mm - hand); }

}  // namespace

// A deformation that is held, on any clock: K x (r + (1 - r) exp(-t / T)), where the step was made within the first
// tick.
TEST(HapticsTissue, AStepThatIsHeldRelaxesAsTheSolidDoes) {
  for (const auto& [rest, time_s] : {std::pair{0.55, 0.5}, {0.1, 0.05}, {0.9, 5.0}, {0.01, 0.02}})
    for (const double hz : {500.0, 1000.0, 2000.0}) {
      Tissue tissue;
      tissue.feels[1].rest_ratio = rest;
      tissue.feels[1].relaxation_s = time_s;
      haptics::Proxy proxy = tissue.proxy();
      const double dt = 1 / hz;
      proxy.update(at({0, 0, 2}, dt));
      for (int n = 0; n * dt < 6 * time_s; ++n) {
        const double is = proxy.update(at({0, 0, -3}, dt)).force_n.z, whole = stiffness * depth_of(proxy, {0, 0, -3});
        ASSERT_NEAR(is, whole * (rest + (1 - rest) * std::exp(-(n + 0.5) * dt / time_s)), 2e-3 * whole)
            << rest << " " << time_s << " " << hz << " " << n;
      }
    }
}

// Pressed with a steady speed: K v (r t + (1 - r) T (1 - exp(-t / T))).
TEST(HapticsTissue, ASteadyPressIsThatOfTheSolid) {
  for (const double hz : {500.0, 1000.0, 2000.0})
    for (const double speed : {1.0, 10.0}) {
      Tissue tissue;
      const double rest = tissue.feels[1].rest_ratio = 0.4, time_s = tissue.feels[1].relaxation_s = 0.3, dt = 1 / hz;
      haptics::Proxy proxy = tissue.proxy();
      proxy.update(at({0, 0, 0.5}, dt));
      double begun = -1;
      for (int n = 0; n * dt * speed < 6; ++n) {
        const Vec3 hand{0, 0, 0.1 - n * dt * speed};
        const double is = proxy.update(at(hand, dt)).force_n.z;
        const double depth = proxy.state().touched ? depth_of(proxy, hand) : 0;
        if (depth > 0 && begun < 0) begun = n * dt - depth / speed;
        if (depth < 0.2) continue;
        const double t = n * dt - begun;
        const double wanted = stiffness * speed * (rest * t + (1 - rest) * time_s * (1 - std::exp(-t / time_s)));
        ASSERT_NEAR(is, wanted, 0.01 * wanted + 1e-3) << hz << " " << speed << " " << t;
      }
    }
}

// Whatever the ticks, the laws and the path: what is given back is never more than was taken, the force never pulls,
// and it never exceeds that of the spring that does not relax. Where a tissue is left behind, the force ends within a
// step, which its mean does not know: by at most the square of a step.
TEST(HapticsTissue, GivesNoEnergyOutAtAnyConstants) {
  std::mt19937_64 rng(3);
  for (int way = 0; way < 4000; ++way) {
    const tissue::SolidLaw law{way % 5 == 0 ? 0.01 : uniform(rng, 0.01, 0.999), std::pow(10.0, uniform(rng, -6, 2))};
    const double dt = std::pow(10.0, uniform(rng, -3.6, 0)), quick = std::pow(10.0, uniform(rng, -3, 0.5));
    tissue::Relaxation spring;
    double whole = 0, felt = 0, taken = 0, most = 0, ends = 0;
    const auto step = [&](double next) {
      const double is = next * spring.share(law, next, dt);
      spring.pass(law, next, dt);
      ASSERT_GE(is, -1e-12);
      ASSERT_LE(is, next + 1e-12);
      taken += 0.5 * (felt + is) * (next - whole);
      if (felt > 0 && !(is > 1e-12)) ends += (next - whole) * (next - whole);
      most = std::max(most, next);
      whole = next;
      felt = is;
      ASSERT_GE(taken, -1e-9 * most * most - ends) << law.rest_ratio << " " << law.time_s << " " << dt;
    };
    const auto go = [&](double next) {
      const double from = whole;
      for (int n = 1; n <= 40; ++n) step(from + (next - from) * n / 40);
    };
    for (int n = 0; n < 200; ++n) go(std::max(0.0, n % 7 < 3 ? whole : whole + uniform(rng, -quick, quick)));
    go(0);
    ASSERT_LT(ends, 0.3 * most * most);
  }
}

// The same of the whole hand, pressing and sliding with friction on closed paths: per tick the mean of both
// forces acts, so that what the clock itself gives is left out.
TEST(HapticsTissue, NoClosedWayOfAHandGainsByRelaxation) {
  std::mt19937_64 rng(8);
  double worst_mj = 0;
  for (int way = 0; way < 60; ++way) {
    Tissue tissue;
    tissue.feels[1].front = face(stiffness, 0.4, 0.3);
    tissue.feels[1].rest_ratio = uniform(rng, 0.05, 0.9);
    tissue.feels[1].relaxation_s = std::pow(10.0, uniform(rng, -2, 0.5));
    haptics::Proxy proxy = tissue.proxy();
    Vec3 hand{0, 0, 1}, force = proxy.update(at(hand)).force_n;
    double given_mj = 0;
    const auto go = [&](Vec3 to, int ticks) {
      const Vec3 from = hand;
      for (int n = 1; n <= ticks; ++n) {
        const Vec3 next = from + (to - from) * (double(n) / ticks);
        const Vec3 is = proxy.update(at(next)).force_n;
        given_mj += dot((force + is) * 0.5, next - hand);
        hand = next;
        force = is;
      }
    };
    for (int n = 0; n < 8; ++n)
      go({uniform(rng, -4, 4), uniform(rng, -4, 4), uniform(rng, -5, 0.5)}, int(std::pow(10.0, uniform(rng, 1, 3))));
    go({hand.x, hand.y, 1}, 300);
    go({0, 0, 1}, 100);
    worst_mj = std::max(worst_mj, given_mj);
  }
  EXPECT_LT(worst_mj, 0.01);
}

// A membrane gives way at the force that is felt: at once by a quick hand, farther in by a slow one.
TEST(HapticsTissue, AMembraneGivesWayAtTheForceThatIsFelt) {
  const auto depth_at = [](double speed) {
    Tissue tissue;
    tissue.feels[1].front = face(stiffness, 0, 0, 1);
    tissue.feels[1].rest_ratio = 0.5;
    tissue.feels[1].relaxation_s = 0.1;
    haptics::Proxy proxy = tissue.proxy();
    double depth = 0;
    for (double z = 1; z > -8; z -= speed * 0.001) {
      const haptics::HapticState& is = proxy.update(at({0, 0, z}));
      if (is.events & haptics::haptic_event::popped) return depth;
      depth = -z;
    }
    return -1.0;
  };
  EXPECT_NEAR(depth_at(400), 1 / stiffness, 0.45);
  // Long after T: K v (r t + (1 - r) T) = 1 N.
  for (const double speed : {0.5, 5.0})
    EXPECT_NEAR(depth_at(speed), (1 / stiffness - 0.5 * 0.1 * speed) / 0.5, 0.02) << speed;
}

TEST(HapticsTissue, BeginsAnewAfterAResetAndRepeatsItsBits) {
  Tissue tissue;
  tissue.feels[1].rest_ratio = 0.3;
  tissue.feels[1].relaxation_s = 0.2;
  tissue.feels[1].tip_force_n = 0.3;
  haptics::Proxy proxy = tissue.proxy(), other = tissue.proxy();
  const auto run = [](haptics::Proxy& p) {
    std::mt19937_64 rng(2);
    std::vector<double> all;
    for (int n = 0; n < 500; ++n) {
      const Vec3 f = p.update(at({uniform(rng, -0.1, 0.1), 0, 1.5 - 0.01 * n + uniform(rng, 0, 0.1)})).force_n;
      all.insert(all.end(), {f.x, f.y, f.z});
    }
    return all;
  };
  const std::vector<double> first = run(proxy);
  proxy.reset();
  EXPECT_EQ(run(proxy), first);
  EXPECT_EQ(run(other), first);
}

// What a tip cuts is the same at any depth and speed, and nothing on the way out; a shaft is held the more of it is
// inside, in both directions.
TEST(HapticsTissue, TheTipCutsAndTheShaftIsHeld) {
  for (const double hz : {500.0, 1000.0, 2000.0})
    for (const double speed : {1.0, 20.0}) {
      Tissue tissue;
      tissue.feels[1].front = face(stiffness, 0, 0, 0.05);
      tissue.feels[1].back.touchable = false;
      tissue.feels[1].tip_force_n = 0.4;
      tissue.feels[1].shaft_friction_n_per_mm = 0.02;
      haptics::ShaftParams shaft;
      shaft.shaft_length_mm = 60;
      haptics::Proxy proxy = tissue.proxy(shaft);
      const double step = speed / hz;
      double z = 1;
      const auto to = [&](double end) {
        haptics::HapticState is;
        while (std::abs(z - end) > 1.5 * step) is = proxy.update(at({0, 0, z += z < end ? step : -step}, 1 / hz));
        return is.force_n.z;
      };
      const double in_5 = to(-5), in_10 = to(-10), out_7 = to(-7), out_4 = to(-4);
      EXPECT_NEAR(in_10 - in_5, 0.02 * 5, 0.03) << hz << " " << speed;
      EXPECT_NEAR(in_5, 0.4 + 0.02 * 5, 0.03);
      EXPECT_NEAR(out_7, -0.02 * 7, 0.03) << "no tip on the way out";
      EXPECT_NEAR(out_4, -0.02 * 4, 0.03);
    }
}

// The hand beside the line: K = 1 / (1 / wall + L^3 / (3 E I)) at each depth, and no closed path gives anything out.
TEST(HapticsTissue, AShaftBendsAsABeam) {
  const double rigidity = 2300, length = 60;  // a needle of 22 G in steel
  haptics::ShaftParams shaft;
  shaft.shaft_length_mm = length;
  shaft.shaft_rigidity_n_mm2 = rigidity;
  for (const double hz : {500.0, 1000.0, 2000.0}) {
    Tissue tissue;
    tissue.feels[1].front = face(stiffness, 0, 0, 0.05);
    tissue.feels[1].back.touchable = false;
    haptics::Proxy proxy = tissue.proxy(shaft, 1u << 1);
    Vec3 hand{0, 0, 1}, force;
    double given_mj = 0;
    const auto go = [&](Vec3 to) {
      const double way = norm(to - hand);
      const int ticks = std::max(1, int(way * hz / 10));
      const Vec3 from = hand;
      for (int n = 1; n <= ticks; ++n) {
        const Vec3 next = from + (to - from) * (double(n) / ticks);
        haptics::HapticInput in = at(next, 1 / hz);
        in.axis = {0, 0, 1};
        const Vec3 is = proxy.update(in).force_n;
        given_mj += dot((force + is) * 0.5, next - hand);
        hand = next;
        force = is;
      }
    };
    go({0, 0, -2});
    given_mj = 0;
    double entered = 0;
    for (const double depth : {2.0, 5.0, 10.0}) {
      go({0, 0, -depth});
      go({6, 0, -depth});
      const double free_mm = length - depth;
      const double wanted = 6 / (1 / stiffness + free_mm * free_mm * free_mm / (3 * rigidity));
      EXPECT_NEAR(-force.x, wanted, 0.02 * wanted) << depth;
      EXPECT_GT(force.z, 0) << "and it is pushed out";
      entered = depth;
    }
    ASSERT_EQ(entered, 10);
    go({6, 0, -2});
    go({0, 0, -2});
    EXPECT_NEAR(given_mj, 0, 1e-3) << hz;
    // A rigid shaft has the wall's own spring.
    haptics::ShaftParams rigid = shaft;
    rigid.shaft_rigidity_n_mm2 = 0;
    const haptics::Proxy none = tissue.proxy(rigid, 1u << 1);
    EXPECT_EQ((tissue::BentShaft{0, length}.at(stiffness, 3).across_n_per_mm), stiffness);
    EXPECT_LT((tissue::BentShaft{rigidity, length}.at(stiffness, 3).across_n_per_mm), stiffness / 10);
  }
}
