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
  Lattice l;
  l.size = {4, 4, 4};
  const auto kind = [&](const char* name) { return kind_of(load_field_or_volume(folder.path() / name)); };
  write_nrrd(folder.path() / "hu.nrrd", HuVolume(Grid<std::int16_t>(l, 40)), {{"content", "HU"}});
  write_nrrd(folder.path() / "foreign.nrrd", HuVolume(Grid<std::int16_t>(l, 40)));
  write_nrrd(folder.path() / "resampled.nrrd", HuVolume(Grid<float>(l, 40)), {{"content", "HU"}});
  write_nrrd(folder.path() / "field.nrrd", Field(l, 1), {{"content", "field"}});
  write_nrrd(folder.path() / "mask.nrrd", Mask(l, 1));
  for (const char* name : {"hu.nrrd", "foreign.nrrd", "resampled.nrrd"})
    EXPECT_EQ(kind(name), DataKind::volume) << name;
  for (const char* name : {"field.nrrd", "mask.nrrd"}) EXPECT_EQ(kind(name), DataKind::field) << name;
}

// The graph of a case finds stages by kind and by their parameters, so that it need not know names.
TEST(Stages, WhatTheGraphAsksForHasOneStage) {
  std::map<const ParameterSet*, int> with_params;
  int face_removals = 0, haptic = 0;
  for (const StageType& stage : stage_types()) {
    ++with_params[stage.make_params().set];
    face_removals += stage.removes_face;
    haptic += stage.output == DataKind::haptic;
  }
  for (const StageType* stage : stages_of(StagePlace::scene))
    EXPECT_EQ(with_params[stage->make_params().set], 1) << stage->name;
  EXPECT_EQ(face_removals, 1);
  EXPECT_EQ(haptic, 1);
}

TEST(Stages, APortsSourceIsOneThatItsStageCanHave) {
  for (const StageType& stage : stage_types())
    for (const Port& port : stage.ports) {
      const std::string where = stage.name + "." + port.name;
      const bool recipe = port.from == From::recipe, scan = port.from == From::scan || port.from == From::ct;
      if (stage.place == StagePlace::anatomy) {
        EXPECT_TRUE(recipe || scan) << where;
      }
      // What the scan is made of is not known before it is made.
      if (stage.place == StagePlace::scan && stage.output == DataKind::volume && !stage.removes_face) {
        EXPECT_TRUE(port.from == From::import || port.from == From::scan) << where;
      }
      EXPECT_EQ(port.from == From::anatomies, bool(port.anatomies)) << where;
      if (port.from == From::role) {
        EXPECT_NE(port.role, "") << where;
      }
      const bool is_mesh = port.from >= From::role && port.from <= From::felt_surfaces;
      if (is_mesh) {
        EXPECT_EQ(port.kind, DataKind::mesh) << where;
      }
      EXPECT_EQ(port.kind == DataKind::volume, port.from <= From::published_ct) << where;
      EXPECT_EQ(port.kind == DataKind::cutters, port.from == From::cutters) << where;
      EXPECT_EQ(port.kind == DataKind::haptic, port.from == From::haptic) << where;
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
      {"map", {"labels"}},
      {"reference", {"compare with", "deviation"}}};
  const auto lower = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
  };
  for (const StageType& stage : stage_types()) {
    std::map<std::string, std::string> port_of;
    for (const Port& port : stage.ports) {
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
  std::vector<std::string> declared, known = findable_landmarks();
  for (const StagePoint& point : stage_named("landmarks").points) declared.push_back(point.name);
  std::sort(declared.begin(), declared.end());
  std::sort(known.begin(), known.end());
  EXPECT_EQ(declared, known);
  EXPECT_EQ(plane_of_landmark("bregma"), SlicePlane::sagittal);
  EXPECT_EQ(plane_of_landmark("monro_right"), SlicePlane::axial);
  EXPECT_EQ(plane_of_landmark("pedicle_2_left_entry"), SlicePlane::axial);  // of a family
  EXPECT_EQ(plane_of_landmark("pedicles"), SlicePlane::coronal);
  EXPECT_EQ(plane_of_landmark("a_point_of_the_user"), SlicePlane::coronal);
}

}  // namespace
}  // namespace trephine
