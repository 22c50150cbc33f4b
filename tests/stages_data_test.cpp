// SPDX-License-Identifier: GPL-3.0-or-later
// Stage data as files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "grid/nrrd.h"
#include "scratch_folder.h"
#include "stages/data_files.h"
#include "stages/stage.h"

namespace trephine {
namespace {

TEST(StageData, AVolumeIsNoFieldForContour) {
  const ScratchFolder folder;
  grid::Lattice l;
  l.size = {4, 4, 4};
  const auto kind = [&](const char* name) {
    return stages::kind_of(stages::load_field_or_volume(folder.path() / name));
  };
  grid::write_nrrd(folder.path() / "hu.nrrd", grid::HuVolume(grid::Grid<std::int16_t>(l, 40)), {{"content", "HU"}});
  grid::write_nrrd(folder.path() / "foreign.nrrd", grid::HuVolume(grid::Grid<std::int16_t>(l, 40)));
  grid::write_nrrd(folder.path() / "resampled.nrrd", grid::HuVolume(grid::Grid<float>(l, 40)), {{"content", "HU"}});
  grid::write_nrrd(folder.path() / "field.nrrd", grid::Field(l, 1), {{"content", "field"}});
  grid::write_nrrd(folder.path() / "mask.nrrd", grid::Mask(l, 1));
  for (const char* name : {"hu.nrrd", "foreign.nrrd", "resampled.nrrd"})
    EXPECT_EQ(kind(name), stages::DataKind::volume) << name;
  for (const char* name : {"field.nrrd", "mask.nrrd"}) EXPECT_EQ(kind(name), stages::DataKind::field) << name;
}

// The graph of a case finds stages by kind and by their parameters, so that it need not know names.
TEST(Stages, WhatTheGraphAsksForHasOneStage) {
  std::map<const ParameterSet*, int> with_params;
  int face_removals = 0, haptic = 0;
  for (const stages::StageType& stage : stages::stage_types()) {
    ++with_params[stage.make_params().set];
    face_removals += stage.effect == stages::StageEffect::removes_face;
    haptic += stage.output == stages::DataKind::haptic;
  }
  for (const stages::StageType* stage : stages::stages_of(stages::StagePlace::scene))
    EXPECT_EQ(with_params[stage->make_params().set], 1) << stage->name;
  EXPECT_EQ(face_removals, 1);
  EXPECT_EQ(haptic, 1);
}

TEST(Stages, APortsSourceIsOneThatItsStageCanHave) {
  for (const stages::StageType& stage : stages::stage_types())
    for (const stages::Port& port : stage.ports) {
      const std::string where = stage.name + "." + port.name;
      const bool recipe = port.from == stages::From::recipe,
                 scan = port.from == stages::From::scan || port.from == stages::From::ct;
      if (stage.place == stages::StagePlace::anatomy) {
        EXPECT_TRUE(recipe || scan) << where;
      }
      // What the scan is made of is not known before it is made.
      if (stage.place == stages::StagePlace::scan && stage.output == stages::DataKind::volume &&
          stage.effect != stages::StageEffect::removes_face) {
        EXPECT_TRUE(port.from == stages::From::import || port.from == stages::From::scan) << where;
      }
      EXPECT_EQ(port.from == stages::From::anatomies, bool(port.anatomies)) << where;
      if (port.from == stages::From::role) {
        EXPECT_NE(port.role, "") << where;
      }
      const bool is_mesh = port.from >= stages::From::role && port.from <= stages::From::felt_surfaces;
      if (is_mesh) {
        EXPECT_EQ(port.kind, stages::DataKind::mesh) << where;
      }
      EXPECT_EQ(port.kind == stages::DataKind::volume, port.from <= stages::From::published_ct) << where;
      EXPECT_EQ(port.kind == stages::DataKind::cutters, port.from == stages::From::cutters) << where;
      EXPECT_EQ(port.kind == stages::DataKind::haptic, port.from == stages::From::haptic) << where;
    }
}

// A text that stands at the wrong port says something else than the port's name.
TEST(Stages, EveryPortsHelpSaysWhatThePortIs) {
  // What stands for a name that is no word of the field.
  const std::map<std::string, std::vector<std::string>> other_words = {
      {"volume", {"CT", "MR"}},
      {"moving", {"second scan"}},
      {"within", {"inside of", "box about", "outside of it"}},
      {"without", {"outside of", "leave out", "taken for"}},
      {"given", {"a person placed"}},
      {"as_read", {"as it was read"}},
      {"map", {"labels"}},
      {"reference", {"compare with", "deviation"}}};
  const auto lower = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
  };
  for (const stages::StageType& stage : stages::stage_types()) {
    std::map<std::string, std::string> port_of;
    for (const stages::Port& port : stage.ports) {
      const std::string where = stage.name + "." + port.name;
      EXPECT_TRUE(port_of.emplace(port.help, port.name).second) << where << " has the help of " << port_of[port.help];
      const std::string name = port.name.substr(0, port.name.find(".*"));
      std::vector<std::string> words{name == "cutters" ? "cut" : name};
      if (const auto more = other_words.find(name); more != other_words.end())
        words.insert(words.end(), more->second.begin(), more->second.end());
      EXPECT_TRUE(
          std::any_of(words.begin(), words.end(),
                      [&](const std::string& word) { return lower(port.help).find(lower(word)) != std::string::npos; }))
          << where << " says: " << port.help;
    }
  }
}

TEST(Stages, EveryLandmarkThatIsLookedForHasASlice) {
  std::vector<std::string> declared, known = head::findable_landmarks();
  for (const stages::StagePoint& point : stages::stage_named("landmarks").points) declared.push_back(point.name);
  std::sort(declared.begin(), declared.end());
  std::sort(known.begin(), known.end());
  EXPECT_EQ(declared, known);
  EXPECT_EQ(stages::plane_of_landmark("bregma"), picture::SlicePlane::sagittal);
  EXPECT_EQ(stages::plane_of_landmark("monro_right"), picture::SlicePlane::axial);
  EXPECT_EQ(stages::plane_of_landmark("pedicle_2_left_entry"), picture::SlicePlane::axial);  // of a family
  EXPECT_EQ(stages::plane_of_landmark("pedicles"), picture::SlicePlane::coronal);
  EXPECT_EQ(stages::plane_of_landmark("a_point_of_the_user"), picture::SlicePlane::coronal);
}

}  // namespace
}  // namespace trephine
