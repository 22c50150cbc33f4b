// SPDX-License-Identifier: GPL-3.0-or-later
// What thin walls do to each algorithm, and what is told of it; algorithms of libraries; the meshes that are felt.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "base/error.h"
#include "peers/comparison.h"
#include "peers/god_object.h"
#include "peers/loaded_peer.h"
#include "peers/round_proxy.h"
#include "peers/shape_mesh.h"
#include "peers/slab.h"
#include "peers_scenes.h"

namespace trephine::peers {
namespace {

// Device and local set of the prototype whose falls the plan of record quotes: a set of a few mm, made in each tick.
TEST(Peers, TheFasterTheDeviceTheLessASmallLocalSetHolds) {
  const auto slab = make_slab(0.5, 0.25);
  PeerParams params;
  params.local_set_mm = 3;
  params.look_ahead_ratio = 0;
  int before = 0;
  for (const double mm_a_tick : {1.0, 10.0, 100.0}) {
    RoundProxy a({slab->mesh.get(), slab->contact.get(), 1}, params);
    PokeParams each_tick;
    each_tick.ticks_a_picture = 1;
    const int falls = count_falls(a, *slab, mm_a_tick, 100, each_tick);
    if (mm_a_tick == 1) {
      EXPECT_EQ(falls, 0);
    } else {
      EXPECT_GT(falls, before + 10);
    }
    before = falls;
  }
}

// Of the mesh's sides that it slides over, some let it through; straight down there are none.
TEST(Peers, TheGodObjectFallsWhereItSlidesFromFacetToFacet) {
  const auto slab = make_slab(0.5, 0.25);
  PokeParams straight;
  straight.max_tilt_rad = 0;
  for (const double mm_a_tick : {1.0, 10.0, 100.0}) {
    GodObject a({slab->mesh.get(), slab->contact.get(), 1}, PeerParams{});
    EXPECT_EQ(count_falls(a, *slab, mm_a_tick, 100, straight), 0);
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

// Where voxels are felt both walls are poked at a speed before the next speed's turn.
TEST(Peers, ThePageTellsEachWallsFallsBySpeed) {
  Comparison c;
  c.kinds = all_algorithms();
  for (const double mm_a_tick : {1.0, 10.0, 100.0}) {
    c.falls.push_back({"stepped", "plate of 0.5 mm", mm_a_tick, 300, 0});
    c.falls.push_back({"stepped", "one voxel of 0.5 mm", mm_a_tick, 300, int(200 + mm_a_tick)});
  }
  c.falls.push_back({"ruspini", "plate of 0.5 mm", 1, 300, 7});
  const std::string page = comparison_page(c, {});
  EXPECT_NE(page.find("| plate of 0.5 mm | 0 | 0 | 0 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| one voxel of 0.5 mm | 201 | 210 | 300 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| Ruspini | plate of 0.5 mm | 7 |  |  |"), std::string::npos) << page;
}

TEST(Peers, ATimeWithoutContactIsInBracketsAndInNoClaim) {
  Comparison c;
  c.kinds = all_algorithms();
  for (const std::size_t triangles : {std::size_t{10000}, std::size_t{100000}}) {
    c.meshes.push_back({triangles, triangles, 0, 0});
    for (const char* name : {"god_object", "god_object_lifted", "ruspini"}) {
      ServoRow row{name, triangles, {}};
      row.times.mean_us = name == std::string("ruspini") ? 1e-3 * double(triangles) : 0.5;
      row.times.touching_ratio = name == std::string("god_object") ? 0.05 : 1;
      c.servo.push_back(row);
    }
  }
  EXPECT_EQ(servo_of(c, "god_object", true), nullptr);
  const std::string page = comparison_page(c, {});
  EXPECT_NE(page.find("| god-object, bare | (0.50 / 0.00 / 0.0) | (0.50 / 0.00 / 0.0) |"), std::string::npos) << page;
  EXPECT_NE(page.find("| god-object, lifted | 0.50 / 0.00 / 0.0 | 0.50 / 0.00 / 0.0 |"), std::string::npos) << page;
  EXPECT_NE(page.find("1.0 (god-object, lifted) and 10.0 times"), std::string::npos) << page;
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
