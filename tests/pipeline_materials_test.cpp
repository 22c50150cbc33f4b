// SPDX-License-Identifier: GPL-3.0-or-later
// The materials that come with the program.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cases/material.h"
#include "config/declared.h"
#include "config/scene_file.h"

namespace trephine {
namespace {

std::vector<CaseMaterial> shipped() {
  ConfigFaults faults;
  const std::filesystem::path file = std::string(TREPHINE_SOURCE_DIR) + "/configs/materials.yaml";
  MaterialsFileParams said;
  read_declared({file, faults, {}, {}}, read_yaml(file), parameters_of<MaterialsFileParams>(), &said);
  faults.raise();
  std::vector<CaseMaterial> all;
  for (const auto& [name, material] : said.materials) {
    CaseMaterial& one = all.emplace_back();
    static_cast<MaterialParams&>(one) = material;
    one.name = name;
  }
  return all;
}

TEST(Materials, AllAreSoundAndWithinADesktopDevicesReach) {
  std::set<std::string> names;
  for (CaseMaterial m : shipped()) {
    names.insert(m.name);
    EXPECT_EQ(fault_of(parameters_of<CaseMaterial>(), &m), "") << m.name;
    for (const CaseFace& f : {m.front, m.back}) {
      EXPECT_LE(f.stiffness_n_per_mm, 1) << m.name;
      EXPECT_LE(f.pop_through_n, 3) << m.name;
      // Passive at 1 kHz on a device with 0.0008 N s/mm of damping of its own: K < 2 (b - B) / T.
      EXPECT_LE(f.stiffness_n_per_mm, 2 * (0.0008 - f.damping_n_s_per_mm) / 0.001) << m.name;
    }
  }
  EXPECT_EQ(names, (std::set<std::string>{"artery", "bone", "brain", "csf", "disc", "dura", "lung", "pleura", "skin",
                                          "soft_tissue", "vein"}));
}

TEST(Materials, TheyDifferAsTissuesDo) {
  const auto all = shipped();
  const auto of = [&](const char* name) {
    return *std::find_if(all.begin(), all.end(), [&](const CaseMaterial& m) { return m.name == name; });
  };
  const char* softer_first[] = {"brain", "csf", "soft_tissue", "vein", "skin", "disc", "bone"};
  for (int i = 0; i + 1 < 7; ++i)
    EXPECT_LT(of(softer_first[i]).front.stiffness_n_per_mm, of(softer_first[i + 1]).front.stiffness_n_per_mm);
  EXPECT_EQ(of("bone").front.pop_through_n, 0);
  EXPECT_GT(of("csf").front.pop_through_n, of("brain").front.pop_through_n);
  for (const CaseMaterial& m : all) EXPECT_EQ(m.removal_energy_j_per_mm3 > 0, m.name == "bone" || m.name == "disc");
}

}  // namespace
}  // namespace trephine
