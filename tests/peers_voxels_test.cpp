// SPDX-License-Identifier: GPL-3.0-or-later
// Each algorithm of voxels on its paper's own examples: a plane, a sphere, a wedge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "peers/slab.h"
#include "peers_scenes.h"
#include "voxel/decode.h"

namespace trephine::peers {
namespace {

// A shape of voxels: a point belongs to it as far as `depth_mm` says, which is positive inside.
struct Solid {
  voxel::HapticVolume volume;
  std::unique_ptr<contact::ContactVolume> contact;
  PeerScene scene() const { return {nullptr, contact.get(), 1}; }
};
std::unique_ptr<Solid> solid(const std::function<double(Vec3)>& depth_mm) {
  constexpr int n = 72;
  constexpr double voxel_mm = 0.5;
  auto out = std::make_unique<Solid>();
  grid::Lattice l;
  l.size = {n, n, n};
  l.spacing_mm = {voxel_mm, voxel_mm, voxel_mm};
  l.origin_mm = Vec3{1, 1, 1} * (-0.5 * (n - 1) * voxel_mm);
  out->volume.voxels = grid::Grid<std::int16_t>(l, voxel::haptic_empty);
  out->volume.shapes = {voxel::occupancy_shape("solid", 1)};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double occupancy = 0.5 + depth_mm(l.to_world_mm({double(i), double(j), double(k)})) / voxel_mm;
        const int share = int(std::lround(voxel::haptic_full * std::clamp(occupancy, 0.0, 1.0)));
        if (share > 0)
          out->volume.voxels.at(i, j, k) = std::int16_t(voxel::haptic_base_step + share +
                                                        (share < voxel::haptic_full ? voxel::haptic_bare_offset : 0));
      }
  out->contact = std::make_unique<contact::ContactVolume>(out->volume);
  return out;
}

// How exact an algorithm of voxels is: of the force, in N at 1 N/mm, and of its direction.
struct Tolerance {
  double force_n, cosine;
};
Tolerance tolerance_of(const AlgorithmKind& kind) {
  if (kind.name == "ours") return {0.06, 0.995};
  if (kind.name == "stepped") return {0.45, 0.97};  // the boxes of the voxels are felt
  return {0.35, 0.95};  // scalar_surface: it rests where the voxels are full enough to hold what presses
}
std::vector<AlgorithmKind> of_voxels() {
  std::vector<AlgorithmKind> all;
  for (AlgorithmKind& k : all_algorithms())
    if (!k.feels_mesh) all.push_back(std::move(k));
  return all;
}

TEST(Peers, APlaneOfVoxelsPressesWithTheSpringAndHoldsNothingBackAlongIt) {
  const Vec3 normal = normalized(Vec3{0.23, -0.31, 0.92}), along = normalized(cross(normal, Vec3{0.3, 1, 0.1}));
  const auto plane = solid([&](Vec3 p) { return -dot(p, normal); });
  for (const AlgorithmKind& kind : of_voxels()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make(plane->scene(), one_newton_a_mm());
    EXPECT_EQ(go(*a, normal * 5, normal * 1.5).touched, 0);
    go(*a, normal * 1.5, normal * -1);
    const haptics::HapticState& s = go(*a, normal * -1, normal * -1 + along * 6, 600);
    EXPECT_EQ(s.touched, 1);
    EXPECT_NEAR(norm(s.force_n), 1, tolerance_of(kind).force_n);
    EXPECT_GT(dot(normalized(s.force_n), normal), tolerance_of(kind).cosine);
    EXPECT_EQ(go(*a, normal * -1 + along * 6, normal * 2 + along * 6).force_n, Vec3{});
  }
}

TEST(Peers, ASphereOfVoxelsHoldsTheProxyWhereItIsNearestToTheDevice) {
  const double radius = 10;
  const auto sphere = solid([&](Vec3 p) { return radius - norm(p); });
  for (const AlgorithmKind& kind : of_voxels()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make(sphere->scene(), one_newton_a_mm());
    go(*a, {0, 0, radius + 3}, {0, 0, radius - 1});
    double worst_force = 0, worst_cosine = 1;
    for (double angle = 0; angle < 2; angle += 0.001) {
      const Vec3 way{std::sin(angle) * 0.8, std::sin(angle) * 0.6, std::cos(angle)};
      const haptics::HapticState& s = a->update(at(way * (radius - 1)));
      worst_force = std::max(worst_force, std::abs(norm(s.force_n) - 1));
      worst_cosine = std::min(worst_cosine, dot(normalized(s.force_n), way));
    }
    EXPECT_LT(worst_force, tolerance_of(kind).force_n);
    EXPECT_GT(worst_cosine, tolerance_of(kind).cosine);
  }
}

TEST(Peers, AWedgeOfVoxelsIsSlidOver) {
  const Vec3 left = normalized(Vec3{-1, 0, 1}), right = normalized(Vec3{1, 0, 1});
  const auto wedge = solid([&](Vec3 p) { return -std::max(dot(p, left), dot(p, right)); });
  for (const AlgorithmKind& kind : of_voxels()) {
    SCOPED_TRACE(kind.name);
    const auto a = kind.make(wedge->scene(), one_newton_a_mm());
    go(*a, Vec3{-5, 0.2, -5} + left * 3, Vec3{-5, 0.2, -5} - left);
    const haptics::HapticState before = go(*a, Vec3{-5, 0.2, -5} - left, Vec3{-3, 0.2, -3} - left, 400);
    EXPECT_GT(dot(normalized(before.force_n), left), tolerance_of(kind).cosine);
    // Over the edge, and down the other side as deep as before.
    go(*a, Vec3{-3, 0.2, -3} - left, {0, 0.2, -0.6}, 400);
    go(*a, {0, 0.2, -0.6}, Vec3{3, 0.2, -3} - right, 400);
    const haptics::HapticState& after = go(*a, Vec3{3, 0.2, -3} - right, Vec3{5, 0.2, -5} - right, 400);
    EXPECT_EQ(after.touched, 1);
    EXPECT_GT(dot(normalized(after.force_n), right), tolerance_of(kind).cosine);
    EXPECT_NEAR(norm(after.force_n), 1, tolerance_of(kind).force_n);
  }
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

}  // namespace
}  // namespace trephine::peers
