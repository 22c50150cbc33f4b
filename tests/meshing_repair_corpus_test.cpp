// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign meshes made valid (M7): mixed faults with the counted refusals, and other people's meshes.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include "base/error.h"
#include "meshing_faults.h"

namespace trephine {
namespace {

using namespace faults;

struct Corpus {
  int refused = 0, total = 0;
  std::map<std::string, int> methods;
};

/// Mixed faults on shapes of several kinds; every result is checked, refusals are counted.
Corpus corpus(std::uint64_t from, std::uint64_t to) {
  Corpus c;
  for (std::uint64_t seed = from; seed < to; ++seed) {
    Random random(seed);
    surface::TriMesh m = seed % 4 == 0   ? ball()
                         : seed % 4 == 1 ? torus()
                         : seed % 4 == 2 ? box({0, 0, 0}, {10, 20, 5})
                                         : contoured(noise(9, seed, 0.25, false));
    const double volume = surface::volume_mm3(m);
    const bool coarse = seed % 4 == 2;
    bool holes = false;
    if (random() < 0.4) duplicate(m, random, 0.05);
    if (random() < 0.4)
      for (int i = 0; i < 2; ++i) fin(m, random);
    if (random() < 0.4)
      for (int i = 0; i < 4; ++i) sliver(m, random);
    if (!coarse && random() < 0.3) {
      punch(m, random, 2, 1.5);
      holes = true;
    }
    if (!coarse && random() < 0.3)
      for (int i = 0; i < 2; ++i) spike(m, random);
    if (random() < 0.4) flip(m, random, random() < 0.5 ? 0.1 : 0.02);
    if (random() < 0.5) unmerge(m, random, random() < 0.5 ? 0 : 1e-5);
    ++c.total;
    meshing::RepairParams p;
    p.recontour_voxels_count = 64;
    try {
      const Result r = repaired(m, p);
      ++c.methods[r.text("method")];
      EXPECT_NEAR(surface::volume_mm3(r.mesh) / volume, 1, r.text("method") == "mended" && !holes ? 0.1 : 0.3)
          << "seed " << seed << ", " << r.text("method");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality) << e.what();
      ++c.refused;
    }
  }
  std::printf("%d soups: %d refused", c.total, c.refused);
  for (const auto& [method, n] : c.methods) std::printf(", %d %s", n, method.c_str());
  std::printf("\n");
  return c;
}

TEST(Repair, MixedFaultsAtMost5PercentRefused) {  // M7
  const Corpus c = corpus(0, 40);
  EXPECT_LE(c.refused, c.total / 20);
}

TEST(LongRepair, MixedFaultsAtMost5PercentRefused) {
  const Corpus c = corpus(1000, 1600);
  EXPECT_LE(c.refused, c.total / 20);
}

/// Plain OFF, polygons as fans; nothing where it is something else.
surface::TriMesh read_off(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  std::vector<double> n;
  in >> word;
  if (word != "OFF") return {};
  while (in >> word)
    if (word[0] == '#')
      std::getline(in, word);
    else
      n.push_back(std::strtod(word.c_str(), nullptr));
  surface::TriMesh m;
  if (n.size() < 3) return m;
  const auto points = std::size_t(n[0]), faces = std::size_t(n[1]);
  std::size_t at = 3;
  for (std::size_t i = 0; i < points; ++i, at += 3) m.points_mm.push_back({n.at(at), n.at(at + 1), n.at(at + 2)});
  for (std::size_t i = 0; i < faces; ++i) {
    const auto corners = std::size_t(n.at(at++));
    const auto v = [&](std::size_t c) { return std::uint32_t(n.at(at + c)); };
    for (std::size_t c = 2; c < corners; ++c) m.triangles.push_back({v(0), v(c - 1), v(c)});
    at += corners;
  }
  return m;
}

TEST(Repair, OthersMeshesWithHoles) {
  const char* data = std::getenv("TREPHINE_DATA");
  const auto root = std::filesystem::path(data ? data : std::string(std::getenv("HOME")) + "/.cache/trephine-data") /
                    "bad_meshes" / "cgal";
  if (!std::filesystem::exists(root)) GTEST_SKIP() << root << " is not there";
  int repaired_count = 0;
  for (const char* name : {"corner_with_hole", "elephant-with-holes", "hole", "mech-holes-shark", "triangular_hole"}) {
    const surface::TriMesh m = read_off(root / (std::string(name) + ".off"));
    ASSERT_FALSE(m.triangles.empty()) << name;
    meshing::RepairParams p;
    p.recontour_voxels_count = 96;
    try {
      const Result r = repaired(m, p);
      const surface::Bounds b = surface::bounds_of(m);
      std::printf("%s: %s, %d holes, %.2g of its size from the input\n", name, r.text("method").c_str(),
                  int(r.count("holes_filled_count")), r.number("from_input_max_mm") / norm(b.max_mm - b.min_mm));
      EXPECT_LT(r.number("from_input_max_mm"), 0.02 * norm(b.max_mm - b.min_mm)) << name;
      ++repaired_count;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality);
      std::printf("%s: refused: %s\n", name, e.what());
    }
  }
  EXPECT_GE(repaired_count, 3);
}

}  // namespace
}  // namespace trephine
