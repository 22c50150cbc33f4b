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

std::vector<cases::CaseMaterial> shipped() {
  config::ConfigFaults faults;
  const std::filesystem::path file = std::string(TREPHINE_SOURCE_DIR) + "/configs/materials.yaml";
  config::MaterialsFileParams said;
  config::read_declared({file, faults, {}, {}}, config::read_yaml(file), parameters_of<config::MaterialsFileParams>(),
                        &said);
  faults.raise();
  std::vector<cases::CaseMaterial> all;
  for (const auto& [name, material] : said.materials) {
    cases::CaseMaterial& one = all.emplace_back();
    static_cast<cases::MaterialParams&>(one) = material;
    one.name = name;
  }
  return all;
}

TEST(Materials, AllAreSoundAndWithinADesktopDevicesReach) {
  std::set<std::string> names;
  for (cases::CaseMaterial m : shipped()) {
    names.insert(m.name);
    EXPECT_EQ(fault_of(parameters_of<cases::CaseMaterial>(), &m), "") << m.name;
    for (const cases::CaseFace& f : {m.front, m.back}) {
      EXPECT_LE(f.stiffness_n_per_mm, 1) << m.name;
      EXPECT_LE(f.pop_through_n, 3) << m.name;
      // Passive at 1 kHz on a device with 0.0008 N s/mm of damping of its own: K < 2 (b - B) / T.
      EXPECT_LE(f.stiffness_n_per_mm, 2 * (0.0008 - f.damping_n_s_per_mm) / 0.001) << m.name;
    }
  }
  EXPECT_EQ(names, (std::set<std::string>{"artery", "bone", "brain", "csf", "disc", "dura", "lung", "metal", "pleura",
                                          "skin", "soft_tissue", "vein"}));
}

TEST(Materials, TheyDifferAsTissuesDo) {
  const auto all = shipped();
  const auto of = [&](const char* name) {
    return *std::find_if(all.begin(), all.end(), [&](const cases::CaseMaterial& m) { return m.name == name; });
  };
  const char* softer_first[] = {"brain", "csf", "soft_tissue", "vein", "skin", "disc", "bone"};
  for (int i = 0; i + 1 < 7; ++i)
    EXPECT_LT(of(softer_first[i]).front.stiffness_n_per_mm, of(softer_first[i + 1]).front.stiffness_n_per_mm);
  EXPECT_EQ(of("bone").front.pop_through_n, 0);
  EXPECT_GT(of("csf").front.pop_through_n, of("brain").front.pop_through_n);
  for (const cases::CaseMaterial& m : all)
    EXPECT_EQ(m.removal_energy_j_per_mm3 > 0, m.name == "bone" || m.name == "disc");
}

}  // namespace
}  // namespace trephine
