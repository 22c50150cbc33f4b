// SPDX-License-Identifier: GPL-3.0-or-later
// M9: any cutter in any pose: a valid surface without the right volume, or 80.
#include <gtest/gtest.h>

#include <cstdio>

#include "base/error.h"
#include "boolean/cut_surface.h"
#include "boolean/overlap.h"
#include "cut_surface_shapes.h"
#include "report_of.h"

using namespace trephine;
using namespace trephine::shapes;

namespace {

struct Counts {
  int done = 0, refused = 0, touched = 0, retried = 0, twice = 0;
};

Counts run(int poses, std::uint64_t seed) {
  const surface::TriMesh surfaces[] = {vault(3), plate(70, 10, 5), sphere(2, 38.3)};
  Random r(seed);
  Counts n;
  for (int i = 0; i < poses; ++i) {
    surface::TriMesh m = surfaces[i % 3];
    meshing::snap_to_float32(m);
    const boolean::Cutter c = any_cutter(r, i % 3 == 1 ? 20 : 38);
    Report report;
    try {
      const surface::TriMesh out = value_of(report, boolean::cut_surface(m, {c}, {}));
      ++n.done;
      const meshing::Validity v = meshing::check_validity(out);
      EXPECT_TRUE(v.valid() && v.float32) << i << ": " << v.text();
      const double removed = surface::volume_mm3(m) - surface::volume_mm3(out) - figure(report, "dropped_mm3");
      const double exact = boolean::overlap_mm3(m, boolean::mesh_of(c, 0.01), {0.2, 0.5, 0.7});
      EXPECT_NEAR(removed, exact, std::max(0.5, 0.0105 * exact)) << i;
      n.touched += removed > 0;
      n.retried += figure(report, "tries_count") > 1;
      if (i % 4 != 0 || removed == 0) continue;
      // The same once more meets its own facets everywhere.
      Report again;
      ++n.twice;
      const surface::TriMesh twice = value_of(again, boolean::cut_surface(out, {c}, {}));
      EXPECT_TRUE(meshing::check_validity(twice).valid()) << i;
      EXPECT_LE(figure(again, "removed_mm3"), std::max(0.5, 0.01 * exact)) << i;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << i;
      std::printf("pose %d: %s\n", i, e.line("").c_str());
      ++n.refused;
    }
  }
  std::printf("%d poses: %d valid (%d cut something, %d needed another try, %d cut twice), %d refused\n", poses, n.done,
              n.touched, n.retried, n.twice, n.refused);
  return n;
}

}  // namespace

TEST(CutPoses, Of50NoneIsInvalidOrRefused) {
  const Counts n = run(50, 1);
  EXPECT_EQ(n.refused, 0);
  EXPECT_GT(n.touched, 30);
}

// 10,000 in four parts; one in a thousand may be refused.
class LongCutPoses : public testing::TestWithParam<int> {};
TEST_P(LongCutPoses, Of2500NoneIsInvalidAndAtMostTwoRefused) {
  const Counts n = run(2500, std::uint64_t(GetParam()));
  EXPECT_LE(n.refused, 2);
  EXPECT_GT(n.touched, 1700);
}
INSTANTIATE_TEST_SUITE_P(, LongCutPoses, testing::Values(2, 3, 4, 5));
