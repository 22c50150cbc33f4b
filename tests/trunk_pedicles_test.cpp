// SPDX-License-Identifier: GPL-3.0-or-later
// Pedicles of a spine whose axes are known: found, refused, and doubted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "phantom/spine.h"
#include "report_of.h"
#include "trunk/pedicles.h"

namespace trephine {
namespace {

using phantom::Spine;
using phantom::SpineParams;

grid::Field field_of(const grid::Lattice& l, const std::function<double(Vec3)>& inside) {
  grid::Field f(l);
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i)
          f.at(i, j, k) = float(inside(l.to_world_mm({double(i), double(j), double(k)})));
  });
  return f;
}
grid::Lattice lattice_of_spine(const Spine& spine) { return phantom::lattice_about(spine, {0.7, 0.7, 1}, 42); }

void expect_truth(const Spine& spine, const std::vector<trunk::PedicleAxis>& found, double most_mm, double max_deg) {
  const auto truth = spine.pedicles();
  ASSERT_EQ(found.size(), truth.size());
  for (const Spine::Pedicle& t : truth)
    for (const trunk::PedicleAxis& p : found) {
      if (p.vertebra != t.vertebra + 1 || p.left != t.left) continue;
      const Vec3 way = normalized(p.target_mm - p.entry_mm), d = t.middle_mm - p.entry_mm;
      EXPECT_LT(norm(d - way * dot(d, way)), most_mm) << p.vertebra << " " << p.left;
      EXPECT_LT(std::acos(std::min(1.0, dot(way, t.forwards))) * 180 / M_PI, max_deg) << p.vertebra << " " << p.left;
      EXPECT_NEAR(p.half_width_mm, t.half_width_mm, 0.35);
      EXPECT_GT(p.confidence, 0.5) << p.doubt;
      // Entry and target lie on the surface behind and in the body.
      EXPECT_NEAR(spine.bone(p.entry_mm), 0, 0.6);
      EXPECT_LT(dot(p.entry_mm - t.middle_mm, t.forwards), -15);
      EXPECT_GT(spine.bone(p.target_mm), 4);
    }
}

TEST(Pedicles, AxesAreWithinAMillimetreAndTwoDegreesOfTheTruth) {
  SpineParams narrow, askew;
  narrow.half_width_mm = 3;
  narrow.converging_deg = 24;
  narrow.rising_deg = -3;
  askew.turned_deg = 8;
  for (const SpineParams& params : {SpineParams(), narrow, askew}) {
    const Spine spine(params);
    const grid::Lattice l = lattice_of_spine(spine);
    const auto found = trunk::find_pedicles(field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                                            field_of(l, [&](Vec3 p) { return spine.canal(p); }), {})
                           .value;
    expect_truth(spine, found, 1, 2);
    EXPECT_EQ(found.front().vertebra, 1);
    EXPECT_EQ(found.back().vertebra, 3);
    EXPECT_LT(found.front().middle_mm.z, found.back().middle_mm.z);  // counted from below
  }
}

TEST(Pedicles, LevelsAtAWrongDistanceAreSaid) {
  const Spine spine{SpineParams()};
  const grid::Lattice l = lattice_of_spine(spine);
  const grid::Field bone = field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                    canal = field_of(l, [&](Vec3 p) { return spine.canal(p); });
  const auto warned = [&](double slices) {
    grid::Field near = bone, canal_near = canal;
    near.spacing_mm.z *= slices;
    canal_near.spacing_mm.z *= slices;
    const auto found = trunk::find_pedicles(near, canal_near, {});
    const bool said = std::any_of(found.warnings.begin(), found.warnings.end(),
                                  [](const Warning& w) { return w.id == "unusual_levels"; });
    for (const trunk::PedicleAxis& p : found.value) EXPECT_EQ(p.confidence < 0.5, said) << p.doubt;
    return said;
  };
  EXPECT_FALSE(warned(1));
  EXPECT_TRUE(warned(0.6));
}

// Slices further apart than the hole that a vessel makes.
TEST(LongPedicles, AreFoundInSlicesOfTwoAndAHalfAndThreeMillimetres) {
  const Spine spine;
  for (const double slice_mm : {2.5, 3.0}) {
    const grid::Lattice l = phantom::lattice_about(spine, {0.9, 0.9, slice_mm}, 42);
    expect_truth(spine,
                 trunk::find_pedicles(field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                                      field_of(l, [&](Vec3 p) { return spine.canal(p); }), {})
                     .value,
                 1, 2);
  }
}

TEST(Pedicles, OneThatTheScanCutsIsLeftOutAndSaid) {
  const Spine spine;
  grid::Lattice l = lattice_of_spine(spine);
  // From the upper half of the lowest pedicles on.
  const double low = spine.level(0) + 6;
  l.size[2] -= int(low - l.origin_mm.z);
  l.origin_mm.z = low;
  Report report;
  const auto found = value_of(report, trunk::find_pedicles(field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                                                           field_of(l, [&](Vec3 p) { return spine.canal(p); }), {}));
  EXPECT_EQ(found.size(), 4u);
  EXPECT_EQ(found.front().vertebra, 1);  // counted from the lowest that is seen
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings[0].find("cut off"), std::string::npos);
}

TEST(Pedicles, WhatIsNoneIsDoubtfulOrRefused) {
  const Spine spine;
  const grid::Lattice l = lattice_of_spine(spine);
  const grid::Field canal = field_of(l, [&](Vec3 p) { return spine.canal(p); });
  // Without bone beside the canal.
  try {
    trunk::find_pedicles(field_of(l, [&](Vec3 p) { return std::abs(p.x) > 9 ? -1 : spine.bone(p); }), canal, {});
    ADD_FAILURE() << "found";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("pedicle_1_left_entry: [x, y, z]"), std::string::npos) << e.what();
  }
  // A person may give what is not found.
  EXPECT_TRUE(trunk::find_pedicles(field_of(l, [&](Vec3 p) { return std::abs(p.x) > 9 ? -1 : spine.bone(p); }), canal,
                                   {}, {}, true)
                  .value.empty());
  // One side alone; and a wall of bone along the whole canal, as a graft makes it.
  for (const trunk::PedicleAxis& p :
       trunk::find_pedicles(field_of(l, [&](Vec3 p) { return p.x > 5 && p.y > 12 ? -1 : spine.bone(p); }), canal, {})
           .value)
    EXPECT_LT(p.confidence, 0.5) << p.vertebra << p.left;
  const grid::Field wall = field_of(l, [&](Vec3 p) {
    return std::max(spine.bone(p), std::min(4 - std::abs(std::abs(p.x) - 17), 10 - std::abs(p.y - 22)));
  });
  try {
    for (const trunk::PedicleAxis& p : trunk::find_pedicles(wall, canal, {}).value)
      EXPECT_LT(p.confidence, 0.5) << p.doubt;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
  }
}

// What stands beside the canal is so high that no axis could be sure: said before one is looked for, unless a person
// gives them.
TEST(Pedicles, AWallOfBoneIsRefusedBeforeAxesAreLookedFor) {
  const Spine spine;
  const grid::Lattice l = lattice_of_spine(spine);
  const auto tall = [](Vec3 p) { return std::min(4 - std::abs(std::abs(p.x) - 17), 20 - std::abs(p.z)); };
  const grid::Field bone = field_of(l, tall), canal = field_of(l, [&](Vec3 p) { return 12 - std::abs(p.x); });
  const auto found = trunk::find_pedicles(bone, canal, {}, {}, true).value;
  ASSERT_EQ(found.size(), 2u);
  for (const trunk::PedicleAxis& p : found) EXPECT_EQ(p.confidence, 0) << p.doubt;
  try {
    trunk::find_pedicles(bone, canal, {});
    FAIL() << "looked for axes";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("is nowhere less than"), std::string::npos) << e.what();
  }
  EXPECT_NO_THROW(trunk::find_pedicles(field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                                       field_of(l, [&](Vec3 p) { return spine.canal(p); }), {}, {}, true)
                      .value);
}

TEST(Pedicles, ThinOnesAreDoubtful) {
  SpineParams params;
  params.half_width_mm = 0.9;
  const Spine spine(params);
  const grid::Lattice l = lattice_of_spine(spine);
  try {
    for (const trunk::PedicleAxis& p : trunk::find_pedicles(field_of(l, [&](Vec3 p) { return spine.bone(p); }),
                                                            field_of(l, [&](Vec3 p) { return spine.canal(p); }), {})
                                           .value)
      EXPECT_LT(p.confidence, 0.5) << p.half_width_mm;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
  }
}

TEST(Pedicles, AGivenAxisIsMeasured) {
  const Spine spine;
  const grid::Lattice l = lattice_of_spine(spine);
  const grid::Field bone = field_of(l, [&](Vec3 p) { return spine.bone(p); });
  const auto t = spine.pedicles()[0];
  const Vec3 entry = t.middle_mm - t.forwards * 20, target = t.middle_mm + t.forwards * 25;
  EXPECT_NEAR(trunk::clearance_along(bone, entry, target), 4.5, 0.4);
  EXPECT_NEAR(trunk::clearance_along(bone, entry + Vec3{2, 0, 0}, target + Vec3{2, 0, 0}), 2.5, 0.5);
  EXPECT_LT(trunk::clearance_along(bone, entry + Vec3{8, 0, 0}, target + Vec3{8, 0, 0}), 0);
}

}  // namespace
}  // namespace trephine
