// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/write_file.h"
#include "grid/nrrd.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

class NrrdTest : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return folder_ / name; }
  std::string bytes(const fs::path& f) const {
    const auto b = read_file(f);
    return std::string(b.begin(), b.end());
  }
  fs::path put(const std::string& text) const {
    std::ofstream(file("put.nrrd"), std::ios::binary) << text;
    return file("put.nrrd");
  }
  // The field that a refusal names, with its code.
  std::string refusal(const fs::path& f) const {
    try {
      grid::read_nrrd(f);
    } catch (const Error& e) {
      EXPECT_EQ(e.file(), f.string());
      return std::to_string(int(e.code())) + " " + e.field();
    }
    return "read";
  }
  ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

std::string header(const std::string& replaced = "", const std::string& by = "") {
  std::string h =
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 2\n"
      "space directions: (1,0,0) (0,1,0) (0,0,2)\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
      "space origin: (1,2,3)\n\n";
  if (!replaced.empty()) {
    const auto at = h.find(replaced);
    EXPECT_NE(at, std::string::npos);
    h.replace(at, replaced.size(), by);
  }
  return h;
}
const std::string eight_bytes("\1\0\2\0\3\0\xff\xff", 8);

grid::Lattice oblique(double hand) {
  grid::Lattice l;
  l.size = {5, 4, 3};
  l.spacing_mm = {0.1 + 0.2, 1 / 3.0, 1.2499999999999998};
  l.origin_mm = {-0.1, 1e-17, 123456.789012345678};
  const double a = 0.7, b = 1.1;
  l.direction.column[0] = {std::cos(a), std::sin(a), 0};
  l.direction.column[1] = {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  l.direction.column[2] = cross(l.direction.column[0], l.direction.column[1]) * hand;
  return l;
}

TEST_F(NrrdTest, RoundTripIsExactToTheBit) {
  for (const double hand : {1.0, -1.0}) {
    const grid::Lattice l = oblique(hand);
    grid::Grid<std::int16_t> hu(l);
    grid::Grid<float> real(l);
    grid::Mask mask(l);
    for (std::size_t i = 0; i < l.count(); ++i) {
      hu.voxels[i] = static_cast<std::int16_t>(i * 1111 - 32768);
      real.voxels[i] = std::sqrt(float(i)) - 3;
      mask.voxels[i] = i % 3;
    }
    for (const auto encoding : {grid::NrrdEncoding::raw, grid::NrrdEncoding::gzip}) {
      grid::write_nrrd(file("hu.nrrd"), grid::HuVolume(hu), {{"modality", "CT"}, {"two\\lines", "a\nb\\n"}}, encoding);
      grid::write_nrrd(file("real.nrrd"), grid::HuVolume(real), {}, encoding);
      grid::write_nrrd(file("mask.nrrd"), mask, {}, encoding);
      const grid::Nrrd back = grid::read_nrrd(file("hu.nrrd"));
      const auto& g = std::get<grid::Grid<std::int16_t>>(back.grid);
      EXPECT_TRUE(static_cast<const grid::Lattice&>(g) == l);
      EXPECT_EQ(g.voxels, hu.voxels);
      EXPECT_EQ(back.keys, (grid::NrrdKeys{{"modality", "CT"}, {"two\\lines", "a\nb\\n"}}));
      const auto field = grid::read_field_nrrd(file("real.nrrd"));
      EXPECT_TRUE(static_cast<const grid::Lattice&>(field) == l);
      EXPECT_EQ(field.voxels, real.voxels);
      EXPECT_EQ(grid::read_mask_nrrd(file("mask.nrrd")).voxels, mask.voxels);
    }
  }
}

TEST_F(NrrdTest, AnAxisAlignedHeaderHoldsOnlyWhatTheFormatNeeds) {
  grid::Grid<std::int16_t> g(oblique(1));
  g.direction = Mat3();
  g.direction.column[1] = {0, -1, 0};
  grid::write_nrrd(file("a.nrrd"), grid::HuVolume(g));
  const std::string text = bytes(file("a.nrrd"));
  EXPECT_EQ(text.substr(0, text.find("\n\n")),
            "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 5 4 3\n"
            "space directions: (0.30000000000000004,0,0) (0,-0.3333333333333333,0) (0,0,1.2499999999999998)\n"
            "kinds: domain domain domain\nendian: little\nencoding: raw\n"
            "space origin: (-0.1,1e-17,123456.78901234567)");
  EXPECT_EQ(text.find(":="), std::string::npos);
  EXPECT_TRUE(grid::lattice_of(grid::read_hu_nrrd(file("a.nrrd"))) == static_cast<const grid::Lattice&>(g));
}

TEST_F(NrrdTest, GzipIsTheSameWhateverTheThreadsAndReadsInParts) {
  grid::Lattice l;
  l.size = {300, 200, 150};  // three chunks of the parallel compressor
  grid::Mask m(l);
  for (std::size_t i = 0; i < m.voxels.size(); ++i) m.voxels[i] = (i * 2654435761u >> 20) % 7 == 0;
  set_thread_count(1);
  grid::write_nrrd(file("one.nrrd"), m);
  set_thread_count(2);
  grid::write_nrrd(file("two.nrrd"), m);
  EXPECT_EQ(bytes(file("one.nrrd")), bytes(file("two.nrrd")));
  EXPECT_EQ(grid::read_mask_nrrd(file("two.nrrd")).voxels, m.voxels);
  // Nothing in the gzip header: no name, no time.
  const std::string text = bytes(file("one.nrrd"));
  EXPECT_EQ(text.substr(text.find("\n\n") + 2, 10), std::string("\x1f\x8b\x08\0\0\0\0\0\x04\x03", 10));
}

TEST_F(NrrdTest, RasIsConverted) {
  const auto g = grid::read_hu_nrrd(put(header("left-posterior-superior", "RAS") + eight_bytes));
  const grid::Lattice& l = grid::lattice_of(g);
  EXPECT_EQ(l.origin_mm, (Vec3{-1, -2, 3}));
  EXPECT_EQ(l.direction.column[0], (Vec3{-1, 0, 0}));
  EXPECT_EQ(l.direction.column[1], (Vec3{0, -1, 0}));
  EXPECT_EQ(l.direction.column[2], (Vec3{0, 0, 1}));
  EXPECT_EQ(l.spacing_mm, (Vec3{1, 1, 2}));
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(g).voxels, (std::vector<std::int16_t>{1, 2, 3, -1}));
}

TEST_F(NrrdTest, OtherTypesAreConvertedWhereExact) {
  const auto type_of = [&](const std::string& type, const std::string& data) {
    return grid::read_nrrd(put(header("type: short", "type: " + type) + data)).grid;
  };
  EXPECT_EQ(
      std::get<grid::Grid<std::int16_t>>(type_of("unsigned short", std::string("\1\0\2\0\3\0\xff\x7f", 8))).voxels[3],
      32767);
  EXPECT_EQ(std::get<grid::Grid<float>>(type_of("uint16", eight_bytes)).voxels[3], 65535.f);
  const std::int32_t whole[4] = {-32768, 0, 32767, -1}, large[4] = {-32769, 0, 1, 2};
  EXPECT_EQ(
      std::get<grid::Grid<std::int16_t>>(type_of("int", {reinterpret_cast<const char*>(whole), sizeof whole})).voxels,
      (std::vector<std::int16_t>{-32768, 0, 32767, -1}));
  EXPECT_EQ(std::get<grid::Grid<float>>(type_of("int", {reinterpret_cast<const char*>(large), sizeof large})).voxels[0],
            -32769.f);
  const double values[4] = {0.5, -1, 3, 1e300};
  const std::string doubles(reinterpret_cast<const char*>(values), sizeof values);
  EXPECT_EQ(refusal(put(header("type: short", "type: double") + doubles)), "65 data");
  std::string swapped = eight_bytes;
  for (int i = 0; i < 8; i += 2) std::swap(swapped[i], swapped[i + 1]);
  EXPECT_EQ(
      std::get<grid::Grid<std::int16_t>>(grid::read_nrrd(put(header("endian: little", "endian: big") + swapped)).grid)
          .voxels,
      (std::vector<std::int16_t>{1, 2, 3, -1}));
  EXPECT_EQ(refusal(put(header("type: short", "type: block") + eight_bytes)), "65 type");
}

TEST_F(NrrdTest, MaskAsFieldAndHu) {
  grid::Lattice l;
  l.size = {2, 1, 1};
  grid::Mask m(l);
  m.voxels = {0, 3};
  grid::write_nrrd(file("m.nrrd"), m);
  EXPECT_EQ(grid::read_field_nrrd(file("m.nrrd")).voxels, (std::vector<float>{-0.5f, 0.5f}));
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(grid::read_hu_nrrd(file("m.nrrd"))).voxels,
            (std::vector<std::int16_t>{0, 3}));
  grid::Grid<float> f(l);
  f.voxels = {1, 2.5f};
  grid::write_nrrd(file("f.nrrd"), grid::HuVolume(f));
  EXPECT_THROW(grid::read_mask_nrrd(file("f.nrrd")), Error);
  f.voxels = {1, 256};
  grid::write_nrrd(file("f.nrrd"), grid::HuVolume(f));
  EXPECT_THROW(grid::read_mask_nrrd(file("f.nrrd")), Error);
  f.voxels = {1, 255};
  grid::write_nrrd(file("f.nrrd"), grid::HuVolume(f));
  EXPECT_EQ(grid::read_mask_nrrd(file("f.nrrd")).voxels, (std::vector<std::uint8_t>{1, 255}));
}

TEST_F(NrrdTest, HostileHeadersAreRefusedByField) {
  const auto with = [&](const char* a, const std::string& b) { return refusal(put(header(a, b) + eight_bytes)); };
  EXPECT_EQ(refusal(put(header() + eight_bytes)), "read");
  EXPECT_EQ(refusal(file("missing.nrrd")), "66 ");
  EXPECT_EQ(refusal(folder_), "66 ");
  EXPECT_EQ(refusal(put("")), "65 header");
  EXPECT_EQ(refusal(put("hello")), "65 header");
  EXPECT_EQ(refusal(put("NRRD0004\ntype: short\n")), "65 header");
  EXPECT_EQ(refusal(put("NRRD0009" + header().substr(8) + eight_bytes)), "65 header");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 2147483647 2147483647 2147483647"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 65535 65535 200"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 2 1 3"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 2 1 1"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 2 0 2"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 2 -1 2"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 4 1"), "65 sizes");
  EXPECT_EQ(with("sizes: 2 1 2", "sizes: 99999999999999999999 1 1"), "65 sizes");
  EXPECT_EQ(with("dimension: 3", "dimension: 4"), "65 dimension");
  EXPECT_EQ(with("(1,0,0)", "(0,0,0)"), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "(nan,0,0)"), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "(1,0,inf)"), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "(1,0.01,0)"), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "none"), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "(1,0)"), "65 space directions");
  EXPECT_EQ(with("(1,0,0) ", ""), "65 space directions");
  EXPECT_EQ(with("(1,0,0)", "((1,0,0)"), "65 space directions");
  EXPECT_EQ(with("space origin: (1,2,3)", "space origin: (1,2,x)"), "65 space origin");
  EXPECT_EQ(with("space origin: (1,2,3)\n", ""), "65 space origin");
  EXPECT_EQ(with("left-posterior-superior", "scanner-xyz"), "65 space");
  EXPECT_EQ(with("encoding: raw", "encoding: hex"), "65 encoding");
  EXPECT_EQ(with("encoding: raw", "encoding: raw\ndata file: other.raw"), "65 data file");
  EXPECT_EQ(with("encoding: raw", "encoding: raw\nbyte skip: -1"), "65 byte skip");
  EXPECT_EQ(with("encoding: raw", "encoding: raw\nencoding: raw"), "65 encoding");
  EXPECT_EQ(with("encoding: raw", "encoding: gzip"), "65 data");
}

TEST_F(NrrdTest, HostileGzipTakesNoMemory) {
  grid::Lattice l;
  l.size = {1000, 100, 1};
  grid::write_nrrd(file("z.nrrd"), grid::Mask(l));
  std::string text = bytes(file("z.nrrd"));
  const auto resized = [&](const std::string& sizes) {
    std::string t = text;
    t.replace(t.find("sizes: 1000 100 1"), 17, "sizes: " + sizes);
    return refusal(put(t));
  };
  EXPECT_EQ(resized("1000 100 1"), "read");
  EXPECT_EQ(resized("1000 1000 1000"), "65 sizes");  // more than deflate can gain
  EXPECT_EQ(resized("1000 101 1"), "65 data");
  EXPECT_EQ(resized("1000 99 1"), "65 data");
}

TEST_F(NrrdTest, EveryTruncationAndFlippedGzipByteIsRefused) {
  grid::Grid<std::int16_t> g(oblique(1), 7);
  for (const auto encoding : {grid::NrrdEncoding::raw, grid::NrrdEncoding::gzip}) {
    grid::write_nrrd(file("t.nrrd"), grid::HuVolume(g), {}, encoding);
    const std::string text = bytes(file("t.nrrd"));
    for (std::size_t n = 0; n < text.size(); ++n) EXPECT_EQ(refusal(put(text.substr(0, n))).substr(0, 2), "65") << n;
    EXPECT_EQ(refusal(put(text + "x")).substr(0, 2), "65");
    std::size_t refused = 0;
    const std::size_t first = text.find("\n\n") + 12;
    if (encoding == grid::NrrdEncoding::gzip) {
      for (std::size_t n = first; n < text.size(); ++n) {
        std::string damaged = text;
        damaged[n] = static_cast<char>(damaged[n] ^ 0x10);
        const fs::path f = put(damaged);
        try {
          // Bits that pad the last block to a byte carry nothing.
          EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(grid::read_hu_nrrd(f)).voxels, g.voxels) << n;
        } catch (const Error& e) {
          EXPECT_EQ(e.code(), ExitCode::bad_input);
          ++refused;
        }
      }
      EXPECT_GE(refused + 2, text.size() - first);
    }
  }
}

TEST_F(NrrdTest, NotFiniteIsRefused) {
  grid::Lattice l;
  l.size = {2, 2, 2};
  grid::Grid<float> g(l, 1.f);
  g.voxels[5] = std::numeric_limits<float>::quiet_NaN();
  grid::write_nrrd(file("nan.nrrd"), grid::HuVolume(g));
  EXPECT_EQ(refusal(file("nan.nrrd")), "65 data");
  g.voxels[5] = std::numeric_limits<float>::infinity();
  grid::write_nrrd(file("nan.nrrd"), grid::HuVolume(g));
  EXPECT_EQ(refusal(file("nan.nrrd")), "65 data");
}

TEST_F(NrrdTest, SlightlySkewAxesAreStraightened) {
  const auto g =
      grid::read_hu_nrrd(put(header("(1,0,0) (0,1,0) (0,0,2)", "(1,0,0) (0.00002,1,0) (0,0,-2)") + eight_bytes));
  const Mat3& d = grid::lattice_of(g).direction;
  EXPECT_NEAR(dot(d.column[0], d.column[1]), 0, 1e-15);
  EXPECT_NEAR(determinant(d), -1, 1e-12);
}

TEST_F(NrrdTest, KeysThatNoLongerAgreeAreIgnored) {
  grid::write_nrrd(file("o.nrrd"), grid::HuVolume(grid::Grid<std::int16_t>(oblique(1))));
  std::string text = bytes(file("o.nrrd"));
  ASSERT_NE(text.find("trephine-spacing:="), std::string::npos);
  // Another program moved the volume and kept the keys.
  const auto at = text.find("space directions:"), end = text.find('\n', at);
  text.replace(at, end - at, "space directions: (2,0,0) (0,2,0) (0,0,2)");
  const grid::Nrrd back = grid::read_nrrd(put(text));
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(back.grid).spacing_mm, (Vec3{2, 2, 2}));
  EXPECT_TRUE(back.keys.empty());
}

TEST_F(NrrdTest, HundredMegabytesAreQuick) {
  grid::Lattice l;
  l.size = {512, 512, 192};
  // Of the processor: a busy machine is no fault.
  const auto seconds_since = [](std::clock_t t) { return double(std::clock() - t) / CLOCKS_PER_SEC; };
  const grid::HuVolume v(grid::Grid<std::int16_t>(l, 40));
  std::clock_t start = std::clock();
  grid::write_nrrd(file("big.nrrd"), v);
  RecordProperty("write_s", std::to_string(seconds_since(start)));
  start = std::clock();
  const auto back = grid::read_hu_nrrd(file("big.nrrd"));
  const double read_s = seconds_since(start);
  RecordProperty("read_s", std::to_string(read_s));
  EXPECT_LT(read_s, 20);
  EXPECT_EQ(std::get<grid::Grid<std::int16_t>>(back).voxels.back(), 40);
}

}  // namespace
}  // namespace trephine
