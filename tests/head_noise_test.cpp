// SPDX-License-Identifier: GPL-3.0-or-later
// What noise does to the surface of a brain that has no sulci at all: whatever is deep in it was made by noise.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "head/brain.h"
#include "head_recipe.h"
#include "meshing/contour.h"
#include "metrics/deviation.h"
#include "random.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

constexpr double inner_mm = 70, brain_mm = 66;  // of the skull's inside, and of the brain

/// A ball of brain in CSF and bone, in voxels of 1 x 1 x 1 mm, blurred as a scanner's kernel does it: the edges are
/// 1.2 mm wide.
grid::Grid<std::int16_t> ball(double noise_hu, std::uint64_t seed) {
  grid::Grid<std::int16_t> g;
  grid::Lattice l;
  l.size = {180, 180, 180};
  l.spacing_mm = {1, 1, 1};
  l.origin_mm = {-89.3, -89.6, -89.1};
  static_cast<grid::Lattice&>(g) = l;
  g.voxels.resize(g.count());
  Random random(seed);
  const auto noise = [&] {  // of unit variance
    return std::sqrt(-2 * std::log(1 - random())) * std::cos(2 * pi * random());
  };
  const auto share = [](double mm) { return 0.5 * (1 + std::erf(mm / 0.85)); };  // of what lies inside
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double r = norm(g.to_world_mm({double(i), double(j), double(k)}));
        double hu = -1000;
        hu += 1040 * share(83 - r);
        hu += (1200 - 40) * share(77 - r);
        hu += (8 - 1200) * share(inner_mm - r);
        hu += (32 - 8) * share(brain_mm - r);
        g.at(i, j, k) = std::int16_t(std::lround(hu + noise_hu * noise()));
      }
  return g;
}

metrics::Deviation deviation(double noise_hu, std::uint64_t seed) {
  const grid::HuVolume volume = ball(noise_hu, seed);
  const grid::Field skull = segmentation::segment(volume, {}, head_recipe::skull()).value;
  const grid::Field brain = head::find_brain(volume, {&skull, nullptr, nullptr, {}}, head_recipe::brain()).value;
  return metrics::measure_deviation_to_truth(meshing::contour(brain, {}).value,
                                             [](Vec3 p) { return norm(p) - brain_mm; }, shapes::sphere(5, brain_mm),
                                             {40000, false});
}

/// p99: not more than a hundredth of either surface lies farther from the other.
void expect_smooth(double noise_hu, std::uint64_t seed, double p99_mm) {
  const metrics::Deviation d = deviation(noise_hu, seed);
  EXPECT_LE(d.mesh_to_reference.p99_mm, p99_mm) << noise_hu;
  EXPECT_LE(d.reference_to_mesh.p99_mm, p99_mm) << noise_hu;
  std::cout << noise_hu << " HU, bias " << d.both.bias_mm << ", rms " << d.both.rms_mm << ", p99 "
            << d.mesh_to_reference.p99_mm << " and " << d.reference_to_mesh.p99_mm << ", max " << d.both.max_mm
            << " mm\n";
}

TEST(BrainNoise, CutsNoSulciIntoABall) { expect_smooth(12, 1, 1); }
TEST(LongBrainNoise, CutsNoSulciIntoABall) {
  for (const std::uint64_t seed : {2, 3}) {
    expect_smooth(12, seed, 1);
    expect_smooth(25, seed, 1.5);
    expect_smooth(50, seed, 1.9);  // of CSF and brain 24 HU apart
  }
}

}  // namespace
}  // namespace trephine
