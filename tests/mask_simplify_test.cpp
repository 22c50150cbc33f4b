// SPDX-License-Identifier: GPL-3.0-or-later
// Tunnels and cavities closed in the field, and nothing else touched.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/simplify_topology.h"
#include "meshing_shapes.h"
#include "report_of.h"
#include "surface/trimesh.h"

namespace trephine {
namespace {

using namespace shapes;

struct Result {
  grid::Field field;
  Report report;
  double number(const char* name) const { return std::get<double>(*report.find(name)); }
  std::int64_t count(const char* name) const { return std::get<std::int64_t>(*report.find(name)); }
};

Result simplified(const grid::Field& f, double handles_mm, double cavities_ml) {
  mask::SimplifyParams p;
  p.close_handles_mm = handles_mm;
  p.close_cavities_ml = cavities_ml;
  Result r;
  r.field = value_of(r.report, mask::simplify_topology(f, p));
  // Where the sign did not change the value did not.
  std::int64_t changed = 0;
  for (std::size_t i = 0; i < f.voxels.size(); ++i)
    if (f.voxels[i] > 0 || r.field.voxels[i] <= 0)
      EXPECT_EQ(f.voxels[i], r.field.voxels[i]);
    else
      ++changed;
  EXPECT_EQ(changed, r.count("voxels_changed_count"));
  return r;
}

long genus(const grid::Field& f) { return surface::topology_of(contoured(f)).genus; }

/// A plate of 5 mm with holes of 2, 4 and 8 mm through it, on voxels of 0.5 x 0.6 x 0.7 mm.
grid::Field plate() {
  return sample(lattice(100, 40, 24, {0.5, 0.6, 0.7}), [](Vec3 p) {
    double d = 2.5 - std::abs(p.z - 8);
    d = std::min({d, p.x - 3, 46 - p.x, p.y - 3, 21 - p.y});
    const double centre[3] = {9, 20, 35}, radius[3] = {1, 2, 4};
    for (int h = 0; h < 3; ++h) d = std::min(d, std::hypot(p.x - centre[h], p.y - 12) - radius[h]);
    return d;
  });
}

TEST(SimplifyTopology, HolesNarrowerThanAskedAreClosed) {
  const grid::Field f = plate();
  ASSERT_EQ(genus(f), 3);
  const long expected[] = {3, 2, 1, 0};
  const double width[] = {1.5, 2.8, 5.5, 9.5};
  for (int n = 0; n < 4; ++n) {
    const Result r = simplified(f, width[n], 0);
    EXPECT_EQ(genus(r.field), expected[n]) << width[n];
    EXPECT_EQ(r.count("handles_before_count"), 3);
    EXPECT_EQ(r.count("handles_after_count"), expected[n]);
    EXPECT_EQ(r.count("euler_characteristic_before"), -4);
    EXPECT_EQ(r.count("euler_characteristic_after"), 2 - 2 * expected[n]);
    EXPECT_EQ(r.count("membranes_count"), 3 - expected[n]);
    EXPECT_LE(r.number("moved_max_mm"), width[n] / 2 + 0.53);
    // Membranes, not plugs: a voxel or two of the hole's area.
    double area = 0;
    for (int h = 0; h < 3 - expected[n]; ++h) area += M_PI * std::pow(2, 2 * h);
    EXPECT_LT(r.number("volume_added_ml") * 1000, 2.5 * 0.7 * area + 1e-9) << width[n];
  }
}

TEST(SimplifyTopology, GapsAndFurrowsStayOpen) {
  // Two plates a millimetre apart, joined at one side; and a furrow: closing fills both, and neither has a tunnel.
  const grid::Field f = sample(lattice(60, 40, 40, {0.5, 0.5, 0.5}), [](Vec3 p) {
    const double plates = std::max(1.5 - std::abs(p.z - 8), 1.5 - std::abs(p.z - 12));
    const double bridge = 2 - std::abs(p.x - 5);
    const double in =
        std::min({std::max(plates, bridge), 7 - std::abs(p.z - 10), 12 - std::abs(p.x - 15), 8 - std::abs(p.y - 10)});
    return std::min(in, std::max(std::abs(p.y - 10) - 0.5, p.z - 7.5));
  });
  const Result r = simplified(f, 4, 1);
  EXPECT_EQ(r.count("handles_before_count"), 0);
  EXPECT_EQ(r.count("voxels_changed_count"), 0);
}

TEST(SimplifyTopology, PiecesAreNotJoined) {
  // Two balls a millimetre apart, and a ring that is open by a millimetre: closing would join them.
  const grid::Field f = sample(lattice(80, 44, 24, {0.5, 0.5, 0.5}), [](Vec3 p) {
    const double balls = std::max(4 - norm(p - Vec3{6, 6, 6}), 4 - norm(p - Vec3{15, 6, 6}));
    const double ring = 1.5 - std::hypot(std::hypot(p.x - 29, p.y - 14) - 6, p.z - 6);
    return std::max(balls, std::min(ring, std::max(std::abs(p.y - 14) - 0.5, p.x - 29)));
  });
  const Result r = simplified(f, 3, 1);
  EXPECT_EQ(surface::topology_of(contoured(r.field)).components, 3);
  EXPECT_EQ(genus(r.field), 0);
  EXPECT_EQ(r.count("voxels_changed_count"), 0);
}

TEST(SimplifyTopology, CavitiesByTheirSize) {
  // 0.27 ml and 4.2 ml, and a pocket of 2.1 ml whose mouth is 2 mm wide.
  const grid::Field f = sample(lattice(90, 44, 44), [](Vec3 p) {
    const double body = std::min({20 - std::abs(p.z - 21), 20 - std::abs(p.y - 21), 43 - std::abs(p.x - 44)});
    const double small = norm(p - Vec3{12, 21, 21}) - 4, large = norm(p - Vec3{35, 21, 21}) - 10;
    const double pocket =
        std::min(norm(p - Vec3{65, 21, 21}) - 8, std::max(std::hypot(p.x - 65, p.y - 21) - 1.3, 21 - p.z));
    return std::min({body, small, large, pocket});
  });
  EXPECT_EQ(surface::topology_of(contoured(f)).components, 3);
  const Result little = simplified(f, 0, 1);
  EXPECT_EQ(little.count("cavities_filled_count"), 1);
  EXPECT_EQ(surface::topology_of(contoured(little.field)).components, 2);
  EXPECT_EQ(little.number("moved_max_mm"), 0);
  // The pocket would become a cavity larger than is filled: it stays open.
  const Result open = simplified(f, 5, 1);
  EXPECT_EQ(open.count("membranes_count"), 0);
  EXPECT_EQ(open.count("cavities_after_count"), 1);
  const Result all = simplified(f, 5, 5);
  EXPECT_EQ(all.count("cavities_filled_count"), 3);
  EXPECT_EQ(surface::topology_of(contoured(all.field)).components, 1);
  EXPECT_NEAR(all.number("volume_added_ml"), 0.268 + 4.189 + 2.145, 0.15);
}

/// Smooth noise: walls and gaps of a few voxels.
grid::Field sponge(int n, std::uint64_t seed) {
  const grid::Field rough = noise(n + 4, seed, 0.5, false);
  grid::Field f(lattice(n, n, n));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int o = 0; o < 125; ++o) f.at(i, j, k) += rough.at(i + o % 5, j + o / 5 % 5, k + o / 25);
  return f;
}

TEST(SimplifyTopology, SpongesLoseTheirHandles) {
  long before = 0, after = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const grid::Field f = sponge(28, seed);
    const Result r = simplified(f, 4, 0.1);
    EXPECT_GE(r.count("euler_characteristic_after"), r.count("euler_characteristic_before"));
    EXPECT_LE(r.count("handles_after_count"), r.count("handles_before_count"));
    before += genus(f);
    after += genus(r.field);
  }
  std::printf("genus of the contours %ld -> %ld\n", before, after);
  EXPECT_LT(after, before / 2);
}

TEST(SimplifyTopology, RefusesWhatIsNotFinite) {
  grid::Field f = plate();
  f.at(3, 2, 1) = std::numeric_limits<float>::quiet_NaN();
  Report r;
  try {
    value_of(r, mask::simplify_topology(f, {}));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.field(), "voxel 3 2 1");
  }
}

TEST(SimplifyTopology, SameBitsWithAnyThreads) {
  const grid::Field f = noise(40, 9, 0.4, false);
  set_thread_count(1);
  const Result one = simplified(f, 3, 0.1);
  set_thread_count(2);
  const Result two = simplified(f, 3, 0.1);
  set_thread_count(0);
  EXPECT_TRUE(one.field == two.field);
  EXPECT_EQ(one.report.figures, two.report.figures);
}

}  // namespace
}  // namespace trephine
