// SPDX-License-Identifier: GPL-3.0-or-later
// Each algorithm on its paper's own examples: a plane, a sphere, a wedge. And what thin walls do to it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "base/error.h"
#include "peers/depth_buffer.h"
#include "peers/experiment.h"
#include "peers/god_object.h"
#include "peers/loaded_peer.h"
#include "peers/round_proxy.h"
#include "peers/shape_mesh.h"
#include "peers/slab.h"
#include "peers/tangent_plane.h"

namespace trephine::peers {
namespace {

haptics::HapticInput at(Vec3 p) {
  haptics::HapticInput in;
  in.tip_mm = p;
  in.dt_s = in.period_s = tick_s;
  return in;
}

// Moves the device in even steps and makes a picture for each tick, so that what pictures miss is not in the way.
const haptics::HapticState& go(ContactAlgorithm& a, Vec3 from, Vec3 to, int ticks = 200) {
  const haptics::HapticState* state = nullptr;
  for (int n = 0; n <= ticks; ++n) {
    const Vec3 p = from + (to - from) * (double(n) / ticks);
    a.client(p);
    state = &a.update(at(p));
  }
  return *state;
}

// A surface z(x, y) over 40 x 40 mm in squares of `step` mm, open below: only its front is met.
surface::TriMesh landscape(const std::function<double(double, double)>& z, double step = 1, Vec3 origin = {}) {
  const int n = int(std::lround(40 / step));
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) points.push_back({i * step - 20, j * step - 20, z(i * step - 20, j * step - 20)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto p = [&](int di, int dj) { return std::uint32_t((j + dj) * (n + 1) + i + di); };
      triangles.push_back({p(0, 0), p(1, 0), p(1, 1)});
      triangles.push_back({p(0, 0), p(1, 1), p(0, 1)});
    }
  surface::TriMesh m;
  m.origin_mm = origin;
  m.points_mm = std::move(points);
  m.triangles = std::move(triangles);
  return m;
}

double flat(double, double) { return 0; }
// Two planes that meet in the line x = 0: a valley, and turned over a ridge.
double valley(double x, double) { return 0.5 * std::abs(x); }
double steep_valley(double x, double) { return std::abs(x); }
double ridge(double x, double) { return -std::abs(x); }

PeerParams one_newton_a_mm() {
  PeerParams p;
  p.spring_n_per_mm = 1;
  p.god_object_lift_mm = 1e-6;  // its own falls are tested apart
  return p;
}

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
  const PeerParams params = one_newton_a_mm();
  for (const AlgorithmKind& kind : of_meshes()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make({&mesh, nullptr, 1}, params);
    go(*a, {0, 0, radius + 3}, {0, 0, radius - 1});
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
  a.update(at({0, 0, 15}));
  a.client({0, 0, 15});
  EXPECT_EQ(a.local_triangles(), 0u);
  EXPECT_EQ(a.update(at({0, 0, -1})).touched, 0) << "no picture since: the plane is not known";
  a.reset();
  a.update(at({0, 0, 5}));
  a.client({0, 0, 5});
  EXPECT_GT(a.local_triangles(), 100u);
  EXPECT_EQ(a.update(at({0, 0, -1})).touched, 1);
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

TEST(Peers, TheScalarSurfaceGivesWayToWhatIsStrongerThanTheVoxelsAreFull) {
  const auto slab = make_slab(8, 0.5);
  PeerParams params = one_newton_a_mm();
  params.most_strength_n = 4;
  const PeerScene scene = slab->scene();
  const voxel::HapticDecoder decoder(slab->volume);
  for (const AlgorithmKind& kind : all_algorithms()) {
    if (kind.name != "scalar_surface") continue;
    const auto a = kind.make(scene, params);
    const auto pressed = [&](double depth_mm) {
      const Vec3 top = slab->middle_mm + slab->normal * 4;
      return go(*a, top + slab->normal * 3, top - slab->normal * depth_mm, 2000);
    };
    for (const double depth : {0.5, 1.0, 2.0}) {
      const haptics::HapticState s = pressed(depth);
      a->reset();
      const double strength = 4 * decoder.trilinear(1, s.proxy_mm);
      EXPECT_NEAR(norm(s.force_n), strength, 0.1) << "it rests where the strength is what presses";
      EXPECT_GT(dot(normalized(s.force_n), slab->normal), 0.98);
    }
    EXPECT_EQ(pressed(6.5).touched, 0) << "no voxel is stronger than that, and then there is no gradient";
  }
}

// Of 100 pokes at 1, 10 and 100 mm a tick.
TEST(Peers, WhoFallsThroughAThinPlate) {
  const auto slab = make_slab(0.5, 0.25), wall = make_voxel_wall(0.5);
  std::map<std::string, std::array<int, 3>> plate, voxels;
  for (const AlgorithmKind& kind : all_algorithms())
    for (std::size_t n = 0; n < 3; ++n) {
      const double mm_a_tick = std::pow(10.0, double(n));
      const auto a = kind.make(slab->scene(), PeerParams{});
      plate[kind.name][n] = count_falls(*a, *slab, mm_a_tick, 100);
      if (!kind.feels_mesh) voxels[kind.name][n] = count_falls(*kind.make(wall->scene(), {}), *wall, mm_a_tick, 100);
    }
  const std::array<int, 3> never{0, 0, 0};
  EXPECT_EQ(plate["ours"], never);
  EXPECT_EQ(voxels["ours"], never);
  EXPECT_EQ(plate["god_object_lifted"], never);
  EXPECT_GT(plate["god_object"][0], 30) << "rounding decides whether it is in front of the next facet";
  EXPECT_GT(plate["ruspini"][1], 20) << "the device leaves the local set between two pictures";
  EXPECT_GT(plate["ruspini"][2], 20);
  EXPECT_GT(voxels["stepped"][0] + voxels["stepped"][1] + voxels["stepped"][2], 0)
      << "a step of a voxel's side passes corners (chapter 3 says that it does not)";
}

TEST(Peers, ALibraryIsAPeer) {
  const AlgorithmKind kind = load_peer(PEER_STUB);
  EXPECT_EQ(kind.name, "plane_stub");
  const Vec3 origin{1, 2, 3};
  const FeltMesh mesh(landscape(flat, 10, origin));
  const auto a = kind.make({&mesh, nullptr, 7}, one_newton_a_mm());
  EXPECT_EQ(a->update(at(origin + Vec3{0, 0, 1})).touched, 0);
  const haptics::HapticState& s = a->update(at(origin + Vec3{4, 0, -2}));
  EXPECT_EQ(s.touched, 7);
  EXPECT_EQ(s.force_n, (Vec3{0, 0, 2}));
  EXPECT_EQ(s.proxy_mm, origin + (Vec3{4, 0, 0}));
  try {
    a->update(at(origin - Vec3{0, 0, 2000}));
    FAIL() << "the stub fails that deep";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::io);
    EXPECT_EQ(e.field(), "trephine_peer_step");
  }
  EXPECT_THROW(load_peer("/dev/null"), Error);
}

TEST(Peers, AShapesMeshIsWhatIsFeltWhateverItsTriangles) {
  const auto slab = make_slab(8, 1);
  const surface::TriMesh mesh = mesh_of_shape(slab->volume, 1);
  EXPECT_TRUE(surface::topology_of(mesh).closed());
  EXPECT_GT(surface::volume_mm3(mesh), 0);
  const std::size_t n = mesh.triangles.size();
  const surface::TriMesh more = with_triangles(mesh, 3 * n), fewer = with_triangles(mesh, n / 8);
  EXPECT_NEAR(double(more.triangles.size()), 3.0 * double(n), 0.02 * double(n));
  EXPECT_NEAR(double(fewer.triangles.size()), double(n) / 8, 0.02 * double(n));
  EXPECT_NEAR(surface::volume_mm3(more), surface::volume_mm3(mesh), 1e-3 * surface::volume_mm3(mesh));
  EXPECT_NEAR(surface::volume_mm3(fewer), surface::volume_mm3(mesh), 1e-2 * surface::volume_mm3(mesh));
}

}  // namespace
}  // namespace trephine::peers
