// SPDX-License-Identifier: GPL-3.0-or-later
// What makes a material sound.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "cases/material.h"

namespace trephine {
namespace {

CaseMaterial bone() {
  MaterialFaceParams face;
  face.stiffness_n_per_mm = 1;
  face.damping_n_s_per_mm = 0.0003;
  face.static_friction_ratio = 0.35;
  face.dynamic_friction_ratio = 0.3;
  face.pop_through_n = 2;
  MaterialParams body;
  body.removal_energy_j_per_mm3 = 0.1;
  return make_material("bone", body, face, face);
}

TEST(Material, OfTheDeclaredParametersIsSound) {
  EXPECT_EQ(fault_of(bone()), "");
  EXPECT_EQ(bone().front.pop_through_n, 2);
  EXPECT_EQ(bone().removal_energy_j_per_mm3, 0.1);
}

TEST(Material, FaultsNameFaceAndValue) {
  const auto fault = [](const std::function<void(CaseMaterial&)>& spoil) {
    CaseMaterial m = bone();
    spoil(m);
    return fault_of(m);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_NE(fault([&](CaseMaterial& m) { m.front.stiffness_n_per_mm = nan; }).find("front.stiffness_n_per_mm"),
            std::string::npos);
  EXPECT_NE(fault([&](CaseMaterial& m) { m.back.damping_n_s_per_mm = inf; }).find("back.damping_n_s_per_mm"),
            std::string::npos);
  EXPECT_EQ(fault([](CaseMaterial& m) { m.drag_n_s_per_mm = -1; }), "drag_n_s_per_mm: -1, must be from 0 to 1");
  EXPECT_EQ(fault([&](CaseMaterial& m) { m.colour_rgb[1] = 1.5; }), "colour_rgb: 1.5, must be from 0 to 1");
  EXPECT_EQ(fault([](CaseMaterial& m) { m.front.dynamic_friction_ratio = 0.5; }),
            "front.dynamic_friction_ratio: 0.5, at most static_friction_ratio, 0.35");
  EXPECT_EQ(fault([](CaseMaterial& m) { m.back.stiffness_n_per_mm = 0; }),
            "back.stiffness_n_per_mm: 0, must be more where the face is touchable");
  EXPECT_EQ(fault([](CaseMaterial& m) { m.front.stiffness_n_per_mm = 0.05; }),
            "front.pop_through_n: 2 N are met 40 mm deep, at most 30 mm");
  EXPECT_EQ(fault([](CaseMaterial& m) {
              m.back = {};
              m.back.touchable = false;
            }),
            "");
}

}  // namespace
}  // namespace trephine
