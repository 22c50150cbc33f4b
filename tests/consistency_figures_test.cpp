// SPDX-License-Identifier: GPL-3.0-or-later
// A head's figures: on ellipsoids whose widths are known, and on the phantom's variants.
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/pi.h"
#include "consistency/anatomy_gate.h"
#include "consistency_samples.h"
#include "report_of.h"

namespace trephine {
namespace {

/// Inside positive, to first order in mm.
double ellipsoid(Vec3 p, Vec3 centre, Vec3 radii) {
  const Vec3 q = p - centre;
  const Vec3 u{q.x / radii.x, q.y / radii.y, q.z / radii.z};
  return (1 - norm(u)) * std::min({radii.x, radii.y, radii.z});
}

/// A skull of inner width 140, horns whose outer walls are `width` apart and whose septum lies at `middle`, turned
/// about z by `turn` radians and moved.
struct Simple {
  double width = 36, middle = 0, turn = 0, step = 1.5;
  Vec3 centre{3, -5, 10};
  grid::Field skull, brain, ventricles;
  head::HeadLandmarks landmarks;

  void make() {
    const double c = std::cos(turn), s = std::sin(turn);
    grid::Lattice l = head_lattice(step);
    const auto in_head = [=](Vec3 p) {
      const Vec3 q = p - centre;
      return Vec3{c * q.x + s * q.y, -s * q.x + c * q.y, q.z};
    };
    skull = field_of(l, [&](Vec3 p) {
      const Vec3 q = in_head(p);
      return std::min(ellipsoid(q, {}, {77, 95, 72}), -ellipsoid(q, {}, {70, 88, 65}));
    });
    brain = field_of(l, [&](Vec3 p) { return ellipsoid(in_head(p), {}, {67, 85, 62}); });
    const double w = width, m = middle;
    ventricles = field_of(l, [&](Vec3 p) {
      const Vec3 q = in_head(p);
      // Two slabs of 1.5 mm off the septum, 90 mm long, 14 high; a third ventricle below.
      const double horns =
          std::min({w / 2 - std::abs(q.x - m), std::abs(q.x - m) - 1.5, 45 - std::abs(q.y), 7 - std::abs(q.z)});
      const double third = std::min({4 - std::abs(q.x - m), 10 - std::abs(q.y), 12 - std::abs(q.z + 12)});
      return std::max(horns, third);
    });
    landmarks.midsagittal.point_mm = centre;
    landmarks.midsagittal.normal = {c, s, 0};
    landmarks.midsagittal.confidence = 1;
  }
  head::HeadFields fields() const { return {nullptr, &skull, &brain, &ventricles}; }
};

TEST(HeadFigures, WidthsOfSimpleShapes) {
  for (const double turn : {0.0, 0.2}) {
    Simple s;
    s.turn = turn;
    s.make();
    Report report;
    const head::HeadFigures f = result_of(report, head::measure_head(s.fields(), &s.landmarks, {}));
    ASSERT_TRUE(f.evans_index_ratio && f.midline_shift_mm);
    EXPECT_NEAR(*f.frontal_horns_mm, 36, 0.5) << turn;
    // In the plane at the widest line's level the inner skull is 140 wide, less what its height takes.
    const double up = dot(f.evans_place_mm - s.centre, Vec3{0, 0, 1});
    EXPECT_NEAR(*f.inner_skull_mm, 140 * std::sqrt(1 - up * up / (65.0 * 65.0)), 0.8) << turn;
    EXPECT_NEAR(*f.midline_shift_mm, 0, 0.1) << turn;
    EXPECT_EQ(f.midline_of, "septum");
    EXPECT_EQ(f.head_class, head::HeadClass::normal);
    EXPECT_NEAR(*f.brain_ml, 4.0 / 3 * pi * 67 * 85 * 62 / 1000, 8);
  }
}

// What the scan cannot show makes the class uncertain, however whole the ventricles look.
TEST(HeadFigures, AScanTooNoisyOrTooSmoothIsUncertain) {
  Simple s;
  s.make();
  const auto class_with = [&](double voxel_hu, double cube_hu, std::int64_t tiles) {
    mask::ScanFigures scan;
    scan.noise_hu = voxel_hu, scan.cube_noise_hu = cube_hu, scan.tiles_count = tiles;
    head::HeadFields fields = s.fields();
    fields.scan = &scan;
    Report report;
    const head::HeadClass c = result_of(report, head::measure_head(fields, &s.landmarks, {})).head_class;
    EXPECT_EQ(report.warnings.empty(), c != head::HeadClass::uncertain);
    return c;
  };
  EXPECT_EQ(class_with(10, 5, 500), head::HeadClass::normal);
  EXPECT_EQ(class_with(40, 30, 500), head::HeadClass::uncertain);
  EXPECT_EQ(class_with(95, 20, 500), head::HeadClass::uncertain);
  EXPECT_EQ(class_with(1.1, 0.8, 500), head::HeadClass::uncertain);
  EXPECT_EQ(class_with(1.1, 0.8, 10), head::HeadClass::normal);  // not known
}

TEST(HeadFigures, ASideWithoutItsTrigoneIsUncertain) {
  Simple s;
  s.make();
  grid::Field& f = s.ventricles;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        const Vec3 p = f.to_world_mm({double(i), double(j), double(k)}) - s.centre;
        if (p.x < -1 && p.y > 10) f.at(i, j, k) = -5;
      }
  Report report;
  EXPECT_EQ(result_of(report, head::measure_head(s.fields(), &s.landmarks, {})).head_class, head::HeadClass::uncertain);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("the right lateral ventricle ends"), std::string::npos) << report.warnings[0];
}

TEST(HeadFigures, ShiftAgainstPlaneAndAgainstTheInnerSkull) {
  Simple s;
  s.middle = 7;
  s.make();
  Report report;
  const head::HeadFigures with = result_of(report, head::measure_head(s.fields(), &s.landmarks, {}));
  EXPECT_NEAR(with.midline_shift_mm.value(), 7, 0.2);
  EXPECT_EQ(with.head_class, head::HeadClass::shifted);
  EXPECT_TRUE(report.warnings.empty());
  const head::HeadFigures without = result_of(report, head::measure_head(s.fields(), nullptr, {}));
  EXPECT_NEAR(without.midline_shift_mm.value(), 7, 0.3);
  EXPECT_EQ(without.head_class, head::HeadClass::shifted);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("midsagittal"), std::string::npos);
}

TEST(HeadFigures, WideHornsAreHydrocephalic) {
  Simple s;
  s.width = 48;
  s.make();
  Report report;
  const head::HeadFigures f = result_of(report, head::measure_head(s.fields(), &s.landmarks, {}));
  EXPECT_EQ(f.head_class, head::HeadClass::hydrocephalic);
  head::HeadClassParams strict;
  strict.hydrocephalic_evans_ratio = 0.4;
  EXPECT_EQ(result_of(report, head::measure_head(s.fields(), &s.landmarks, strict)).head_class,
            head::HeadClass::normal);
}

TEST(HeadFigures, WhatIsMissingIsNotMeasured) {
  Simple s;
  s.make();
  head::HeadFields fields = s.fields();
  fields.skull = nullptr;
  Report report;
  const head::HeadFigures f = result_of(report, head::measure_head(fields, &s.landmarks, {}));
  EXPECT_FALSE(f.evans_index_ratio);
  EXPECT_FALSE(f.skull_ml);
  EXPECT_TRUE(f.midline_shift_mm);
  EXPECT_EQ(f.head_class, head::HeadClass::unknown);
  const head::HeadFigures none = result_of(report, head::measure_head({}, nullptr, {}));
  EXPECT_EQ(none.head_class, head::HeadClass::unknown);
}

void expect_class(phantom::Variant variant, int seed, double step_mm) {
  phantom::HeadParams p;
  p.variant = variant;
  p.seed = seed;
  p.level = phantom::Level::clinical;
  const TrueHead h = true_head(p, step_mm);
  head::HeadLandmarks plane_only = h.landmarks;
  plane_only.landmarks.clear();
  const head::HeadClass want = variant == phantom::Variant::normal          ? head::HeadClass::normal
                               : variant == phantom::Variant::hydrocephalic ? head::HeadClass::hydrocephalic
                               : variant == phantom::Variant::shifted       ? head::HeadClass::shifted
                                                                            : head::HeadClass::small;
  const head::HeadLandmarks* const all[] = {&h.landmarks, &plane_only, nullptr};
  for (const head::HeadLandmarks* landmarks : all) {
    Report report;
    const head::HeadFigures f = result_of(report, head::measure_head(h.fields(), landmarks, {}));
    EXPECT_EQ(f.head_class, want) << "seed " << seed << ", Evans " << f.evans_index_ratio.value_or(-1) << ", shift "
                                  << f.midline_shift_mm.value_or(-99);
    if (!landmarks) continue;
    EXPECT_NEAR(f.midline_shift_mm.value(), variant == phantom::Variant::shifted ? -8 : 0, 0.6) << seed;
  }
}

TEST(HeadFigures, ClassOfThePhantom) {
  expect_class(phantom::Variant::small, 1, 2.5);
  expect_class(phantom::Variant::shifted, 2, 2.5);
}

TEST(LongHeadFigures, ClassOf15Phantoms) {
  for (int n = 0; n < 15; ++n) expect_class(phantom::Variant(n % 4), n + 1, 2);
}

}  // namespace
}  // namespace trephine
