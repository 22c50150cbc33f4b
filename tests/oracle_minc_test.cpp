// SPDX-License-Identifier: GPL-3.0-or-later
// MINC 2: what libminc and ITK wrote, read by us; what we wrote, read by ITK.
#include <gtest/gtest.h>
#include <itkMINCImageIO.h>
#include <minc2.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/write_file.h"
#include "itk/volume_file.h"
#include "itk/volume_write.h"
#include "oracle_image_io.h"
#include "scratch_folder.h"

using namespace trephine;

namespace {

grid::Grid<std::int16_t> oblique() {
  grid::Lattice l;
  l.size = {9, 7, 5};
  l.spacing_mm = {1.5, 2, 3};
  l.origin_mm = {-20.25, 14.5, 33};
  const double c = 0.8, s = 0.6;
  l.direction = {{Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}};
  grid::Grid<std::int16_t> g(l);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 7; ++j)
      for (int i = 0; i < 9; ++i) g.at(i, j, k) = static_cast<std::int16_t>(100 * k - 300 + 10 * j + i);
  return g;
}

// A volume of libminc in the order z, y, x, with a scale for each slice, whose x runs backwards: real values 0.5 i + 10
// j + 100 k with i along the file's x.
void write_by_libminc(const std::string& file) {
  const std::array<misize_t, 3> size{4, 5, 6};
  const std::array<double, 3> start{-8, 12, 30}, step{3, 2, -1.5};
  const double cosines[3][3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  const char* names[3] = {"zspace", "yspace", "xspace"};
  midimhandle_t axes[3];
  for (std::size_t a = 0; a < 3; ++a) {
    ASSERT_EQ(micreate_dimension(names[a], MI_DIMCLASS_SPATIAL, MI_DIMATTR_REGULARLY_SAMPLED, size[a], &axes[a]),
              MI_NOERROR);
    miset_dimension_start(axes[a], start[a]);
    miset_dimension_separation(axes[a], step[a]);
    miset_dimension_cosines(axes[a], cosines[a]);
  }
  mihandle_t volume;
  ASSERT_EQ(micreate_volume(file.c_str(), 3, axes, MI_TYPE_SHORT, MI_CLASS_REAL, nullptr, &volume), MI_NOERROR);
  miset_slice_scaling_flag(volume, 1);
  ASSERT_EQ(micreate_volume_image(volume), MI_NOERROR);
  miset_volume_valid_range(volume, 32000, -32000);
  for (misize_t k = 0; k < size[0]; ++k) {
    const std::array<misize_t, 3> from{k, 0, 0}, count{1, size[1], size[2]};
    ASSERT_EQ(miset_slice_range(volume, from.data(), 3, 100.0 * double(k) + 64, 100.0 * double(k) - 64), MI_NOERROR);
    std::array<double, 30> slice{};
    for (std::size_t n = 0; n < slice.size(); ++n)
      slice[n] = 0.5 * double(n % 6) + 10 * double(n / 6) + 100 * double(k);
    ASSERT_EQ(miset_real_value_hyperslab(volume, MI_TYPE_DOUBLE, from.data(), count.data(), slice.data()), MI_NOERROR);
  }
  ASSERT_EQ(miclose_volume(volume), MI_NOERROR);
}

std::vector<char> bytes_of(const std::filesystem::path& file) { return read_file(file); }

}  // namespace

TEST(OracleMinc, ItkReadsOursWhereItLies) {
  const ScratchFolder folder;
  const auto file = folder.path() / "own.mnc";
  const grid::Grid<std::int16_t> g = oblique();
  trephine::itk::write_volume_file(file, g);
  expect_itk_reads<::itk::MINCImageIO>(file, g, 1e-6, true);  // ITK 5.2 hands MINC's RAS over
}

TEST(OracleMinc, OursReadsWhatLibmincScaledSliceBySlice) {
  const ScratchFolder folder;
  const auto file = folder.path() / "other.mnc";
  write_by_libminc(file.string());
  const trephine::itk::VolumeFile read = trephine::itk::read_volume_file(file);
  EXPECT_EQ(read.format, "MINC");
  const grid::Lattice& l = grid::lattice_of(read.volume);
  ASSERT_EQ(l.size, (std::array<int, 3>{6, 5, 4}));
  // Of the file's voxel (i, j, k): world x = 30 - 1.5 i, y = 12 + 2 j, z = -8 + 3 k in RAS.
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 6; ++i) {
        const Vec3 lps{-(30 - 1.5 * i), -(12 + 2.0 * j), -8 + 3.0 * k};
        const Vec3 v = l.to_index(lps);
        const int a = static_cast<int>(std::lround(v.x)), b = static_cast<int>(std::lround(v.y)),
                  c = static_cast<int>(std::lround(v.z));
        ASSERT_TRUE(l.contains(a, b, c));
        ASSERT_LT(norm(l.to_world_mm({double(a), double(b), double(c)}) - lps), 1e-9);
        const double value = std::visit([&](const auto& g) { return double(g.at(a, b, c)); }, read.volume);
        ASSERT_NEAR(value, 0.5 * i + 10 * j + 100 * k, 64.0 / 32000) << i << " " << j << " " << k;
      }
}

TEST(OracleMinc, NeitherUserNorDateIsWrittenAndBytesAreTheSame) {
  const ScratchFolder folder;
  const grid::AnyGrid grid = oblique();
  trephine::itk::write_volume_file(folder.path() / "a.mnc", grid);
  trephine::itk::write_volume_file(folder.path() / "b.mnc", grid);
  const auto a = bytes_of(folder.path() / "a.mnc"), b = bytes_of(folder.path() / "b.mnc");
  EXPECT_EQ(a, b);
  const std::string text(a.begin(), a.end());
  for (const char* word : {"history", "ident", "root"}) EXPECT_EQ(text.find(word), std::string::npos) << word;
  // A whole second later too.
  timespec second{1, 100000000};
  nanosleep(&second, nullptr);
  trephine::itk::write_volume_file(folder.path() / "b.mnc", grid);
  EXPECT_EQ(bytes_of(folder.path() / "b.mnc"), a);
}

TEST(OracleMinc, OfAllSampleTypes) {
  const ScratchFolder folder;
  const grid::Grid<std::int16_t> g = oblique();
  grid::Grid<float> f(static_cast<const grid::Lattice&>(g));
  grid::Mask m(static_cast<const grid::Lattice&>(g));
  for (std::size_t n = 0; n < g.voxels.size(); ++n) {
    f.voxels[n] = 0.37f * static_cast<float>(g.voxels[n]);
    m.voxels[n] = static_cast<std::uint8_t>(n % 200);
  }
  const auto file = folder.path() / "f.mnc";
  for (const grid::AnyGrid& grid : {grid::AnyGrid(g), grid::AnyGrid(f), grid::AnyGrid(m)})
    EXPECT_NO_THROW(trephine::itk::write_volume_file(file, grid));
}
