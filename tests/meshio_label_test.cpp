// SPDX-License-Identifier: GPL-3.0-or-later
// Labels for 3D Slicer: priority, place, keys, and what VTK's NRRD reader makes of the file.
#include <gtest/gtest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkNrrdReader.h>

#include <filesystem>

#include "base/write_file.h"
#include "meshio/label_map.h"
#include "meshio_shapes.h"
#include "report_of.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

grid::Lattice raster(std::array<int, 3> size, Vec3 first_voxel) {
  grid::Lattice l;
  l.size = size;
  l.spacing_mm = {0.5, 0.75, 2};
  l.origin_mm = Vec3{-40, 10, 700} + Vec3{first_voxel.x * 0.5, first_voxel.y * 0.75, first_voxel.z * 2};
  return l;
}

grid::Field box(const grid::Lattice& lattice, std::array<int, 3> begin, std::array<int, 3> end) {
  grid::Field f(lattice, -1.f);
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) f.at(i, j, k) = 2.5f;
  return f;
}

struct Shapes {
  grid::Field skin = box(raster({20, 15, 10}, {0, 0, 0}), {2, 2, 2}, {18, 13, 8});
  grid::Field skull = box(raster({12, 20, 9}, {4, 3, -2}), {1, 1, 4}, {6, 8, 8});  // reaches beyond skin's lattice
  std::vector<meshio::LabelledField> list() const {
    return {{&skin, "skin", {0.87, 0.68, 0.56}}, {&skull, "skull", {0.93, 0.89, 1.0 / 3}}};
  }
};

std::int64_t count(const Report& r, const std::string& name) { return std::get<std::int64_t>(*r.find(name)); }

TEST(LabelMap, LaterFieldsWinAndOverlapIsCounted) {
  const Shapes shapes;
  Report report;
  const meshio::LabelMap map = value_of(report, meshio::make_label_map(shapes.list()));
  EXPECT_EQ(map.labels.size, (std::array<int, 3>{20, 23, 12}));
  EXPECT_EQ(map.labels.origin_mm, (Vec3{-40, 10, 696}));
  std::size_t skin = 0, skull = 0;
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 23; ++j)
      for (int i = 0; i < 20; ++i) {
        const bool in_skull = i >= 5 && i < 10 && j >= 4 && j < 11 && k >= 4 && k < 8;
        const bool in_skin = i >= 2 && i < 18 && j >= 2 && j < 13 && k >= 4 && k < 10;
        ASSERT_EQ(map.labels.at(i, j, k), in_skull ? 2 : in_skin ? 1 : 0) << i << " " << j << " " << k;
        skin += in_skin && !in_skull;
        skull += in_skull;
      }
  EXPECT_EQ(count(report, "skin.voxels_count"), std::int64_t(skin));
  EXPECT_EQ(count(report, "skull.voxels_count"), std::int64_t(skull));
  EXPECT_EQ(count(report, "overlapping_voxels_count"), 5 * 7 * 4);
  EXPECT_NEAR(std::get<double>(*report.find("skull.volume_ml")), double(skull) * 0.75 / 1000, 1e-12);
}

TEST(LabelMap, KeysAsSlicerReadsThem) {
  const Shapes shapes;
  const grid::NrrdKeys keys = meshio::make_label_map(shapes.list()).value.keys;
  const std::map<std::string, std::string> wanted = {
      {"Segmentation_MasterRepresentation", "Binary labelmap"},
      {"Segmentation_ContainedRepresentationNames", "Binary labelmap|"},
      {"Segmentation_ReferenceImageExtentOffset", "0 0 0"},
      {"Segment0_ID", "Segment_1"},
      {"Segment0_Name", "skin"},
      {"Segment0_Color", "0.87 0.68 0.56"},
      {"Segment0_LabelValue", "1"},
      {"Segment0_Layer", "0"},
      {"Segment0_Extent", "0 19 0 22 0 11"},
      {"Segment1_Name", "skull"},
      {"Segment1_Color", "0.93 0.89 0.333333"},
      {"Segment1_LabelValue", "2"},
      {"Segment1_Layer", "0"},
      {"Segment1_Extent", "0 19 0 22 0 11"},
  };
  for (const auto& [key, value] : wanted) {
    ASSERT_EQ(keys.count(key), 1u) << key;
    EXPECT_EQ(keys.at(key), value) << key;
  }
}

TEST(LabelMap, ReadBackBySecondProgram) {
  const ScratchFolder scratch;
  const Shapes shapes;
  const meshio::LabelMap map = meshio::make_label_map(shapes.list()).value;
  const std::filesystem::path file = scratch.path() / "labels.seg.nrrd";
  meshio::write_label_map(file, map);
  const grid::Nrrd back = grid::read_nrrd(file);
  EXPECT_TRUE(std::get<grid::Mask>(back.grid) == map.labels);
  EXPECT_EQ(back.keys, map.keys);
  const std::vector<char> first = read_file(file);
  meshio::write_label_map(file, map);
  EXPECT_EQ(read_file(file), first);

  vtkNew<vtkNrrdReader> reader;
  ASSERT_TRUE(reader->CanReadFile(file.c_str()));
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  int size[3];
  image->GetDimensions(size);
  ASSERT_EQ((std::array<int, 3>{size[0], size[1], size[2]}), map.labels.size);
  EXPECT_EQ(image->GetSpacing()[1], 0.75);
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i)
        ASSERT_EQ(image->GetScalarComponentAsDouble(i, j, k, 0), map.labels.at(i, j, k));
}

TEST(LabelMap, FaultsAreNamed) {
  Shapes shapes;
  std::string line;
  auto list = shapes.list();
  grid::Field covering(shapes.skin, 1.f);
  list.push_back({&covering, "all", {1, 1, 1}});
  EXPECT_EQ(code_of([&] { meshio::make_label_map(list); }, &line), ExitCode::quality);
  EXPECT_NE(line.find("skin"), std::string::npos) << line;
  shapes.skull.spacing_mm.x = 0.6;
  EXPECT_EQ(code_of([&] { meshio::make_label_map(shapes.list()); }, &line), ExitCode::bad_input);
  EXPECT_NE(line.find("skull"), std::string::npos) << line;
  EXPECT_EQ(code_of([&] { meshio::make_label_map({}); }), ExitCode::internal);
}

TEST(LabelMap, AFullDiskIsSaid) {
  const Shapes shapes;
  const meshio::LabelMap map = meshio::make_label_map(shapes.list()).value;
  EXPECT_EQ(code_of([&] { meshio::write_label_map("/dev/full", map); }), ExitCode::io);
}

}  // namespace
}  // namespace trephine
