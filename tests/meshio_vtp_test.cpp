// SPDX-License-Identifier: GPL-3.0-or-later
// The interchange file: bit-exact round trips, world positions for other programs, damage refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.h"
#include "base/hash.h"
#include "base/pi.h"
#include "base/write_file.h"
#include "meshio/vtp.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

class Vtp : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_ / name; }
  std::string bytes(const fs::path& p) const {
    std::ifstream in(p, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& name, const std::string& s) const {  // without write_file's fsync, for many files
    std::ofstream(path(name), std::ios::binary) << s;
  }
  ScratchFolder scratch_;
  const fs::path folder_ = scratch_.path();
};

// A closed surface with coordinates that use all 53 bits.
surface::TriMesh wavy_sphere(int nu, int nv, Vec3 origin, bool with_normals) {
  surface::TriMesh m;
  m.origin_mm = origin;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i < (j == 0 || j == nv ? 1 : nu); ++i) {
      const double a = 2 * pi * i / nu, b = pi * j / nv, r = 80 + 3 * std::sin(9 * a) * std::sin(11 * b);
      const Vec3 n{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)};
      m.points_mm.push_back(n * r);
      if (with_normals) m.normals.push_back(n);
    }
  const auto at = [&](int j, int i) -> std::uint32_t {
    return j == 0 ? 0u : j == nv ? std::uint32_t(1 + (nv - 1) * nu) : std::uint32_t(1 + (j - 1) * nu + i % nu);
  };
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      if (j > 0) m.triangles.push_back({at(j, i), at(j + 1, i), at(j, i + 1)});
      if (j + 1 < nv) m.triangles.push_back({at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)});
    }
  return m;
}

template <class Array>
bool same_bytes(const Array& a, const Array& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

void expect_identical(const surface::TriMesh& a, const surface::TriMesh& b) {
  EXPECT_EQ(std::memcmp(&a.origin_mm, &b.origin_mm, sizeof(Vec3)), 0);
  EXPECT_TRUE(same_bytes(a.points_mm, b.points_mm));
  EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
  EXPECT_TRUE(same_bytes(a.normals, b.normals));
}

ExitCode code_of_reading(const fs::path& p) {
  try {
    meshio::read_vtp(p);
  } catch (const Error& e) {
    EXPECT_EQ(e.file(), p.string());
    return e.code();
  }
  return ExitCode::ok;
}

TEST_F(Vtp, RoundTripIsExactToTheBit) {
  for (const Vec3 origin : {Vec3{}, Vec3{0.1, -93.7, 1.0 / 3}, Vec3{1e6, -1e6, 123456.789}, Vec3{-0.0, 0, 1e9}})
    for (const bool normals : {false, true}) {
      const surface::TriMesh m = wavy_sphere(40, 21, origin, normals);
      meshio::write_vtp(path("a.vtp"), m);
      expect_identical(m, meshio::read_vtp(path("a.vtp")));
    }
}

TEST_F(Vtp, AwkwardNumbersSurvive) {
  surface::TriMesh m;
  m.points_mm = {{-0.0, 5e-324, 1e-310}, {1e300, -1e-300, std::nextafter(1.0, 2.0)}, {0.1, 0.2, 0.3}};
  m.triangles = {{0, 1, 2}};
  meshio::write_vtp(path("a.vtp"), m);
  expect_identical(m, meshio::read_vtp(path("a.vtp")));
}

TEST_F(Vtp, EmptyMeshSurvives) {
  surface::TriMesh m;
  m.origin_mm = {1, 2, 3};
  meshio::write_vtp(path("a.vtp"), m);
  expect_identical(m, meshio::read_vtp(path("a.vtp")));
}

TEST_F(Vtp, SameMeshSameBytes) {
  const surface::TriMesh m = wavy_sphere(30, 15, {1, 2, 3}, true);
  meshio::write_vtp(path("a.vtp"), m);
  meshio::write_vtp(path("b.vtp"), m);
  EXPECT_EQ(bytes(path("a.vtp")), bytes(path("b.vtp")));
}

TEST_F(Vtp, OtherProgramsSeeWorldPositions) {
  // What another reader takes from the file: the Points array, found through its declared offset.
  const surface::TriMesh m = wavy_sphere(8, 5, {100, 200.5, -300.1}, false);
  meshio::write_vtp(path("a.vtp"), m);
  const std::string s = bytes(path("a.vtp"));
  EXPECT_NE(s.find("LPS"), std::string::npos);
  const std::size_t entry = s.find("Name=\"Points\"");
  ASSERT_NE(entry, std::string::npos);
  const std::size_t offset_at = s.find("offset=\"", entry) + 8;
  const std::size_t data = s.find('_', s.find("<AppendedData")) + 1 + std::stoul(s.substr(offset_at));
  std::uint64_t size = 0;
  std::memcpy(&size, s.data() + data, 8);
  ASSERT_EQ(size, m.points_mm.size() * 24);
  for (std::size_t i = 0; i < m.points_mm.size(); ++i) {
    Vec3 p;
    std::memcpy(&p, s.data() + data + 8 + 24 * i, 24);
    EXPECT_EQ(p, m.world_mm(i));
  }
}

TEST_F(Vtp, ForeignAsciiFileIsRead) {
  const auto file = [](const std::string& field, const std::string& polys) {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
           "byte_order=\"LittleEndian\"><PolyData>" +
           field +
           "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\"><Points><DataArray type=\"Float32\" "
           "NumberOfComponents=\"3\" "
           "format=\"ascii\">0 0 0 1 0 0 0 2 0 0 0 3</DataArray></Points><Polys>" +
           polys + "</Polys></Piece></PolyData></VTKFile>";
  };
  const std::string good =
      "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 0 2 3</DataArray>"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3 6</DataArray>";
  write_file(path("a.vtp"), file("", good));
  surface::TriMesh m = meshio::read_vtp(path("a.vtp"));
  ASSERT_EQ(m.points_mm.size(), 4u);
  ASSERT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.points_mm[2], (Vec3{0, 2, 0}));
  EXPECT_EQ(m.triangles[1][2], 3u);

  write_file(path("ras.vtp"), file("<FieldData><DataArray type=\"String\" Name=\"SPACE\" NumberOfTuples=\"1\" "
                                   "format=\"ascii\">82 65 83 0</DataArray></FieldData>",
                                   good));
  m = meshio::read_vtp(path("ras.vtp"));
  EXPECT_EQ(m.points_mm[2], (Vec3{0, -2, 0}));
  EXPECT_EQ(m.points_mm[3], (Vec3{0, 0, 3}));

  const auto with_text = [&](const std::string& name, const std::string& text) {
    std::string codes;
    for (const char c : text) codes += std::to_string(int(c)) + " ";
    write_file(path("field.vtp"),
               file("<FieldData><DataArray type=\"String\" Name=\"" + name +
                        "\" NumberOfTuples=\"1\" format=\"ascii\">" + codes + "0</DataArray></FieldData>",
                    good));
    return path("field.vtp");
  };
  EXPECT_EQ(meshio::read_vtp(with_text("UNIT", "mm")).points_mm[2], (Vec3{0, 2, 0}));
  EXPECT_EQ(meshio::read_vtp(with_text("UNIT", "cm")).points_mm[2], (Vec3{0, 20, 0}));
  EXPECT_EQ(meshio::read_vtp(with_text("UNIT", "m")).points_mm[3], (Vec3{0, 0, 3000}));
  EXPECT_EQ(code_of_reading(with_text("UNIT", "furlong")), ExitCode::bad_input);
  EXPECT_EQ(code_of_reading(with_text("SPACE", "scanner")), ExitCode::bad_input);

  for (const char* bad : {"0 1 2 0 2 4", "0 1 2 0 2 -1"}) {
    std::string p = good;
    p.replace(p.find("0 1 2 0 2 3"), 11, bad);
    write_file(path("bad.vtp"), file("", p));
    EXPECT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input) << bad;
  }
  // A quad and an edge instead of two triangles.
  std::string p = good;
  p.replace(p.find(">3 6<"), 5, ">4 6<");
  write_file(path("bad.vtp"), file("", p));
  EXPECT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input);
}

TEST_F(Vtp, BadFilesAreRefusedByName) {
  EXPECT_EQ(code_of_reading(path("missing.vtp")), ExitCode::no_input);
  EXPECT_EQ(code_of_reading(folder_), ExitCode::no_input);
  for (const std::string s :
       {"", "solid x", "<VTKFile", "\0\0\0", "<?xml version=\"1.0\"?><VTKFile type=\"ImageData\"/>"}) {
    write_file(path("bad.vtp"), s);
    EXPECT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input) << s;
  }
}

TEST_F(Vtp, HostileCountsAllocateNothing) {
  meshio::write_vtp(path("a.vtp"), wavy_sphere(8, 5, {}, false));
  std::string s = bytes(path("a.vtp"));
  const std::size_t at = s.find("NumberOfPoints=\"") + 16;
  s.replace(at, s.find('"', at) - at, "9000000000000000");
  write_file(path("bad.vtp"), s);
  EXPECT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input);
}

TEST_F(Vtp, MeshesThatAreNoneAreNotWritten) {
  surface::TriMesh m = wavy_sphere(8, 5, {}, false);
  m.points_mm[3].y = std::nan("");
  EXPECT_THROW(meshio::write_vtp(path("a.vtp"), m), Error);
  m = wavy_sphere(8, 5, {}, false);
  m.triangles[0][1] = 10000;
  EXPECT_THROW(meshio::write_vtp(path("a.vtp"), m), Error);
  EXPECT_FALSE(fs::exists(path("a.vtp")));
}

// A file of ours with a flipped bit is found by its checksum; the flip in the last line's own beginning makes it a
// foreign one whose data are whole.
TEST_F(Vtp, TruncationsAndFlippedBits) {
  const surface::TriMesh m = wavy_sphere(6, 4, {0.1, 0.2, 0.3}, true);
  meshio::write_vtp(path("a.vtp"), m);
  const std::string good = bytes(path("a.vtp"));
  const std::size_t end = good.rfind("</VTKFile>") + 10, trailer = good.rfind("<!--");
  for (std::size_t n = 0; n < end; n += 5) {
    put("bad.vtp", good.substr(0, n));
    ASSERT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input) << n << " of " << good.size();
  }
  for (std::size_t bit = 0; bit < trailer * 8; bit += 13) {
    std::string s = good;
    s[bit / 8] = char(s[bit / 8] ^ (1 << (bit % 8)));
    put("bad.vtp", s);
    ASSERT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input) << bit;
  }
  std::string s = good;
  s[trailer + 2] = '+';
  put("a.vtp", s);
  expect_identical(m, meshio::read_vtp(path("a.vtp")));
}

// A checksum can be forged: these files crash VTK 9.1's reader, which must not be in this process.
TEST_F(Vtp, DamageUnderAChecksumThatFits) {
  meshio::write_vtp(path("a.vtp"), wavy_sphere(6, 4, {0.1, 0.2, 0.3}, true));
  std::string good = bytes(path("a.vtp"));
  good.resize(good.rfind("<!--"));
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"offset=\"0\"", "offset=\"9\""},
                                 {"type=\"Float64\" Name=\"origin_mm\"", "type=\"Floatnan\" Name=\"origin_mm\""}}) {
    std::string s = good;
    ASSERT_NE(s.find(from), std::string::npos) << from;
    s.replace(s.find(from), from.size(), to);
    put("bad.vtp", s + "<!-- trephine sha256 " + sha256_of_bytes(s) + " -->\n");
    EXPECT_EQ(code_of_reading(path("bad.vtp")), ExitCode::bad_input) << to;
  }
}

// Without the checksum it is a foreign file: whatever VTK's reader does with the damage happens in a child. Never a
// crash, never a mesh with other counts.
TEST_F(Vtp, DamagedForeignFiles) {
  const surface::TriMesh m = wavy_sphere(6, 4, {0.1, 0.2, 0.3}, true);
  meshio::write_vtp(path("a.vtp"), m);
  std::string good = bytes(path("a.vtp"));
  good.resize(good.rfind("<!--"));
  put("b.vtp", good);
  expect_identical(m, meshio::read_vtp(path("b.vtp")));
  int refused = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const std::size_t bit = i * good.size() * 8 / 60 + i % 8;
    std::string s = good;
    s[bit / 8] = char(s[bit / 8] ^ (1 << (bit % 8)));
    put("bad.vtp", s);
    try {
      const surface::TriMesh r = meshio::read_vtp(path("bad.vtp"));
      EXPECT_EQ(r.points_mm.size(), m.points_mm.size()) << bit;
      EXPECT_EQ(r.triangles.size(), m.triangles.size()) << bit;
    } catch (const Error& e) {
      ++refused;
      EXPECT_TRUE(e.code() == ExitCode::bad_input || e.code() == ExitCode::internal) << bit << " " << e.what();
    }
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace trephine
