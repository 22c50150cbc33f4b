// SPDX-License-Identifier: GPL-3.0-or-later
// Which volume a path and a name mean: nothing else than what the user chose is read.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <functional>

#include "base/error.h"
#include "base/write_file.h"
#include "dicom/import.h"
#include "dicom/volume_source.h"
#include "grid/nrrd.h"
#include "itk/slicer_scene.h"
#include "itk/volume_file.h"
#include "itk/volume_write.h"
#include "library/series_state.h"
#include "scratch_folder.h"
#include "zip_writer.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

grid::Grid<std::int16_t> counted(int size, std::int16_t first = 0) {
  grid::Lattice l;
  l.size = {size, 6, 7};
  grid::Grid<std::int16_t> g(l);
  for (std::size_t i = 0; i < g.voxels.size(); ++i) g.voxels[i] = static_cast<std::int16_t>(first + int(i));
  return g;
}

dicom::ImportParams any_values(const std::string& series = "") {
  dicom::ImportParams p;
  p.volume_values = dicom::VolumeValues::any;
  p.series = series;
  return p;
}

Error fault(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  return Error(ExitCode::ok, "", "", "no error");
}

std::string scene_of(const std::string& file) {
  return "<MRML version=\"Slicer4.4.0\">\n<Volume id=\"v1\" references=\"storage:s1;\"></Volume>\n"
         "<VolumeArchetypeStorage id=\"s1\" fileName=\"" +
         file + "\"></VolumeArchetypeStorage>\n</MRML>\n";
}

}  // namespace

TEST(VolumeSource, ATokenWithAnotherSizeIsNotTheVolume) {
  const ScratchFolder folder;
  grid::write_nrrd(folder.path() / "a.nrrd", grid::HuVolume(counted(5)));
  grid::write_nrrd(folder.path() / "b.nrrd", grid::HuVolume(counted(8)));
  EXPECT_EQ(
      std::get<grid::Grid<std::int16_t>>(dicom::import_series(folder.path(), any_values("s2-8x6x7")).volume).size[0],
      8);
  grid::write_nrrd(folder.path() / "aa.nrrd", grid::HuVolume(counted(4)));  // comes before what was s2
  const Error e = fault([&] { dicom::import_series(folder.path(), any_values("s2-8x6x7")); });
  EXPECT_EQ(e.code(), ExitCode::usage);
  EXPECT_EQ(e.field(), "series");
  EXPECT_NE(std::string(e.what()).find("s2-4x6x7"), std::string::npos) << e.what();
}

TEST(VolumeSource, AFaultInAnArchiveNamesTheArchive) {
  const ScratchFolder folder;
  grid::write_nrrd(folder.path() / "a.nrrd", grid::HuVolume(counted(5)));
  const std::vector<char> whole = read_file(folder.path() / "a.nrrd");
  const fs::path scene = folder.path() / "s.mrb";
  write_file(scene, synthetic::zip_bytes(
                        {{"s/s.mrml", scene_of("a.nrrd")}, {"s/a.nrrd", std::string(whole.begin(), whole.end() - 9)}}));
  const Error e = fault([&] { dicom::import_series(scene, any_values()); });
  EXPECT_EQ(e.code(), ExitCode::bad_input);
  EXPECT_EQ(e.file().rfind("scan (", 0), 0u) << e.file();  // never by its name (docs/explanation/privacy.md)
}

TEST(VolumeSource, DicomOfAnyNameIsNoVolumeFile) {
  const ScratchFolder folder;
  const char element[] = {8, 0, 5, 0, 'C', 'S', 2, 0, 'I', 'R'};  // as DICOM without a preamble begins
  for (const char* name : {"1.img", "2.img"}) write_file(folder.path() / name, {element, sizeof element});
  EXPECT_TRUE(itk::find_volume_files(folder.path()).empty());
}

TEST(VolumeSource, EndingsAreTheSameInCapitals) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> volume = counted(5);
  for (const char* name : {"q.NRRD", "q.NII.GZ", "q.MHA"}) {
    itk::write_volume_file(folder.path() / name, volume);
    std::string format;
    EXPECT_EQ(
        std::get<grid::Grid<std::int16_t>>(itk::read_grid_file(folder.path() / name, &format, nullptr, {})).voxels,
        volume.voxels)
        << name;
  }
}

TEST(VolumeSource, AScenesFileIsNoLinkOutOfItsFolder) {
  const ScratchFolder folder;
  fs::create_directories(folder.path() / "scene");
  grid::write_nrrd(folder.path() / "secret.nrrd", grid::HuVolume(counted(5)));
  fs::create_symlink("../secret.nrrd", folder.path() / "scene/a.nrrd");
  const fs::path scene = folder.path() / "scene/s.mrml";
  write_file(scene, scene_of("a.nrrd"));
  EXPECT_NE(std::string(fault([&] { dicom::import_series(scene, any_values()); }).what()).find("link out"),
            std::string::npos);
  fs::remove(folder.path() / "scene/a.nrrd");
  grid::write_nrrd(folder.path() / "scene/b.nrrd", grid::HuVolume(counted(5)));
  fs::create_symlink("b.nrrd", folder.path() / "scene/a.nrrd");  // within it
  EXPECT_EQ(dicom::import_series(scene, any_values()).report().warnings.size(), 0u);
}

TEST(VolumeSource, ASceneOfManyAttributesIsRefused) {
  std::string node = "<MRML><Volume ";
  for (int n = 0; n < 2000; ++n) node += "a" + std::to_string(n) + "=\"1\" ";
  EXPECT_NE(std::string(fault([&] { itk::scene_volumes(node + "></Volume></MRML>"); }).what()).find("attributes"),
            std::string::npos);
}

// A library's memory of series sees what lies beside a header or a scene, too.
TEST(VolumeSource, AMemoryOfSeriesSeesFilesBesideThem) {
  const ScratchFolder folder;
  const fs::path header = folder.path() / "x.nhdr", scene = folder.path() / "s.mrml";
  write_file(header,
             "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 5 6 7\nencoding: raw\n"
             "endian: little\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\ndata file: x.raw\n");
  write_file(scene, scene_of("x.nhdr"));
  const auto write_data = [&](std::int16_t first) {
    const grid::Grid<std::int16_t> g = counted(5, first);
    write_file(folder.path() / "x.raw", {reinterpret_cast<const char*>(g.voxels.data()), g.voxels.size() * 2});
  };
  write_data(0);
  library::SeriesMemory memory(folder.path() / "memory.json");
  for (const fs::path& path : {header, scene}) {
    EXPECT_FALSE(dicom::files_beside(path).empty());
    write_data(0);
    const std::string before = memory.content_of(path, any_values(), false, {}).sha256;
    write_data(1);
    EXPECT_NE(memory.content_of(path, any_values(), false, {}).sha256, before) << path;
  }
}

// HDF5 follows links into other files, reads voxels from other files, and takes voxels that were never written for
// zeros.
TEST(VolumeSource, AnHdf5FileReadsNoOtherFile) {
  const ScratchFolder folder;
  const fs::path file = folder.path() / "m.mnc", other = folder.path() / "other.mnc";
  itk::write_volume_file(other, counted(5));
  write_file(folder.path() / "secret.bin", std::string(1000, 's'));
  const char* image = "/minc-2.0/image/0/image";
  enum { link, external, unwritten };
  for (const int way : {link, external, unwritten}) {
    itk::write_volume_file(file, counted(5));
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(itk::read_volume_file(file).volume).voxels, counted(5).voxels);
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);  // closes what is open in it, too
    const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDWR, access);
    const hid_t old = H5Dopen2(f, image, H5P_DEFAULT);
    const hid_t space = H5Dget_space(old), type = H5Dget_type(old), plain = H5Pcreate(H5P_DATASET_CREATE);
    ASSERT_GE(H5Ldelete(f, image, H5P_DEFAULT), 0);
    if (way == link) {
      ASSERT_GE(H5Lcreate_external(other.c_str(), image, f, image, H5P_DEFAULT, H5P_DEFAULT), 0);
    } else {
      if (way == external)
        ASSERT_GE(H5Pset_external(plain, (folder.path() / "secret.bin").c_str(), 0, 5 * 6 * 7 * 2), 0);
      const hid_t fresh = H5Dcreate2(f, image, type, space, H5P_DEFAULT, plain, H5P_DEFAULT);
      ASSERT_GE(fresh, 0);
      for (const char* name : {"dimorder", "valid_range"}) {
        const hid_t from = H5Aopen(old, name, H5P_DEFAULT);
        const hid_t kind = H5Aget_type(from), extent = H5Aget_space(from);
        char bytes[256] = {};
        ASSERT_LE(H5Tget_size(kind) * std::size_t(H5Sget_simple_extent_npoints(extent)), sizeof bytes);
        ASSERT_GE(H5Aread(from, kind, bytes), 0);
        ASSERT_GE(H5Awrite(H5Acreate2(fresh, name, kind, extent, H5P_DEFAULT, H5P_DEFAULT), kind, bytes), 0);
      }
    }
    H5Fclose(f);
    const Error e = fault([&] { itk::read_volume_file(file); });
    EXPECT_EQ(e.code(), ExitCode::bad_input) << way;
    EXPECT_NE(std::string(e.what()).find(way == unwritten ? "lacks its voxels" : "another file"), std::string::npos)
        << way << ": " << e.field() << ": " << e.what();
  }
}
