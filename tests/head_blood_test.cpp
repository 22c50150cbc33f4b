// SPDX-License-Identifier: GPL-3.0-or-later
// Blood in the ventricles belongs to them, and blood in the brain does not.
#include <gtest/gtest.h>

#include "findings_scene.h"
#include "head/ventricles.h"

namespace trephine {
namespace {

struct Found {
  double dice = 0, blood_ml = 0, true_blood_ml = 0;
};

Found found_in(phantom::Blood blood, double ml, std::int64_t seed) {
  phantom::HeadParams who;
  who.level = phantom::Level::hard;
  who.variant = phantom::Variant::hydrocephalic;
  who.seed = seed;
  who.hard.blood = blood;
  who.hard.blood_ml = ml;
  who.hard.fillings_count = 0;
  const Truth& t = truth(who, 2);
  const auto ventricles = head::find_ventricles(t.volume, {&t.brain, nullptr}, {});
  const grid::Field field = grid::fit(ventricles.value, t.ventricles, -1.f);
  double both = 0, sum = 0;
  for (std::size_t v = 0; v < field.voxels.size(); ++v) {
    const bool is = t.ventricles.voxels[v] > 0, seen = field.voxels[v] > 0;
    both += is && seen, sum += int(is) + int(seen);
  }
  const bool warned = std::any_of(ventricles.warnings.begin(), ventricles.warnings.end(),
                                  [](const Warning& w) { return w.id == "blood_in_ventricles"; });
  EXPECT_EQ(warned, ventricles.result.blood_ml.has_value());
  return {2 * both / sum, ventricles.result.blood_ml.value_or(0), t.blood_ml};
}

TEST(VentriclesBlood, BelongsToThem) {
  for (const double ml : {15.0, 50.0}) {
    const Found f = found_in(phantom::Blood::intraventricular, ml, 7);
    EXPECT_NEAR(f.true_blood_ml, ml, 0.15 * ml);
    EXPECT_NEAR(f.blood_ml, f.true_blood_ml, 0.2 * f.true_blood_ml);
    EXPECT_GT(f.dice, 0.93) << ml;  // without it 0.9 and 0.6
  }
}

TEST(VentriclesBlood, OfTheBrainIsNone) {
  for (const std::int64_t seed : {7, 8}) {
    const Found f = found_in(phantom::Blood::intracerebral, 30, seed);
    EXPECT_NEAR(f.true_blood_ml, 30, 6);
    EXPECT_EQ(f.blood_ml, 0);
    EXPECT_GT(f.dice, 0.9);
  }
}

}  // namespace
}  // namespace trephine
