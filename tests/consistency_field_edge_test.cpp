// SPDX-License-Identifier: GPL-3.0-or-later
// The anatomical gate where the scanned field cuts the head.
#include <gtest/gtest.h>

#include "consistency/anatomy_gate.h"
#include "consistency_samples.h"

namespace trephine {
namespace {

TEST(AnatomyGate, WhereTheScannedFieldEndsBoneAndSkinAreNotCompared) {
  EllipsoidHead head;
  head.make();
  // The field ends behind y = 75, in bone: a scan with noisy air before it and padding behind.
  const auto cut = [&](grid::Field& f) {
    for (int k = 0; k < f.size[2]; ++k)
      for (int j = 0; j < f.size[1]; ++j)
        for (int i = 0; i < f.size[0]; ++i)
          f.at(i, j, k) = std::min(f.at(i, j, k), float(75 - f.to_world_mm({double(i), double(j), double(k)}).y));
  };
  grid::Grid<std::int16_t> scan(head.l, std::int16_t(-1000));
  for (int k = 0; k < head.l.size[2]; ++k)
    for (int j = 0; j < head.l.size[1]; ++j)
      for (int i = 0; i < head.l.size[0]; ++i)
        if (head.l.to_world_mm({double(i), double(j), double(k)}).y < 75) {
          const double skin_mm = head.skin.at(i, j, k);
          scan.at(i, j, k) = std::int16_t(std::clamp(skin_mm * 300 - 400, -1000.0, 50.0) + (i * 7 + j * 5 + k) % 13);
        }
  cut(head.skin);
  cut(head.skull);
  cut(head.brain);
  const grid::HuVolume volume = scan;
  const auto examined = [&](const grid::HuVolume* v) {
    const auto found = consistency::examine_anatomy(head.fields(), nullptr, {}, {}, {}, v);
    return std::make_pair(found.faults.empty() ? "" : found.faults[0].what, found.warnings);
  };
  EXPECT_NE(examined(nullptr).first.find("the surfaces of skull and skin"), std::string::npos);
  const auto [fault, warnings] = examined(&volume);
  EXPECT_EQ(fault, "");
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(to_text(warnings.back()).find("the scanned field's edge cuts skull and skin"), std::string::npos)
      << to_text(warnings.back());
  // Elsewhere bone that reaches through the skin is found as ever, and placed there.
  head.skull_at = head.brain_at = head.ventricles_at = {0, -9, 0};
  head.make();
  cut(head.skin);
  cut(head.skull);
  cut(head.brain);
  EXPECT_NE(examined(&volume).first.find("ml of the skull lie outside of the skin"), std::string::npos)
      << examined(&volume).first;
}

}  // namespace
}  // namespace trephine
