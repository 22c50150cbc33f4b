// SPDX-License-Identifier: GPL-3.0-or-later
// Rods that are exactly round: where they touch, both ways against the truth, what they press, how they lean in a hole,
// and that they go through nothing.
#include <gtest/gtest.h>

#include "haptics/round_body.h"
#include "haptics_tools.h"

using namespace trephine;
using namespace trephine::tools;
using walls::uniform;
using walls::unit_vector;

namespace {

// What a middle line's points are to a solid: the truth that the discs are compared with.
struct Truth {
  const char* name;
  std::function<double(Vec3)> distance;  // of a point, positive outside; convex outside, unless `bowl`
  bool bowl;
  double early_mm, late_mm;  // how far it may touch before the truth does, and after

  // Between the solid and the line's nearest place.
  double gap(Vec3 a, Vec3 b) const {
    if (bowl) return std::min(distance(a), distance(b));
    double lo = 0, hi = 1;
    for (int n = 0; n < 80; ++n) {
      const double p = lo + (hi - lo) / 3, q = hi - (hi - lo) / 3;
      distance(a + (b - a) * p) < distance(a + (b - a) * q) ? hi = q : lo = p;
    }
    return distance(a + (b - a) * lo);
  }
};

// Solids in one orientation: a half-space, a ball, what a ball leaves, and a quarter of space with its sharp edge.
std::vector<Truth> truths(Vec3 u, Vec3 w) {
  return {{"plane", [=](Vec3 p) { return dot(p, u); }, false, 0.02, 0.02},
          {"ball", [=](Vec3 p) { return norm(p) - 7; }, false, 0.05, 0.05},
          {"bowl", [=](Vec3 p) { return 10 - norm(p); }, true, 0.05, 0.05},
          {"edge",
           [=](Vec3 p) {
             const double x = dot(p, u), y = dot(p, w);
             return x > 0 && y > 0 ? std::hypot(x, y) : std::max(x, y);
           },
           false, 0.25, 0.25}};
}

std::vector<haptics::RoundPart> rod_of(double length, double radius) { return {{radius, radius + length, radius}}; }

// A place of a line of that length at which the truth's gap is about `gap`, or nothing where chance gave none.
bool place_at(const Truth& truth, std::mt19937_64& rng, double length, double gap, Vec3& centre, Vec3& axis) {
  axis = unit_vector(rng);
  centre = unit_vector(rng) * uniform(rng, 0, 11);
  for (int n = 0; n < 40; ++n) {
    const double is = truth.gap(centre, centre + axis * length);
    if (std::abs(is - gap) < 1e-6) break;
    // Along the gradient of the gap.
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      Vec3 to = centre;
      to[a] += 1e-4;
      g[a] = (truth.gap(to, to + axis * length) - is) / 1e-4;
    }
    if (dot(g, g) < 0.1) return false;
    centre += g * ((gap - is) / dot(g, g));
  }
  const Vec3 end = centre + axis * length;
  for (int a = 0; a < 3; ++a)
    if (std::abs(centre[a]) > 13.5 || std::abs(end[a]) > 13.5) return false;
  return std::abs(truth.gap(centre, end) - gap) < 1e-3;
}

}  // namespace

// Rods and balls of any size at places whose distance from a solid is known: where they touch, and how deep, both ways.
// A disc beside a sharp edge stands out over it, and what half occupancy leaves of the edge is round: half a voxel.
TEST(HapticsRod, TouchesWhereTheTruthDoes) {
  std::mt19937_64 rng(21);
  for (std::size_t which = 0; which < 4; ++which) {
    double early = 0, late = 0, off = 0;
    std::vector<double> depths;
    int hits = 0, clear = 0;
    std::string name;
    double limits[2] = {0, 0};
    for (int scene = 0; scene < 6; ++scene) {
      const Vec3 u = unit_vector(rng), w = normalized(cross(u, unit_vector(rng)));
      const Truth truth = truths(u, w)[which];
      name = truth.name;
      limits[0] = truth.early_mm;
      limits[1] = truth.late_mm;
      voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
      fill_wide(v, 1, [&](Vec3 p) { return -truth.distance(p); });
      const contact::ContactVolume contact(v);
      for (int n = 0; n < 120; ++n) {
        const double length = n % 4 == 0 ? 0 : uniform(rng, 0.5, truth.bowl ? 6 : 14), radius = uniform(rng, 0.6, 2.5);
        haptics::RoundBody body(contact, rod_of(length, radius));
        Vec3 centre, axis;
        const double gap = radius + uniform(rng, -0.4, 0.4);
        if (!place_at(truth, rng, length, gap, centre, axis)) continue;
        body.begin_frame();
        const haptics::RoundBody::Touch t = body.deepest(centre, axis, 0, {});
        const double depth = radius - gap;  // the truth
        if (depth > 0 && !t.hit) late = std::max(late, depth);
        if (t.hit) {
          early = std::max(early, t.depth_mm - depth);
          late = std::max(late, depth - t.depth_mm);
          depths.push_back(std::abs(t.depth_mm - depth));
          const Vec3 middle = centre + axis * t.along_mm;
          off = std::max(off, std::abs(norm(middle - t.contact.point_mm) - (radius - t.depth_mm)));
          EXPECT_GE(t.along_mm, -1e-9);
          EXPECT_LE(t.along_mm, length + 1e-9);
        }
        (t.hit ? hits : clear)++;
      }
    }
    ASSERT_GT(hits, 100) << name;
    ASSERT_GT(clear, 100) << name;
    std::sort(depths.begin(), depths.end());
    std::printf(
        "  %s: %d touch, %d do not; depth off by p50 %.4f, p99 %.4f mm; at most %.3f too early, %.3f too late\n",
        name.c_str(), hits, clear, depths[depths.size() / 2], depths[depths.size() * 99 / 100], early, late);
    EXPECT_LT(early, limits[0]) << name;
    EXPECT_LT(late, limits[1]) << name;
    EXPECT_LT(off, 1e-9) << "its parts agree";
  }
}

// A rod that is pressed into a plane, upright, aslant and flat: the spring's force, and its torque about the tip.
TEST(HapticsRod, ARodPressesWithSpringAndTorque) {
  std::mt19937_64 rng(5);
  double worst = 0, twisted = 0;
  for (int n = 0; n < 24; ++n) {
    const Vec3 up = unit_vector(rng), side = normalized(cross(up, unit_vector(rng)));
    voxel::HapticVolume v = empty(64, {0.5, 0.5, 0.5});
    fill_wide(v, 1, [&](Vec3 p) { return -dot(p, up); });
    const contact::ContactVolume contact(v);
    const double angle =
        n == 0 ? 0.5 * M_PI : (n - 12) * 0.12;  // of the axis from the plane's normal; the first is flat
    const Vec3 axis = up * std::cos(angle) + side * std::sin(angle);
    const double radius = 1, length = 8;
    haptics::ForceParams force = plain();
    force.max_torque_n_mm = 1000;
    haptics::Proxy proxy(contact, one_shape(1, face(1), face(1)), force, {},
                         haptics::make_tool(params_of("rod", 2 * radius, length)));
    // The lowest place of the surface is at that height where the tip is at 0.
    const double ends[2] = {radius * std::cos(angle), (length - radius) * std::cos(angle)};
    const double lowest = std::min(ends[0], ends[1]) - radius;
    const auto at = [&](double height) { return pose(up * (height - lowest) - side * (4 * std::sin(angle)), axis); };
    for (double h = 3; h > -1; h -= 0.02) proxy.update(at(h));
    const haptics::HapticState& is = proxy.update(at(-1));
    EXPECT_EQ(is.touched, 1);
    worst = std::max(worst, norm(is.force_n - up));
    const double along = n == 0 ? 0.5 * length : ends[0] <= ends[1] ? radius : length - radius;
    const Vec3 truth = cross(axis * along - up * radius, up);
    // Near to flat the place where it presses is anywhere along the rod.
    if (n == 0 || std::abs(std::cos(angle)) > 0.2) twisted = std::max(twisted, norm(is.torque_n_mm - truth));
  }
  std::printf("  force off by at most %.3f of 1 N, torque by %.3f N mm\n", worst, twisted);
  EXPECT_LT(worst, 0.08);
  EXPECT_LT(twisted, 0.8);
}

// In a hole of 4 mm through a thick plate, pulled aside and turned: the rod leans on both walls, is not in them, and
// comes out.
TEST(HapticsRod, ARodInAHole) {
  voxel::HapticVolume v = empty(72, {0.4, 0.4, 0.4});
  const auto level = [](Vec3 p) { return std::min({std::hypot(p.x, p.y) - 2, 5 - p.z, p.z + 5}); };
  fill_wide(v, 1, level);
  const contact::ContactVolume contact(v);
  haptics::ForceParams force = plain();
  force.max_force_n = 3.3;
  force.max_force_rate_n_per_s = 1000;
  haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), force, {},
                       haptics::make_tool(params_of("rod", 2.5, 30)));
  double deepest = 0, turned_rad = 0, most = 0;
  Vec3 last;
  const auto go = [&](Vec3 tip, Vec3 axis) {
    const haptics::HapticState& s = proxy.update(pose(tip, axis));
    for (double t = 1.25; t <= 28.75; t += 0.25)
      deepest = std::max(deepest, std::min(1.25, level(s.proxy_mm + s.axis * t) + 1.25));
    turned_rad = std::max(turned_rad, std::acos(std::clamp(s.axis.z, -1.0, 1.0)));
    most = std::max(most, norm(s.force_n));
    ASSERT_LE(norm(s.force_n - last), 1 + 1e-9);
    ASSERT_LE(norm(s.torque_n_mm), force.max_torque_n_mm + 1e-9);
    last = s.force_n;
  };
  const Vec3 z{0, 0, 1};
  for (double h = 10; h > -7; h -= 0.02) go({0, 0, h}, z);
  EXPECT_NEAR(proxy.state().proxy_mm.z, -7, 0.05) << "it is through";
  for (double a = 0; a < 0.9; a += 0.001) go({3 * a, 0, -7}, z + Vec3{std::tan(a), 0, 0});
  const double leant = std::acos(proxy.state().axis.z);
  const double torque = norm(proxy.state().torque_n_mm);
  for (double a = 0.9; a > 0; a -= 0.001) go({3 * a, 0, -7}, z + Vec3{std::tan(a), 0, 0});
  for (double h = -7; h < 12; h += 0.02) go({0, 0, h}, z);
  std::printf("  leant by %.2f rad of 0.9, %.0f N mm; at most %.3f mm in the wall, %.2f N\n", leant, torque, deepest,
              most);
  EXPECT_LT(leant, 0.3) << "the walls hold it";
  EXPECT_GT(leant, 0.05);
  EXPECT_GT(torque, 50);
  EXPECT_LT(deepest, 0.2) << "half a voxel, at the sharp edges of its mouths";
  EXPECT_EQ(proxy.state().touched, 0);
  EXPECT_LT(norm(proxy.state().proxy_mm - Vec3{0, 0, 12}), 0.05) << "free";
}

// Random strokes and turns of any speed against bumpy walls: no middle line enters bone, and no part is in it by more
// than its discs are rough.
TEST(HapticsRod, RodsGoThroughNothing) {
  const auto level = [](Vec3 p) { return 10 + std::sin(p.x) + std::cos(1.3 * p.y) - norm(p); };
  voxel::HapticVolume v = empty(72, {0.5, 0.5, 0.5});
  fill_wide(v, 1, level);
  const contact::ContactVolume contact(v);
  for (const char* kind : {"rod", "round_burr"}) {
    const haptics::Tool tool = haptics::make_tool(params_of(kind, kind[1] == 'o' && kind[2] == 'd' ? 2 : 4, 12));
    haptics::Proxy proxy(contact, one_shape(1, face(1, 0.3, 0.2), face(1, 0.3, 0.2)), plain(), {}, tool);
    std::mt19937_64 rng(12);
    Vec3 x{16, 9, 9}, to = x, axis{0, 0, 1}, aim = axis;
    proxy.update(pose(x, axis));
    double deepest = 0;
    int touching = 0, inside = 0;
    for (int n = 0; n < 12000; ++n) {
      if (n % 50 == 0) to = {uniform(rng, -15, 15), uniform(rng, -15, 15), uniform(rng, -15, 15)};
      if (n % 80 == 0) aim = unit_vector(rng);
      const double speed = std::pow(10.0, uniform(rng, -3, 1.5));
      const Vec3 d = to - x;
      x = norm(d) > speed ? x + d * (speed / norm(d)) : to;
      axis = normalized(axis + (aim - axis) * std::pow(10.0, uniform(rng, -3, 0)) + Vec3{1e-9, 0, 0});
      const haptics::HapticState& s = proxy.update(pose(x, axis));
      for (const haptics::RoundPart& p : tool.round)
        for (int m = 0; m <= 12; ++m) {
          const Vec3 middle = s.proxy_mm + s.axis * (p.from_mm + (p.to_mm - p.from_mm) * m / 12);
          inside += contact.shape_at(middle) != 0;
          deepest = std::max(deepest, std::min(1.0, level(middle + unit_vector(rng) * p.radius_mm) / 1.7));
        }
      touching += s.touched != 0;
    }
    std::printf("  %s: in contact %.0f %%, at most %.3f mm in\n", kind, touching / 120.0, deepest);
    EXPECT_GT(touching, 2000);
    EXPECT_EQ(inside, 0) << "its middle";
    EXPECT_LT(deepest, 0.15);
  }
}
