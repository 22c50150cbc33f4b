// SPDX-License-Identifier: GPL-3.0-or-later
// Volume files that hold more or less than they say, grow without bound, or say what no reader may pass over.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/write_file.h"
#include "dicom/import.h"
#include "grid/bounded_read.h"
#include "grid/nifti.h"
#include "grid/nrrd_header.h"
#include "itk/volume_file.h"
#include "itk_small_ct.h"
#include "scratch_folder.h"

using namespace trephine;
namespace fs = std::filesystem;

namespace {

template <class T>
void put(std::string& bytes, std::size_t at, T v) {
  std::memcpy(bytes.data() + at, &v, sizeof v);
}

std::string nifti_bytes() { return grid::encode_nifti(grid::HuVolume(small_ct()), false); }

/// A NIfTI file of so many slices of 1024 x 1024 zeros, compressed: members of a gzip stream, each of four slices.
std::string zeros_nii_gz(int slices) {
  grid::Grid<std::int16_t> one;
  one.size = {1, 1, 1};
  one.voxels = {0};
  std::string header = grid::encode_nifti(grid::HuVolume(one), false).substr(0, 352);
  const std::int16_t dim[] = {3, 1024, 1024, std::int16_t(slices)};
  for (std::size_t a = 0; a < 4; ++a) put(header, 40 + 2 * a, dim[a]);
  put(header, 108, 352.0f);
  header[348] = 0;  // no extension
  std::string bytes = grid::detail::gzip_compress(header);
  const std::string four = grid::detail::gzip_compress(std::string(std::size_t{4} * 1024 * 1024 * 2, '\0'), 9);
  for (int k = 0; k < slices; k += 4) bytes += four;
  return bytes;
}

std::uint64_t peak_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      std::uint64_t kb = 0;
      status >> kb;
      return kb;
    }
  return 0;
}

class VolumeLimits : public testing::Test {
 protected:
  ScratchFolder folder;
  fs::path write(const std::string& name, const std::string& bytes) {
    write_file(folder.path() / name, bytes);
    return folder.path() / name;
  }
  std::string fault(const std::string& name, const std::string& bytes, itk::VolumeFile* read = nullptr) {
    try {
      itk::VolumeFile v = itk::read_volume_file(write(name, bytes));
      if (read) *read = std::move(v);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input) << e.what();
      return e.field();
    }
    return "";
  }
};

std::string meta(const std::string& more) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
         "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = -30 -41.5 12.25\nElementSpacing = 2.5 3 4\nDimSize = 24 20 18\n"
         "ElementType = MET_SHORT\n" +
         more + "ElementDataFile = LOCAL\n";
}
std::string voxels_of(const grid::Grid<std::int16_t>& g) {
  return std::string(reinterpret_cast<const char*>(g.voxels.data()), 2 * g.voxels.size());
}

}  // namespace

TEST_F(VolumeLimits, AScanOfZerosIsRefusedBeforeMemoryIsTaken) {
  const std::string zeros = zeros_nii_gz(1000);  // 2 GB of 2 MB
  ASSERT_LT(zeros.size(), 3u << 20);
  const fs::path file = write("zeros.nii.gz", zeros);
  const std::uint64_t before = peak_kb();
  ASSERT_GT(before, 0u);
  try {
    itk::read_volume_file(file);
    FAIL() << "2 GB of zeros are no scan";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.field(), "data");
  }
  EXPECT_LT(peak_kb() - before, 64u << 10);
  const std::string head =
      "NRRD0004\ntype: short\ndimension: 3\nspace: LPS\nsizes: 1024 1024 1000\nspace directions: (1,0,0) (0,1,0) "
      "(0,0,1)\nendian: little\nencoding: gzip\nspace origin: (0,0,0)\n\n";
  EXPECT_EQ(fault("zeros.nrrd", head + zeros), "data");
  std::string packed = meta("");
  packed.replace(packed.find("CompressedData = False"), 22, "CompressedData = True");
  packed.replace(packed.find("24 20 18"), 8, "1024 1024 1000");
  EXPECT_EQ(fault("zeros.mha", packed + zeros), "data");
  EXPECT_LT(peak_kb() - before, 64u << 10);
}

TEST_F(VolumeLimits, WhatIsReadIsReadInAChild) {
  // A parser that takes the memory of 200 million voxels for itself leaves none of it in the caller: labels may be of
  // that size, and are refused here only because one voxel is negative.
  std::string header = nifti_bytes().substr(0, 352);
  const std::int16_t dim[] = {3, 1000, 1000, 200};
  for (std::size_t a = 0; a < 4; ++a) put(header, 40 + 2 * a, dim[a]);
  put(header, 108, 352.0f);
  put(header, 70, std::int16_t{4});
  put(header, 72, std::int16_t{16});
  header[348] = 0;
  std::string bytes = grid::detail::gzip_compress(header);
  const std::string part = grid::detail::gzip_compress(std::string(std::size_t{20} * 1000 * 1000 * 2, '\0'), 9);
  for (int k = 0; k < 180; k += 20) bytes += part;
  std::string last(std::size_t{20} * 1000 * 1000 * 2, '\0');
  put(last, last.size() - 2, std::int16_t{-1});
  bytes += grid::detail::gzip_compress(last);
  const fs::path file = write("labels.nii.gz", bytes);
  const std::uint64_t before = peak_kb();
  EXPECT_THROW(grid::read_labels(file), Error);
  EXPECT_LT(peak_kb() - before, 64u << 10);
}

TEST_F(VolumeLimits, AFileHoldsWhatItsHeaderSaysAndNoMore) {
  const std::string good = nifti_bytes();
  EXPECT_EQ(fault("a.nii", good), "");
  EXPECT_EQ(fault("a.nii", good + "x"), "data");
  EXPECT_EQ(fault("a.nii", good.substr(0, good.size() - 1)), "dim");
  const std::string packed = grid::detail::gzip_compress(good);
  EXPECT_EQ(fault("a.nii.gz", packed), "");
  EXPECT_EQ(fault("a.nii.gz", grid::detail::gzip_compress(good + "x")), "data");
  EXPECT_EQ(fault("a.nii.gz", packed + "x"), "data");
  EXPECT_EQ(fault("a.nii.gz", packed + grid::detail::gzip_compress("more")), "data");
  EXPECT_EQ(fault("a.nii.gz", packed.substr(0, packed.size() - 3)), "data");  // of its checksum
  std::string wrong = packed;
  wrong[wrong.size() - 6] = char(wrong[wrong.size() - 6] ^ 1);
  EXPECT_EQ(fault("a.nii.gz", wrong), "data");
}

TEST_F(VolumeLimits, NoVoxelIsShifted) {
  // The extender of four bytes stands between header and voxels, so 352 is the first place.
  std::string bytes = nifti_bytes();
  float offset = 0;
  std::memcpy(&offset, bytes.data() + 108, 4);
  const std::string data = bytes.substr(std::size_t(offset));
  for (int at = 0; at <= 360; ++at) {
    std::string file = bytes.substr(0, 348) + std::string(4, '\0') + data;
    put(file, 108, float(at));
    EXPECT_EQ(fault("o.nii", file), at == 352 ? "" : at < 352 ? "vox_offset" : "dim") << at;
  }
}

TEST_F(VolumeLimits, KeysOfAMetaImageThatChangeItAreNotPassedOver) {
  const std::string data = voxels_of(small_ct());
  const struct {
    const char *line, *field;
  } lines[] = {{"", ""},
               {"ElementToIntensityFunctionSlope = 1\nElementToIntensityFunctionOffset = 0\n", ""},
               {"ElementToIntensityFunctionSlope = 2\n", "ElementToIntensityFunctionSlope"},
               {"ElementToIntensityFunctionOffset = -1024\n", "ElementToIntensityFunctionOffset"},
               {"DistanceUnits = mm\n", ""},
               {"DistanceUnits = um\n", "DistanceUnits"},
               {"DistanceUnits = cm\n", "DistanceUnits"},
               {"ElementByteOrderMSB = False\n", ""},
               {"ElementByteOrderMSB = True\n", "ElementByteOrderMSB"},
               {"CenterOfRotation = 0 0 0\n", ""},
               {"CenterOfRotation = 1 2 3\n", "CenterOfRotation"},
               {"Modality = MET_MOD_CT\n", ""},
               {"Modality = MET_MOD_WHAT\n", "Modality"},
               {"HeaderSize = 4\n", "HeaderSize"},
               {"Comment = a scan\nName = of somebody\n", ""}};
  for (const auto& l : lines) {
    itk::VolumeFile read;
    EXPECT_EQ(fault("m.mha", meta(l.line) + data, &read), l.field) << l.line;
    EXPECT_TRUE(read.warnings.empty()) << l.line;
  }
  itk::VolumeFile read;
  EXPECT_EQ(fault("m.mha", meta("IntensitySlope = 2\nJohn Doe 1950 = 3\n") + data, &read), "");
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_NE(read.warnings[0].find("IntensitySlope"), std::string::npos) << read.warnings[0];
  EXPECT_EQ(read.warnings[0].find("1950"), std::string::npos) << "a key may be a name";
}

TEST_F(VolumeLimits, AnMrIsNotTakenForHu) {
  dicom::ImportParams p;
  p.volume_values = dicom::VolumeValues::hu;
  const std::string data = voxels_of(small_ct());
  const auto field = [&](const std::string& modality) {
    try {
      dicom::import_series(write("x.mha", meta(modality) + data), p);
    } catch (const Error& e) {
      return e.field();
    }
    return std::string();
  };
  EXPECT_EQ(field(""), "");
  EXPECT_EQ(field("Modality = MET_MOD_CT\n"), "");
  EXPECT_EQ(field("Modality = MET_MOD_MR\n"), "Modality");
  p.volume_values = dicom::VolumeValues::any;
  EXPECT_EQ(field("Modality = MET_MOD_MR\n"), "");
}

TEST_F(VolumeLimits, AVolumeLiesWhereAPatientCan) {
  const std::string data = voxels_of(small_ct());
  std::string far = meta("");
  far.replace(far.find("-30 -41.5"), 3, "1e30");
  EXPECT_EQ(fault("f.mha", far + data), "origin");
  const std::string nrrd =
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 24 20 18\nspace directions: "
      "(2.5,0,0) (0,3,0) (0,0,4)\nendian: little\nencoding: raw\n";
  EXPECT_EQ(fault("f.nrrd", nrrd + "space origin: (-30,-41.5,12.25)\n\n" + data), "");
  EXPECT_EQ(fault("f.nrrd", nrrd + "space origin: (1e30,-41.5,12.25)\n\n" + data), "space origin");
  std::string nifti = nifti_bytes();
  put(nifti, 292, 1e30f);
  EXPECT_EQ(fault("f.nii", nifti), "sform");
  itk::VolumeFile read;
  EXPECT_EQ(fault("f.nrrd", nrrd + "intensity: 3\nspace origin: (-30,-41.5,12.25)\n\n" + data, &read), "");
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_NE(read.warnings[0].find("intensity"), std::string::npos);
}
