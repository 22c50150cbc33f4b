// SPDX-License-Identifier: GPL-3.0-or-later
// A header and an image in two files: NIfTI, and Analyze 7.5 whose user says which side is left.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "grid/image_pair.h"
#include "grid/nifti.h"
#include "grid/nrrd_header.h"
#include "phantom/random.h"

using namespace trephine;

namespace {

template <class T>
void put(std::string& bytes, std::size_t at, T v, bool swapped) {
  char b[sizeof v];
  std::memcpy(b, &v, sizeof v);
  if (swapped) std::reverse(b, b + sizeof v);
  bytes.replace(at, sizeof v, std::string(b, sizeof v));
}
template <class T>
T get(const std::string& bytes, std::size_t at) {
  T v;
  std::memcpy(&v, bytes.data() + at, sizeof v);
  return v;
}

struct Pair {
  std::string header, image;
};

/// 5 x 4 x 3 voxels of 1, 2 and 3 mm: i + 10 j + 100 k - 50.
Pair analyze(bool swapped) {
  Pair p{std::string(348, '\0'), {}};
  put<std::int32_t>(p.header, 0, 348, swapped);
  const std::int16_t dim[] = {4, 5, 4, 3, 1};
  for (std::size_t a = 0; a < 5; ++a) put(p.header, 40 + 2 * a, dim[a], swapped);
  put<std::int16_t>(p.header, 70, 4, swapped);
  put<std::int16_t>(p.header, 72, 16, swapped);
  for (std::size_t a = 1; a <= 3; ++a) put(p.header, 76 + 4 * a, float(a), swapped);
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) {
        std::string v(2, '\0');
        put(v, 0, std::int16_t(i + 10 * j + 100 * k - 50), swapped);
        p.image += v;
      }
  return p;
}

grid::Grid<std::int16_t> read(const Pair& p, const std::string& axes, bool gzip = false) {
  grid::ImagePair joined = grid::join_image_pair(p.header, p.image, gzip, axes);
  EXPECT_EQ(joined.is_analyze, !axes.empty());
  return std::get<grid::Grid<std::int16_t>>(grid::decode_nifti(joined.nifti).grid);
}

int code_of(const Pair& p, const std::string& axes) {
  try {
    read(p, axes);
  } catch (const Error& e) {
    return int(e.code());
  }
  return 0;
}

}  // namespace

TEST(ImagePair, AnalyzeLiesAsItsUserSays) {
  // LPS world: left, back and up are positive.
  const struct {
    const char* axes;
    Vec3 i, j, k;
  } cases[] = {{"LPS", {1, 0, 0}, {0, 2, 0}, {0, 0, 3}},
               {"LAS", {1, 0, 0}, {0, -2, 0}, {0, 0, 3}},
               {"RAS", {-1, 0, 0}, {0, -2, 0}, {0, 0, 3}},
               {"PIR", {0, 1, 0}, {0, 0, -2}, {-3, 0, 0}}};
  for (const bool swapped : {false, true})
    for (const auto& c : cases) {
      grid::Grid<std::int16_t> g = read(analyze(swapped), c.axes);
      ASSERT_EQ(g.size, (std::array<int, 3>{5, 4, 3}));
      for (const auto& at : {std::array<int, 3>{0, 0, 0}, {4, 0, 0}, {1, 3, 0}, {2, 1, 2}}) {
        const Vec3 world = c.i * at[0] + c.j * at[1] + c.k * at[2], v = g.to_index(world);
        ASSERT_LT(norm(g.to_world_mm({std::round(v.x), std::round(v.y), std::round(v.z)}) - world), 1e-6) << c.axes;
        EXPECT_EQ(g.at(int(std::lround(v.x)), int(std::lround(v.y)), int(std::lround(v.z))),
                  at[0] + 10 * at[1] + 100 * at[2] - 50)
            << c.axes;
      }
    }
  Pair packed = analyze(false);
  packed.image = grid::detail::gzip_compress(packed.image);
  EXPECT_EQ(read(packed, "LAS", true).at(4, 3, 2), 4 + 30 + 200 - 50);
}

TEST(ImagePair, WhatIsNotSaidIsAskedFor) {
  for (const char* axes : {"", "L", "LAX", "LLS", "LRS", "las", "LASS"})
    EXPECT_EQ(code_of(analyze(false), axes), 64) << axes;
  const auto damaged = [](auto change) {
    Pair p = analyze(false);
    change(p);
    return code_of(p, "LAS");
  };
  EXPECT_EQ(damaged([](Pair&) {}), 0);
  EXPECT_EQ(damaged([](Pair& p) { p.image.pop_back(); }), 65);
  EXPECT_EQ(damaged([](Pair& p) { p.image += "more"; }), 65);
  EXPECT_EQ(damaged([](Pair& p) { put(p.header, 80, -1.0f, false); }), 65);
  EXPECT_EQ(damaged([](Pair& p) { p.header.replace(56, 2, "cm"); }), 65);
  EXPECT_EQ(damaged([](Pair& p) { p.header.replace(0, 4, "DICM"); }), 65);
  EXPECT_EQ(damaged([](Pair& p) { p.header.resize(300); }), 65);
  EXPECT_EQ(damaged([](Pair& p) { put<std::int16_t>(p.header, 40 + 8, 2, false); }), 65) << "two volumes";
}

TEST(ImagePair, OfNiftiSaysItsAxesItself) {
  Pair p = analyze(false);
  p.header.replace(344, 4, std::string("ni1\0", 4));
  put<std::int16_t>(p.header, 254, 1, false);
  for (std::size_t a = 0; a < 3; ++a) put(p.header, 280 + 16 * a + 4 * a, float(a + 1), false);
  put(p.header, 280 + 12, 7.0f, false);
  const grid::Grid<std::int16_t> g = read(p, "");
  const Vec3 at = g.to_world_mm({0, 0, 0});
  EXPECT_EQ(std::fabs(at.x), 7);
  EXPECT_EQ(code_of(p, "LAS"), 64);
}

// Damaged headers of Analyze: what is read has the size and steps that the header then says, and every voxel.
TEST(ImagePair, TenThousandDamagedHeaders) {
  const Pair whole = analyze(false);
  int read_count = 0, refused = 0;
  for (std::uint64_t n = 0; n < 10000; ++n) {
    Pair p = whole;
    for (std::uint64_t m = 0; m <= n % 3; ++m) {
      const auto bits = phantom::random_bits(21, 2 + m, n);
      p.header[bits % 348] = static_cast<char>(bits >> 40);
    }
    try {
      const grid::ImagePair joined = grid::join_image_pair(p.header, p.image, false, "LPS");
      const grid::AnyGrid grid = grid::decode_nifti(joined.nifti).grid;
      const grid::Lattice& l = std::visit([](const auto& g) -> const grid::Lattice& { return g; }, grid);
      ++read_count;
      const bool swapped = get<std::int32_t>(p.header, 0) != 348;
      ASSERT_FALSE(swapped) << n;
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_EQ(l.size[a], get<std::int16_t>(p.header, 42 + 2 * a)) << n;
        ASSERT_NEAR(l.spacing_mm[int(a)], double(get<float>(p.header, 80 + 4 * a)), 1e-4 * l.spacing_mm[int(a)]) << n;
        ASSERT_NEAR(std::fabs(l.direction.column[a][int(a)]), 1, 1e-6) << n;
      }
      const double slope = double(get<float>(p.header, 112)), offset = double(get<float>(p.header, 116));
      const bool says_other = get<std::int16_t>(p.header, 70) != 4 || (slope != 0 && (slope != 1 || offset != 0)) ||
                              get<float>(p.header, 108) != 0;
      for (std::size_t i = 0; i < l.count() && !says_other; ++i)
        ASSERT_EQ(std::visit([&](const auto& g) { return double(g.voxels[i]); }, grid),
                  double(get<std::int16_t>(p.image, 2 * i)))
            << n;
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ExitCode::bad_input) << n << e.what();
      ++refused;
    }
  }
  std::printf("Analyze: %d read, %d refused\n", read_count, refused);
  EXPECT_GT(read_count, 500);
  EXPECT_GT(refused, 500);
}
