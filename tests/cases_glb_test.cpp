// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/glb.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"

namespace trephine {
namespace {

// A bumpy grid over the unit square, closed below by one point.
surface::TriMesh cushion(int n) {
  surface::TriMesh m;
  m.origin_mm = {100, -200, 300};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) m.points_mm.push_back({i * 0.7, j * 0.9, 3 * std::sin(i * 0.3) * std::cos(j * 0.2)});
  const auto at = [n](int i, int j) { return std::uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

cases::GlbParams params() {
  cases::GlbParams p;
  p.name = "skull";
  p.center_mm = {99.5, -199.25, 301};
  p.colour_rgb = {0.93, 0.5, 0.02};
  p.opacity = 0.5;
  return p;
}

// The JSON of a GLB changed, its lengths set right again.
std::string with_json(const std::string& glb, const std::string& from, const std::string& to) {
  std::uint32_t size;
  std::memcpy(&size, glb.data() + 12, 4);
  std::string json = glb.substr(20, size);
  const auto at = json.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  json.replace(at, from.size(), to);
  while (json.size() % 4 != 0) json += ' ';
  std::string out = glb.substr(0, 20) + json + glb.substr(20 + size);
  const auto n = static_cast<std::uint32_t>(json.size()), total = static_cast<std::uint32_t>(out.size());
  std::memcpy(out.data() + 12, &n, 4);
  std::memcpy(out.data() + 8, &total, 4);
  return out;
}

TEST(Glb, RoundTrip) {
  for (const int n : {5, 300}) {  // uint16 and uint32 indices
    const surface::TriMesh m = cushion(n);
    const std::string bytes = cases::make_glb(m, params());
    EXPECT_EQ(cases::make_glb(m, params()), bytes);
    const cases::GlbMesh back = cases::read_glb(bytes);
    EXPECT_EQ(back.mesh.triangles, m.triangles);
    ASSERT_EQ(back.mesh.points_mm.size(), m.points_mm.size());
    EXPECT_EQ(back.mesh.origin_mm, params().center_mm);
    for (std::size_t i = 0; i < m.points_mm.size(); ++i) EXPECT_LT(norm(back.mesh.world_mm(i) - m.world_mm(i)), 2e-5);
    EXPECT_EQ(back.name, "skull");
    EXPECT_NEAR(back.colour_rgb[0], 0.93, 1e-4);
    EXPECT_NEAR(back.colour_rgb[2], 0.02, 1e-4);
    EXPECT_EQ(back.opacity, 0.5);
    for (const Vec3 v : back.mesh.normals) EXPECT_NEAR(norm(v), 1, 1e-6);
    // Positions and normals of 12 bytes, indices of 2 or 4, and a small JSON.
    const std::size_t expected = m.points_mm.size() * 24 + m.triangles.size() * 3 * (n == 5 ? 2 : 4);
    EXPECT_LT(bytes.size(), expected + 2500);
  }
}

TEST(Glb, NormalsOfASphereAreExact) {
  surface::TriMesh m;
  for (int i = 0; i < 6; ++i) {
    Vec3 p;
    p[i / 2] = i % 2 ? -1 : 1;
    m.points_mm.push_back(p);
  }
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u}) {
        if ((x + y + z) % 2 == 0)
          m.triangles.push_back({x, y, z});
        else
          m.triangles.push_back({x, z, y});
      }
  const cases::GlbMesh back = cases::read_glb(cases::make_glb(m, params()));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(norm(back.mesh.normals[i] - m.points_mm[i]), 1e-7);
}

TEST(Glb, TheMeshsOwnNormalsAreKept) {
  surface::TriMesh m = cushion(3);
  m.normals.assign(m.points_mm.size(), normalized({1, 2, 3}));
  const cases::GlbMesh back = cases::read_glb(cases::make_glb(m, params()));
  for (const Vec3 v : back.mesh.normals) EXPECT_LT(norm(v - m.normals[0]), 1e-7);
}

TEST(Glb, WhatCannotBePublished) {
  const auto code_of = [](const surface::TriMesh& m) {
    try {
      cases::make_glb(m, params());
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of(surface::TriMesh()), ExitCode::quality);
  surface::TriMesh m = cushion(4);
  EXPECT_EQ(code_of(m), ExitCode::ok);
  m.points_mm[1] = m.points_mm[0] + Vec3{1e-9, 0, 0};  // one point in float32
  EXPECT_EQ(code_of(m), ExitCode::quality);
  m = cushion(4);
  m.points_mm[2].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code_of(m), ExitCode::bad_input);
  m = cushion(4);
  m.points_mm[2].y = 1e300;
  EXPECT_EQ(code_of(m), ExitCode::bad_input);
  m = cushion(4);
  m.triangles[7][2] = 25;
  EXPECT_EQ(code_of(m), ExitCode::bad_input);
}

TEST(Glb, HostileFilesAreRefused) {
  const std::string good = cases::make_glb(cushion(4), params());
  EXPECT_NO_THROW(cases::read_glb(good));
  EXPECT_NO_THROW(cases::read_glb(with_json(good, "\"generator\":\"trephine\"", "\"generator\":\"another\"")));
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"\"count\":25", "\"count\":26"},
           {"\"count\":25", "\"count\":4294967295"},
           {"\"count\":25", "\"count\":-1"},
           {"\"count\":25", "\"count\":0"},
           {"\"count\":25", "\"count\":2.5e1"},
           {"\"count\":25", "\"count\":\"25\""},
           {"\"count\":96", "\"count\":95"},
           {"\"componentType\":5126", "\"componentType\":5125"},
           {"\"componentType\":5123", "\"componentType\":5121"},
           {"\"componentType\":5123", "\"componentType\":5125"},
           {"\"type\":\"VEC3\"", "\"type\":\"VEC4\""},
           {"\"bufferView\":0", "\"bufferView\":9"},
           {"\"bufferView\":0", "\"bufferView\":0,\"byteOffset\":4"},
           {"\"bufferView\":0", "\"bufferView\":0,\"sparse\":{}"},
           {"\"byteLength\":300", "\"byteLength\":100000"},
           {"\"byteLength\":300", "\"byteLength\":299"},
           {"\"byteOffset\":300", "\"byteOffset\":18446744073709551615"},
           {"\"byteOffset\":300", "\"byteOffset\":302"},
           {"\"buffer\":0", "\"buffer\":1"},
           {"\"byteLength\":792", "\"byteLength\":4000000000"},
           {"\"byteLength\":792", "\"uri\":\"other.bin\",\"byteLength\":792"},
           {"\"POSITION\":0", "\"POSITION\":7"},
           {"\"POSITION\":0", "\"POSITON\":0"},
           {"\"NORMAL\":1", "\"NORMAL\":2"},
           {"\"mode\":4", "\"mode\":5"},
           {"\"version\":\"2.0\"", "\"version\":\"3.0\""},
           {"\"frame\":\"LPS\"", "\"frame\":\"RAS\""},
           {"\"unit\":\"mm\"", "\"unit\":\"m\""},
           {"\"matrix\":[0.001", "\"matrix\":[0.002"},
           {"\"center_mm\":[99.5", "\"center_mm\":[1e999"},
           {"\"center_mm\":[99.5,", "\"center_mm\":["},
           {"\"max\":[", "\"max\":[1,"},
           {"\"asset\"", "\"extensionsRequired\":[\"X\"],\"asset\""},
           {"{", "[[[[[["}}) {
    EXPECT_THROW(cases::read_glb(with_json(good, from, to)), Error) << to;
  }
}

TEST(Glb, DamageIsRefusedOrHarmless) {
  const surface::TriMesh m = cushion(3);
  const std::string good = cases::make_glb(m, params());
  for (std::size_t i = 0; i < good.size(); ++i) {
    EXPECT_THROW(cases::read_glb(std::string_view(good).substr(0, i)), Error) << i;
    for (int bit = 0; bit < 8; ++bit) {
      std::string damaged = good;
      damaged[i] = static_cast<char>(damaged[i] ^ (1 << bit));
      // Without the checksum a flipped bit may make another valid mesh; it never makes an invalid one.
      try {
        surface::check_mesh(cases::read_glb(damaged).mesh);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::bad_input);
      }
    }
  }
  EXPECT_THROW(cases::read_glb(good + std::string(4, '\0')), Error);
}

TEST(Glb, IndicesAndNumbersInTheDataAreChecked) {
  const std::string good = cases::make_glb(cushion(4), params());
  // 25 positions and normals of 12 bytes, then 96 uint16 indices.
  const std::size_t data = good.size() - (25 * 24 + 96 * 2);
  std::string bad = good;
  bad[data + 600] = 25;
  EXPECT_THROW(cases::read_glb(bad), Error);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t at : {data, data + 300}) {
    bad = good;
    std::memcpy(bad.data() + at, &nan, 4);
    EXPECT_THROW(cases::read_glb(bad), Error);
  }
}

TEST(Glb, MissingFile) {
  try {
    cases::read_glb_file("/nonexistent/skull.glb");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::no_input);
  }
}

}  // namespace
}  // namespace trephine
