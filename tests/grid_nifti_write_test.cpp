// SPDX-License-Identifier: GPL-3.0-or-later
// NIfTI files of ours: place and values come back by either of the two transforms, for any orientation.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.h"
#include "grid/nifti.h"

namespace trephine {
namespace {

Mat3 rotation(double a, double b, double c) {
  const auto about = [](int axis, double t) {
    Mat3 m;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (Vec3& column : m.column) column = {0, 0, 0};
    m.column[std::size_t(axis)][axis] = 1;
    m.column[std::size_t(u)][u] = m.column[std::size_t(v)][v] = std::cos(t);
    m.column[std::size_t(u)][v] = std::sin(t);
    m.column[std::size_t(v)][u] = -std::sin(t);
    return m;
  };
  const Mat3 x = about(0, a), y = about(1, b), z = about(2, c);
  Mat3 out;
  for (std::size_t i = 0; i < 3; ++i)
    out.column[i] = z * (y * (x * Vec3{i == 0 ? 1. : 0, i == 1 ? 1. : 0, i == 2 ? 1. : 0}));
  return out;
}

template <class T>
grid::Grid<T> sample(const Mat3& direction) {
  grid::Lattice l;
  l.size = {7, 5, 4};
  l.spacing_mm = {0.4881, 0.75, 3.1};
  l.origin_mm = {-121.3, 88.25, -412.6};
  l.direction = direction;
  grid::Grid<T> g(l);
  for (std::size_t i = 0; i < g.voxels.size(); ++i)
    g.voxels[i] = T(int(i * 37 % 251) - (std::is_same_v<T, std::uint8_t> ? 0 : 100));
  return g;
}

double farthest_mm(const grid::Lattice& a, const grid::Lattice& b) {
  double most = 0;
  for (int c = 0; c < 8; ++c) {
    Vec3 at;
    for (int i = 0; i < 3; ++i) at[i] = c >> i & 1 ? a.size[std::size_t(i)] - 1.0 : 0.0;
    most = std::max(most, norm(a.to_world_mm(at) - b.to_world_mm(at)));
  }
  return most;
}

/// Without the sform, so that a reader takes the quaternion.
std::string by_quaternion(std::string bytes) {
  std::memset(bytes.data() + 254, 0, 2);
  return bytes;
}

TEST(NiftiWrite, AnyOrientationComesBack) {
  std::vector<Mat3> directions;
  for (const double a : {0.0, 0.3, 3.14159265358979, 2.9})
    for (const double b : {0.0, -1.2, 3.0})
      for (const double c : {0.0, 0.7, 3.14159265358979}) {
        directions.push_back(rotation(a, b, c));
        directions.push_back(directions.back());
        directions.back().column[1] = -directions.back().column[1];  // left-handed
      }
  int with_qform = 0;
  for (const Mat3& d : directions) {
    const auto volume = sample<std::int16_t>(d);
    const std::string bytes = grid::encode_nifti(grid::HuVolume(volume), false);
    const grid::Nifti back = grid::decode_nifti(bytes);
    ASSERT_TRUE(back.warnings.empty()) << back.warnings[0];
    EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(back.grid).voxels, volume.voxels);
    EXPECT_LT(farthest_mm(std::get<grid::Grid<std::int16_t>>(back.grid), volume), 1e-4);
    const grid::Nifti other = grid::decode_nifti(by_quaternion(bytes));
    if (other.frame != "qform") continue;
    ++with_qform;
    EXPECT_LT(farthest_mm(std::get<grid::Grid<std::int16_t>>(other.grid), volume), 0.006);
  }
  EXPECT_GT(with_qform, int(directions.size()) * 3 / 4);
  // A scan along the axes has both.
  EXPECT_EQ(
      grid::decode_nifti(by_quaternion(grid::encode_nifti(grid::HuVolume(sample<std::int16_t>(Mat3())), false))).frame,
      "qform");
}

TEST(NiftiWrite, AllTypesPlainAndCompressed) {
  const auto labels = sample<std::uint8_t>(Mat3());
  for (const bool gzip : {false, true}) {
    EXPECT_EQ(std::get<grid::Mask>(grid::decode_nifti(grid::encode_nifti(labels, gzip)).grid).voxels, labels.voxels);
    auto real = sample<float>(Mat3());
    real.voxels[3] = 0.5f;
    EXPECT_EQ(std::get<grid::Field>(grid::decode_nifti(grid::encode_nifti(grid::HuVolume(real), gzip)).grid).voxels,
              real.voxels);
  }
  EXPECT_EQ(grid::encode_nifti(labels, true), grid::encode_nifti(labels, true));
  grid::Lattice l;
  l.size = {40000, 1, 1};
  EXPECT_THROW(grid::encode_nifti(grid::Mask(l), false), Error);
}

// A place that float32 cannot say comes back to the last bit, unless another program moved the volume.
TEST(NiftiWrite, PlaceToTheLastBit) {
  grid::Lattice l;
  l.size = {5, 4, 3};
  l.spacing_mm = {0.4785156, 0.4785156, 1.5};
  l.origin_mm = {-122.49999, -167.49999, 116};
  const grid::Mask mask(l, 1);
  const std::string bytes = grid::encode_nifti(mask, false);
  EXPECT_TRUE(static_cast<const grid::Lattice&>(std::get<grid::Mask>(grid::decode_nifti(bytes).grid)) == l);
  EXPECT_EQ(bytes.size() % 4, mask.count() % 4);
  std::string moved = bytes;
  const float other = 167.6f;
  std::memcpy(moved.data() + 280 + 28, &other, 4);
  EXPECT_NEAR(std::get<grid::Mask>(grid::decode_nifti(moved).grid).origin_mm.y, -167.6, 1e-5);
  // What float32 says exactly needs no extension.
  l.origin_mm = {-122.5, -167.5, 116};
  EXPECT_EQ(grid::encode_nifti(grid::Mask(l, 1), false).size(), 352 + mask.count());
}

}  // namespace
}  // namespace trephine
