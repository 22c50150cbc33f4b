// SPDX-License-Identifier: GPL-3.0-or-later
// Each algorithm of triangles on its paper's own examples: a plane, a sphere, a wedge.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "peers/depth_buffer.h"
#include "peers/feedback_buffer.h"
#include "peers/god_object.h"
#include "peers/round_proxy.h"
#include "peers/tangent_plane.h"
#include "peers_scenes.h"

namespace trephine::peers {
namespace {

// Two planes that meet in the line x = 0: a valley, and turned over a ridge.
double valley(double x, double) { return 0.5 * std::abs(x); }
double steep_valley(double x, double) { return std::abs(x); }
double ridge(double x, double) { return -std::abs(x); }

std::vector<AlgorithmKind> of_meshes() {
  std::vector<AlgorithmKind> all;
  for (AlgorithmKind& k : all_algorithms())
    if (k.feels_mesh) all.push_back(std::move(k));
  return all;
}

// How far off the surface its point is held: the ball's radius.
double stands_off(const AlgorithmKind& kind, const PeerParams& p) {
  return kind.name == "ruspini" ? p.proxy_radius_mm : 0;
}

TEST(Peers, APlanePressesWithTheSpringAndHoldsNothingBackAlongIt) {
  const Vec3 origin{-31.7, 12.3, 8.9};
  const FeltMesh mesh(landscape(flat, 1, origin));
  const PeerParams params = one_newton_a_mm();
  for (const AlgorithmKind& kind : of_meshes()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make({&mesh, nullptr, 1}, params);
    EXPECT_EQ(go(*a, origin + Vec3{0.3, 0.2, 5}, origin + Vec3{0.3, 0.2, 3}).touched, 0);
    EXPECT_EQ(a->update(at(origin + Vec3{0.3, 0.2, 2})).force_n, Vec3{});
    go(*a, origin + Vec3{0.3, 0.2, 2}, origin + Vec3{0.3, 0.2, -1});
    const haptics::HapticState& s = go(*a, origin + Vec3{0.3, 0.2, -1}, origin + Vec3{5.7, 3.1, -1});
    const double depth = 1 + stands_off(kind, params);
    EXPECT_EQ(s.touched, 1);
    EXPECT_NEAR(s.force_n.z, depth, 1e-3);
    EXPECT_NEAR(s.force_n.x, 0, 1e-3);
    EXPECT_NEAR(s.force_n.y, 0, 1e-3);
    EXPECT_NEAR(s.proxy_mm.x, origin.x + 5.7, 1e-3);
    EXPECT_NEAR(s.proxy_mm.y, origin.y + 3.1, 1e-3);
    EXPECT_NEAR(s.proxy_mm.z, origin.z + stands_off(kind, params), 1e-3);
    // It lets go where the device leaves.
    EXPECT_EQ(go(*a, origin + Vec3{5.7, 3.1, -1}, origin + Vec3{5.7, 3.1, 2}).force_n, Vec3{});
  }
}

TEST(Peers, ASphereHoldsTheProxyWhereItIsNearestToTheDevice) {
  const double radius = 15;
  const FeltMesh mesh(
      landscape([=](double x, double y) { return std::sqrt(std::max(0.0, radius * radius - x * x - y * y)); }, 0.25));
  PeerParams params = one_newton_a_mm();
  params.feedback_side_mm = 8;  // captured in each tick
  for (const AlgorithmKind& kind : of_meshes()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make({&mesh, nullptr, 1}, params);
    // Not down onto a corner of the mesh: what is captured in single precision may be passed there between all facets.
    go(*a, {0.03, 0.01, radius + 3}, {0.03, 0.01, radius - 1});
    // Around a third of a turn, 1 mm deep.
    const haptics::HapticState* s = nullptr;
    Vec3 device;
    for (double angle = 0; angle < 0.6; angle += 0.002) {
      device = Vec3{std::sin(angle) * 0.8, std::sin(angle) * 0.6, std::cos(angle)} * (radius - 1);
      a->client(device);
      s = &a->update(at(device));
    }
    const Vec3 expected = normalized(device) * (radius + stands_off(kind, params));
    EXPECT_NEAR(norm(s->proxy_mm - expected), 0, 0.05);
    EXPECT_NEAR(norm(s->force_n), 1 + stands_off(kind, params), 0.03);
    EXPECT_GT(dot(normalized(s->force_n), normalized(device)), 0.998);
  }
}

TEST(Peers, AValleyHoldsTheProxyInItsLine) {
  const FeltMesh mesh(landscape(valley));
  const PeerParams params = one_newton_a_mm();
  for (const AlgorithmKind& kind : of_meshes()) {
    if (kind.name == "tangent_planes") continue;  // it feels one plane at a time: see below
    SCOPED_TRACE(kind.name);
    const auto a = kind.make({&mesh, nullptr, 1}, params);
    go(*a, {3, 0.2, 8}, {3, 0.2, 1});
    const haptics::HapticState& s = go(*a, {3, 0.2, 1}, {0.1, 0.2, -2}, 400);
    const double height = std::sqrt(1.25) * stands_off(kind, params);
    EXPECT_NEAR(s.proxy_mm.x, 0, kind.name == "depth_buffer" ? 0.1 : 1e-3);  // a pixel of its picture is 0.08 mm
    EXPECT_NEAR(s.proxy_mm.z, height, kind.name == "depth_buffer" ? 0.1 : 1e-3);
    EXPECT_NEAR(s.force_n.z, 2 + height, 0.1);
  }
}

TEST(Peers, ARidgeIsSlidOver) {
  const FeltMesh mesh(landscape(ridge));
  const PeerParams params = one_newton_a_mm();
  for (const AlgorithmKind& kind : of_meshes()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make({&mesh, nullptr, 1}, params);
    go(*a, {-3, 0.2, 4}, {-3, 0.2, -4});
    // The place on its side that is nearest to the device is still before the edge.
    const haptics::HapticState held = go(*a, {-3, 0.2, -4}, {3, 0.2, -4}, 300);
    EXPECT_EQ(held.touched, 1);
    EXPECT_NEAR(held.force_n.x, -(3.5 + stands_off(kind, params) * std::sqrt(0.5)), 0.1);
    EXPECT_NEAR(held.force_n.z, -held.force_n.x, 0.1);
    EXPECT_EQ(go(*a, {3, 0.2, -4}, {8, 0.2, -4}, 300).touched, 0) << "out on the other side";
  }
}

TEST(Peers, GodObjectIsHeldByThreeFacetsInACorner) {
  // Three planes that meet in the origin, as the sides of a cube seen from inside.
  surface::TriMesh m;
  m.points_mm = std::vector<Vec3>{{0, 0, 0}, {20, 0, 0}, {0, 20, 0}, {0, 0, 20}};
  m.triangles = std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
  const FeltMesh mesh(std::move(m));
  GodObject a({&mesh, nullptr, 1}, one_newton_a_mm());
  go(a, {3, 4, 5}, {1, 1, 1});
  const haptics::HapticState& s = go(a, {1, 1, 1}, {-1, -0.5, -2});
  EXPECT_NEAR(norm(s.proxy_mm), 0, 1e-5);
  EXPECT_NEAR(norm(s.force_n - Vec3{1, 0.5, 2}), 0, 1e-5);
}

TEST(Peers, TheBallTouchesFacetsSidesAndCornersWhenItShould) {
  const Vec3 a{0, 0, 0}, b{4, 0, 0}, c{0, 4, 0}, n{0, 0, 1};
  EXPECT_NEAR(touch_time({1, 1, 5}, {0, 0, -10}, 1, a, b, c, n), 0.4, 1e-12);                          // facet
  EXPECT_NEAR(touch_time({2, -0.6, 5}, {0, 0, -10}, 1, a, b, c, n), (5 - 0.8) / 10, 1e-12);            // side
  EXPECT_NEAR(touch_time({-0.6, 0, 5}, {0, 0, -10}, 1, a, b, c, n), (5 - 0.8) / 10, 1e-12);            // side or corner
  EXPECT_NEAR(touch_time({-3, -3, 0}, {10, 10, 0}, 1, a, b, c, n), (3 - std::sqrt(0.5)) / 10, 1e-12);  // corner
  EXPECT_EQ(touch_time({1, 1, 5}, {0, 0, -3.9}, 1, a, b, c, n), 2);                                    // too short
  EXPECT_EQ(touch_time({1, 1, 1}, {3, 0, 0}, 1, a, b, c, n), 2);                                       // along it
  EXPECT_EQ(touch_time({1, 1, 0.9}, {0, 0, -1}, 1, a, b, c, n), 0);                                    // deeper
  EXPECT_EQ(touch_time({1, 1, 0.9}, {0, 0, 1}, 1, a, b, c, n), 2);                                     // out
}

TEST(Peers, RuspinisBallDoesNotEnterASlotNarrowerThanItself) {
  // A slot of 1.5 mm between two plateaus; the ball has 1 mm of radius.
  const FeltMesh mesh(landscape([](double x, double) { return std::abs(x) < 0.75 ? -10.0 : 0.0; }, 0.25));
  PeerParams params = one_newton_a_mm();
  RoundProxy a({&mesh, nullptr, 1}, params);
  const haptics::HapticState& s = go(a, {0, 0.1, 4}, {0, 0.1, -3});
  EXPECT_NEAR(s.proxy_mm.x, 0, 0.01);
  // It rests on both edges, which lie at |x| = 0.75.
  EXPECT_NEAR(s.proxy_mm.z, std::sqrt(1 - 0.75 * 0.75), 2e-3);
  PeerParams thin = params;
  thin.proxy_radius_mm = 0.3;
  RoundProxy b({&mesh, nullptr, 1}, thin);
  EXPECT_EQ(go(b, {0, 0.1, 4}, {0, 0.1, -3}).touched, 0);
}

TEST(Peers, RuspinisBallKnowsItsLocalSetAlone) {
  const FeltMesh mesh(landscape(flat));
  RoundProxy a({&mesh, nullptr, 1}, one_newton_a_mm());
  a.update(at({0, 0, 20}));
  a.client({0, 0, 20});
  EXPECT_EQ(a.local_triangles(), 0u);
  EXPECT_EQ(a.update(at({0, 0, -1})).touched, 0) << "no picture since: the plane is not known";
  a.reset();
  a.update(at({0, 0, 5}));
  a.client({0, 0, 5});
  EXPECT_GT(a.local_triangles(), 100u);
  EXPECT_EQ(a.update(at({0, 0, -1})).touched, 1);
}

// H3D, whose implementation the dissertation measured, takes the triangles along the way that the proxy would go in the
// next three pictures. Without that a device of 1.5 m/s would pass what it cannot know.
TEST(Peers, RuspinisLocalSetLooksAhead) {
  const FeltMesh mesh(landscape(flat));
  const auto comes_at = [&](double mm_a_tick, double look_ahead_ratio) {
    PeerParams params = one_newton_a_mm();
    params.look_ahead_ratio = look_ahead_ratio;
    RoundProxy a({&mesh, nullptr, 1}, params);
    int touched = 0;
    for (int n = 0; n <= 100; ++n) {
      const Vec3 p{0.2, 0.3, 67.5 - mm_a_tick * n};  // a picture is made at 16.5 mm, which is beyond the set without it
      if (n % ticks_a_picture == 0) a.client(p);
      touched = a.update(at(p)).touched;
      if (p.z < -5) break;
    }
    return touched;
  };
  EXPECT_EQ(comes_at(1.5, 3), 1);
  EXPECT_EQ(comes_at(1.5, 0), 0) << "the set holds what is within 15 mm of the ball";
}

TEST(Peers, ATriangleIsCutAtTheCube) {
  const auto area = [](const std::vector<Vec3>& p) {
    Vec3 twice;
    for (std::size_t n = 2; n < p.size(); ++n) twice += cross(p[n - 1] - p[0], p[n] - p[0]);
    return norm(twice) / 2;
  };
  // Whole, cut to a square, cut to a corner, beyond it, and about it without a corner in it.
  EXPECT_EQ(clipped_to_cube({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {0, 0, 0}, 2).size(), 3u);
  EXPECT_NEAR(area(clipped_to_cube({{{-9, -9, 0}, {9, -9, 0}, {0, 30, 0}}}, {0, 0, 0}, 2)), 16, 1e-9);
  EXPECT_NEAR(area(clipped_to_cube({{{-10, -10, 1}, {10, -10, 1}, {-10, 10, 1}}}, {0, 0, 0}, 2)), 8, 1e-9);
  EXPECT_TRUE(clipped_to_cube({{{3, 0, 0}, {4, 0, 0}, {3, 1, 0}}}, {0, 0, 0}, 2).empty());
  EXPECT_NEAR(area(clipped_to_cube({{{-90, -90, 0}, {90, -90, 0}, {0, 300, 0}}}, {5, -7, 0.5}, 3)), 36, 1e-9);
}

TEST(Peers, TheFeedbackBufferFeelsWhatTheLastPictureCaptured) {
  const FeltMesh mesh(landscape(flat));
  PeerParams params = one_newton_a_mm();
  params.feedback_side_mm = 8;
  FeedbackBuffer a({&mesh, nullptr, 1}, params);
  a.update(at({0, 0, 9}));
  a.client({0, 0, 9});
  EXPECT_EQ(a.captured(), 0u) << "the box ends above the surface";
  EXPECT_EQ(a.update(at({0, 0, -1})).touched, 0) << "no picture since";
  a.reset();
  a.update(at({0.3, 0.2, 3}));
  a.client({0.3, 0.2, 3});
  EXPECT_GE(a.captured(), 8u * 8 * 2);
  EXPECT_LE(a.captured(), 10u * 10 * 2 * 3);
  EXPECT_EQ(a.lost(), 0u);
  EXPECT_EQ(a.update(at({0.3, 0.2, -1})).touched, 1);
  // Beyond the box there is nothing, until a picture is made there.
  a.update(at({9, 0.2, -1}));  // slides there on the last facet's plane
  EXPECT_EQ(a.update(at({9, 0.2, -1})).touched, 0);
}

// Who says beforehand too small a number of corners loses what comes late in the mesh, and falls through there.
TEST(Peers, TheFeedbackBufferLosesWhatItHasNoRoomFor) {
  const FeltMesh mesh(landscape(flat));
  const auto touched_with = [&](int corners, std::size_t* lost) {
    PeerParams params = one_newton_a_mm();
    params.feedback_vertices = corners;
    FeedbackBuffer a({&mesh, nullptr, 1}, params);
    const int touched = go(a, {10.3, 10.2, 3}, {10.3, 10.2, -1}).touched;
    *lost = a.lost();
    return touched;
  };
  std::size_t lost = 0;
  EXPECT_EQ(touched_with(65536, &lost), 1);
  EXPECT_EQ(lost, 0u);
  EXPECT_EQ(touched_with(300, &lost), 0);
  EXPECT_GT(lost, 1000u);
}

TEST(Peers, TheDepthBufferDoesNotSeeBehindWhatHidesIt) {
  // A step of 4 mm whose wall the camera sees edge on.
  const FeltMesh mesh(landscape([](double x, double) { return x < 0 ? 4.0 : 0.0; }, 0.5));
  DepthBuffer a({&mesh, nullptr, 1}, one_newton_a_mm());
  go(a, {5, 0.1, 4}, {5, 0.1, -1});
  const haptics::HapticState& s = go(a, {5, 0.1, -1}, {-2, 0.1, -1}, 700);
  EXPECT_NEAR(s.proxy_mm.x, -0.25, 0.4) << "the wall stops it, as a landscape that is steep";
  EXPECT_LT(s.proxy_mm.z, 1);
}

TEST(Peers, TheDepthBufferLosesTheOtherSideOfASteepValley) {
  // The camera looks along the normal of the side that is touched, and so edge on at the other.
  const FeltMesh mesh(landscape(steep_valley));
  DepthBuffer a({&mesh, nullptr, 1}, one_newton_a_mm());
  EXPECT_EQ(go(a, {3, 0.2, 8}, {3, 0.2, 1}).touched, 1);
  EXPECT_EQ(go(a, {3, 0.2, 1}, {0.1, 0.2, -2}, 200).touched, 0);
}

TEST(Peers, ANewPlaneTakesOverWithinTheRecoveryTime) {
  const FeltMesh mesh(landscape(steep_valley));
  PeerParams params = one_newton_a_mm();
  const auto largest_step = [&](double recovery_s) {
    params.recovery_s = recovery_s;
    TangentPlane a({&mesh, nullptr, 1}, params);
    Vec3 before;
    double most = 0;
    int n = 0;
    for (double x = -4; x < 4; x += 0.02, ++n) {
      const Vec3 p{x, 0.2, std::abs(x) - 1};
      if (n % ticks_a_picture == 0) a.client(p);
      const Vec3 force = a.update(at(p)).force_n;
      if (n > 100) most = std::max(most, std::abs(norm(force) - norm(before)));
      before = force;
    }
    return most;
  };
  const double at_once = largest_step(0), recovered = largest_step(0.02);
  EXPECT_GT(at_once, 0.2);
  EXPECT_LT(recovered, 0.4 * at_once);
}

}  // namespace
}  // namespace trephine::peers
