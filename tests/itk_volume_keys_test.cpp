// SPDX-License-Identifier: GPL-3.0-or-later
// VTK images, GIPL and MINC: each key is read, refused, ignored because it changes nothing, or told as unknown.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "base/error.h"
#include "base/write_file.h"
#include "grid/nrrd_header.h"
#include "itk/volume_file.h"
#include "itk/volume_write.h"
#include "itk_small_ct.h"
#include "scratch_folder.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

class VolumeKeys : public testing::Test {
 protected:
  ScratchFolder folder;
  grid::Grid<std::int16_t> ct = small_ct(false);

  std::string written(const std::string& name) {
    itk::write_volume_file(folder.path() / name, ct);
    const std::vector<char> bytes = read_file(folder.path() / name);
    return {bytes.begin(), bytes.end()};
  }
  /// A VTK image of `ct` whose header has plain numbers (ITK writes all digits).
  std::string vtk() const {
    std::string bytes =
        "# vtk DataFile Version 3.0\nvolume\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 24 20 18\nSPACING 2.5 3 4\n"
        "ORIGIN -30 -41.5 12.25\nPOINT_DATA 8640\nSCALARS s short 1\nLOOKUP_TABLE default\n";
    for (const std::int16_t v : ct.voxels) bytes += {char(v >> 8), char(v & 255)};
    return bytes;
  }
  /// "" where the file was read, with the voxels and the place of `ct`; else the field of the refusal.
  std::string fault(const std::string& name, const std::string& bytes) {
    write_file(folder.path() / name, bytes);
    return fault(folder.path() / name);
  }
  std::string fault(const fs::path& file) {
    warnings.clear();
    try {
      itk::VolumeFile read = itk::read_volume_file(file);
      warnings = read.warnings;
      EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(read.volume).voxels, ct.voxels) << file;
      EXPECT_LT(norm(grid::lattice_of(read.volume).origin_mm - ct.origin_mm), 1e-6) << file;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << e.what();
      return e.field();
    }
    return "";
  }
  bool told(const std::string& key) const {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&](const std::string& w) { return w.find("not known") != w.npos && w.find(key) != w.npos; });
  }
  std::vector<std::string> warnings;
};

std::string exchanged(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

template <class T>
std::string put(std::string bytes, std::size_t at, T v) {
  for (std::size_t n = 0; n < sizeof v; ++n) bytes[at + n] = reinterpret_cast<const char*>(&v)[sizeof v - 1 - n];
  return bytes;
}

}  // namespace

TEST_F(VolumeKeys, OfAVtkImage) {
  const std::string good = vtk();
  EXPECT_EQ(fault("own.vtk", written("own.vtk")), "");
  ASSERT_EQ(fault("v.vtk", good), "");
  EXPECT_EQ(warnings.size(), 1u) << "that it does not say where its axes point";
  const struct {
    const char *from, *to, *field;
  } lines[] = {{"SPACING 2.5 3 4\n", "", "spacing"},
               {"ORIGIN -30 -41.5 12.25\n", "", "origin"},
               {"SPACING 2.5 3 4\n", "SPACING 2.5 3\n", "SPACING"},
               {"SPACING 2.5 3 4\n", "ASPECT_RATIO 2.5 3 4\n", ""},
               {"SPACING 2.5 3 4\n", "SPACING 2.5 3 4\nSPACING 1 1 1\n", "SPACING"},
               {"SPACING 2.5 3 4\n", "SPACING 2.5 3 4\nDIRECTION 0 1 0 1 0 0 0 0 1\n", "DIRECTION"},
               {"SPACING 2.5 3 4\n", "SPACING 2.5 3 4\nvoxel_spacing 1 1 1\n", "voxel_spacing"},
               {"POINT_DATA 8640", "CELL_DATA 8640", "CELL_DATA"},
               {"POINT_DATA 8640", "POINT_DATA 8641", "POINT_DATA"},
               {"DIMENSIONS 24 20 18", "DIMENSIONS 24 20 17", "POINT_DATA"},
               {"short 1\n", "short 2\n", "SCALARS"},
               {"short 1\n", "long 1\n", "SCALARS"},
               {"short 1\n", "short\n", ""},
               {"LOOKUP_TABLE default\n", "", "LOOKUP_TABLE"},
               {"STRUCTURED_POINTS", "RECTILINEAR_GRID", "DATASET"},
               {"STRUCTURED_POINTS", "STRUCTURED_POINTS_OF_MINE", "DATASET"},
               {"BINARY", "BINARY_NOT", "header"}};
  for (const auto& l : lines) EXPECT_EQ(fault("x.vtk", exchanged(good, l.from, l.to)), l.field) << l.to;
  EXPECT_EQ(fault("x.vtk", exchanged(good, "SPACING", "WINDOW_LEVEL 40 400\nJohn Doe 1950\nSPACING")), "");
  EXPECT_TRUE(told("WINDOW_LEVEL"));
  EXPECT_TRUE(told("John"));
  EXPECT_FALSE(told("1950"));
  EXPECT_EQ(fault("x.vtk", good + "x"), "data");
  EXPECT_EQ(fault("x.vtk", good + "\n"), "") << "VTK ends an array with an empty line";
  EXPECT_EQ(fault("x.vtk", good + "\nMETADATA\nINFORMATION 0\n\n"), "");
  EXPECT_EQ(fault("x.vtk", good + "\nMETADATA\nINFORMATION 0\n\nSCALARS b short\n"), "data");
  EXPECT_EQ(fault("x.vtk", good + "\nVECTORS v float\n"), "data");
  EXPECT_EQ(fault("x.vtk", good.substr(0, good.size() - 1)), "data");
}

TEST_F(VolumeKeys, OfAVtkImageAsText) {
  const std::string good = vtk();
  std::string head = exchanged(good.substr(0, good.find("LOOKUP_TABLE default\n") + 21), "BINARY", "ASCII");
  for (const std::int16_t v : ct.voxels) head += std::to_string(v) + " ";
  EXPECT_EQ(fault("t.vtk", head), "");
  EXPECT_EQ(fault("t.vtk", head + "7"), "data");
  EXPECT_EQ(fault("t.vtk", head.substr(0, head.size() - 6)), "data");
  EXPECT_EQ(fault("t.vtk", exchanged(head, "LOOKUP_TABLE default\n", "LOOKUP_TABLE default\nnan ")), "data");
}

TEST_F(VolumeKeys, OfAGiplFile) {
  const std::string good = written("v.gipl");
  ASSERT_EQ(fault("v.gipl", good), "");
  EXPECT_EQ(warnings.size(), 1u) << "that it does not say where its axes point";
  EXPECT_EQ(fault("x.gipl", put(good, 106 + 16, 1.0f)), "matrix");
  EXPECT_EQ(fault("x.gipl", put(good, 236, -1024.0f)), "pixval_offset");
  EXPECT_EQ(fault("x.gipl", put(good, 240, 2.0f)), "pixval_cal");
  EXPECT_EQ(fault("x.gipl", put(good, 240, 1.0f)), "");
  EXPECT_EQ(fault("x.gipl", put(good, 244, 0.5f)), "interslice_gap");
  for (int orientation = 0; orientation < 256; ++orientation) {
    const bool is_axial = orientation == 0 || orientation == 1 || orientation == 8 || orientation == 9;
    if (orientation > 13 && orientation % 40 != 0) continue;
    EXPECT_EQ(fault("x.gipl", put(good, 186, char(orientation))), is_axial ? "" : "orientation") << orientation;
  }
  EXPECT_EQ(fault("x.gipl", put(good, 6, std::uint16_t(2))), "dim");
  EXPECT_EQ(fault("x.gipl", put(good, 2, std::uint16_t(0))), "dim");
  EXPECT_EQ(fault("x.gipl", put(good, 8, std::uint16_t(144))), "image_type");
  EXPECT_EQ(fault("x.gipl", put(good, 10, -2.5f)), "pixdim");
  EXPECT_EQ(fault("x.gipl", put(good, 204, std::nan(""))), "origin");
  EXPECT_EQ(fault("x.gipl", put(good, 252, 0u)), "magic_number");
  // Of the patient and of the display.
  EXPECT_EQ(fault("x.gipl", put(put(put(good, 188, 5.0), 196, 6.0), 30, std::uint32_t(0x41424344))), "");
  EXPECT_EQ(fault("x.gipl", good + "x"), "data");
  EXPECT_EQ(fault("x.gipl", good.substr(0, good.size() - 1)), "data");
}

TEST_F(VolumeKeys, OfACompressedGiplFile) {
  const std::string good = written("v.gipl"), packed = grid::detail::gzip_compress(good);
  EXPECT_EQ(fault("x.gipl.gz", packed), "");
  EXPECT_EQ(fault("x.gipl.gz", grid::detail::gzip_compress(good + "x")), "data");
  EXPECT_EQ(fault("x.gipl.gz", packed.substr(0, packed.size() - 3)), "data") << "of its checksum";
  EXPECT_EQ(fault("x.gipl.gz", put(packed, packed.size() - 6, char(packed[packed.size() - 6] ^ 1))), "data");
  EXPECT_EQ(fault("x.gipl.gz", grid::detail::gzip_compress(put(good, 236, 1.0f))), "pixval_offset");
  EXPECT_EQ(fault("x.gipl.gz", packed + "x"), "data");
  EXPECT_EQ(fault("x.gipl.gz", packed + packed), "data");
  std::string zeros =
      put(put(put(good.substr(0, 256), 0, std::uint16_t(1024)), 2, std::uint16_t(1024)), 4, std::uint16_t(1000));
  zeros += std::string(std::size_t{8} << 20, '\0');
  EXPECT_EQ(fault("x.gipl.gz", grid::detail::gzip_compress(zeros, 9)), "data") << "2 GB of some kB";
}

TEST_F(VolumeKeys, OfAMincFile) {
  const std::string axis = "/minc-2.0/dimensions/xspace", image = "/minc-2.0/image/0/image";
  const auto changed = [&](const std::function<void(hid_t)>& change) {
    const fs::path file = folder.path() / "m.mnc";
    itk::write_volume_file(file, ct);
    const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change(f);
    H5Fclose(f);
    return fault(file);
  };
  const auto text = [](hid_t file, const std::string& object, const char* name, const std::string& value) {
    if (H5Aexists_by_name(file, object.c_str(), name, H5P_DEFAULT) > 0)
      H5Adelete_by_name(file, object.c_str(), name, H5P_DEFAULT);
    const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, value.size() + 1);
    const hid_t a = H5Acreate_by_name(file, object.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(a, type, value.c_str()), 0);
    for (const auto& [id, close] : {std::pair{a, H5Aclose}, {type, H5Tclose}, {space, H5Sclose}}) close(id);
  };
  EXPECT_EQ(changed([](hid_t) {}), "");
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(changed([&](hid_t f) { text(f, axis, "alignment", "start_"); }), "alignment");
  EXPECT_EQ(changed([&](hid_t f) { text(f, axis, "alignment", "centre"); }), "");
  EXPECT_EQ(changed([&](hid_t f) { text(f, image, "complete", "false"); }), "complete");
  EXPECT_EQ(changed([&](hid_t f) {
              text(f, axis, "skew", "0.3");
              text(f, image, "intensity_slope", "2");
              text(f, "/minc-2.0/image/0/image-max", "gamma", "2.2");
              H5Gclose(H5Gcreate2(f, "/minc-2.0/dimensions/time", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
              H5Gclose(H5Gcreate2(f, "/minc-2.0/John 1950", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
              text(f, "/minc-2.0", "history", "of somebody");
            }),
            "");
  for (const char* key : {"skew", "intensity_slope", "gamma", "time", "?"}) EXPECT_TRUE(told(key)) << key;
  EXPECT_FALSE(told("John"));
  EXPECT_FALSE(told("history"));
}
