// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign meshes made valid (M7): each fault alone with what is counted, mixed faults with the counted refusals.
#include "meshing/repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"

namespace trephine {
namespace {

using namespace shapes;

Result repaired(const TriMesh& m, const RepairParams& p = {}) {
  Result r;
  r.mesh = repair(m, p, r.report);
  const Validity v = check_validity(r.mesh);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  return r;
}

TriMesh ball(double radius = 10, Vec3 centre = {}) { return surface(sphere(18, radius, centre)); }

TriMesh together(const TriMesh& a, const TriMesh& b) {
  TriMesh m = a;
  const auto n = static_cast<std::uint32_t>(a.points_mm.size());
  for (std::size_t i = 0; i < b.points_mm.size(); ++i) m.points_mm.push_back(b.world_mm(i) - a.origin_mm);
  for (const auto& t : b.triangles) m.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  return m;
}

TriMesh box(Vec3 lo, Vec3 hi) {
  TriMesh m;
  for (int c = 0; c < 8; ++c) m.points_mm.push_back({c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

TriMesh torus() {
  Lattice l = lattice(30, 30, 12, {1, 1, 1}, {-14.5, -14.5, -5.5});
  return surface(sample(l, [](Vec3 p) { return 3 - std::hypot(std::hypot(p.x, p.y) - 9, p.z); }));
}

/// Each triangle with points of its own, as in an STL, moved by up to `jitter`.
void unmerge(TriMesh& m, Random& random, double jitter = 0) {
  TriMesh soup;
  soup.origin_mm = m.origin_mm;
  for (const auto& t : m.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.points_mm.size());
    for (const std::uint32_t v : t) soup.points_mm.push_back(m.points_mm[v] + random.direction() * (jitter * random()));
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  m = soup;
}

void flip(TriMesh& m, Random& random, double share) {
  for (auto& t : m.triangles)
    if (random() < share) std::swap(t[0], t[1]);
}

void duplicate(TriMesh& m, Random& random, double share) {
  const std::size_t n = m.triangles.size();
  for (std::size_t t = 0; t < n; ++t) {
    if (random() >= share) continue;
    auto copy = m.triangles[t];
    if (random() < 0.5) std::swap(copy[0], copy[1]);
    m.triangles.push_back(copy);
  }
}

void punch(TriMesh& m, Random& random, int holes, double radius) {
  for (int h = 0; h < holes; ++h) {
    const Vec3 at = m.points_mm[std::size_t(random() * double(m.points_mm.size()))];
    m.triangles.erase(std::remove_if(m.triangles.begin(), m.triangles.end(),
                                     [&](const auto& t) { return norm(m.points_mm[t[0]] - at) < radius; }),
                      m.triangles.end());
  }
}

/// A third triangle on an edge.
void fin(TriMesh& m, Random& random) {
  const auto t = m.triangles[std::size_t(random() * double(m.triangles.size()))];
  const auto n = static_cast<std::uint32_t>(m.points_mm.size());
  m.points_mm.push_back(m.points_mm[t[0]] * 1.3);
  m.triangles.push_back({t[0], t[1], n});
}

/// An edge of a triangle and its neighbour is split beside its end: two slivers, with their points 1e-9 apart.
void sliver(TriMesh& m, Random& random) {
  const std::size_t at = std::size_t(random() * double(m.triangles.size()));
  const auto t = m.triangles[at];
  const Vec3 a = m.points_mm[t[0]], b = m.points_mm[t[1]];
  const auto n = static_cast<std::uint32_t>(m.points_mm.size());
  m.points_mm.push_back(a + (b - a) * (random() < 0.5 ? 1e-9 : 0.5) + random.direction() * 1e-9);
  for (std::size_t s = 0, end = m.triangles.size(); s < end; ++s)
    for (int c = 0; c < 3; ++c) {
      auto& v = m.triangles[s];
      const bool same = v[c] == t[0] && v[(c + 1) % 3] == t[1], turned = v[c] == t[1] && v[(c + 1) % 3] == t[0];
      if (!same && !turned) continue;
      auto half = v;
      half[c] = n;
      v[(c + 1) % 3] = n;
      m.triangles.push_back(half);
      break;
    }
}

/// A point is pulled through its surroundings.
void spike(TriMesh& m, Random& random) {
  Vec3& p = m.points_mm[std::size_t(random() * double(m.points_mm.size()))];
  p = p + random.direction() * random(0.5, 3);
}

/// A surface that passes through itself: a tube along a figure of eight.
TriMesh figure_of_eight() {
  TriMesh m = torus();
  for (Vec3& p : m.points_mm) {
    const double angle = std::atan2(p.y, p.x), radius = std::hypot(p.x, p.y) - 9;
    const Vec3 centre{14 * std::sin(angle), 7 * std::sin(2 * angle), 1.5 * std::cos(angle)};
    const Vec3 tangent = normalized(Vec3{14 * std::cos(angle), 14 * std::cos(2 * angle), -1.5 * std::sin(angle)});
    const Vec3 across = normalized(cross(tangent, Vec3{0, 0, 1}));
    p = centre + across * radius + cross(across, tangent) * p.z;
  }
  return m;
}

TEST(Repair, AValidMeshStaysAsItIs) {
  const TriMesh m = torus();
  const Result r = repaired(m);
  EXPECT_EQ(r.text("method"), "none");
  EXPECT_TRUE(r.mesh.points_mm == m.points_mm && r.mesh.triangles == m.triangles);
  EXPECT_LT(r.number("to_input_max_mm"), 1e-12);
}

TEST(Repair, BadIndicesAndNumbersAreRefused) {  // M5, M7
  const auto code = [](const TriMesh& m) {
    try {
      Report r;
      repair(m, {}, r);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  TriMesh m = ball();
  m.triangles[7][1] = 1000000;
  EXPECT_EQ(code(m), ExitCode::bad_input);
  m = ball();
  m.points_mm[3].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(m), ExitCode::bad_input);
  EXPECT_EQ(code(TriMesh()), ExitCode::bad_input);
  TriMesh sheet;  // encloses nothing
  sheet.points_mm = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0}};
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
  EXPECT_EQ(code(sheet), ExitCode::quality);
}

TEST(Repair, OneFaultAtATime) {
  const TriMesh whole = ball();
  const double volume = volume_mm3(whole);
  const auto check = [&](const char* what, const TriMesh& m, const char* counter, std::int64_t expected,
                         double tolerance = 1e-3) {
    const Result r = repaired(m);
    EXPECT_EQ(r.text("method"), "mended") << what;
    EXPECT_NEAR(volume_mm3(r.mesh) / volume, 1, tolerance) << what;
    EXPECT_EQ(topology_of(r.mesh).genus, 0) << what;
    if (expected < 0)
      EXPECT_GT(r.count(counter), 0) << what;
    else
      EXPECT_EQ(r.count(counter), expected) << what;
  };
  Random random(5);
  TriMesh m = whole;
  unmerge(m, random);
  check("unmerged", m, "points_merged_count", std::int64_t(3 * whole.triangles.size() - whole.points_mm.size()));
  m = whole;
  unmerge(m, random, 1e-4);
  check("nearly merged", m, "points_merged_count", std::int64_t(3 * whole.triangles.size() - whole.points_mm.size()));
  m = whole;
  flip(m, random, 0.2);
  check("flipped", m, "flipped_count", -1);
  m = whole;
  flip(m, random, 1);
  check("inside out", m, "flipped_count", std::int64_t(m.triangles.size()));
  m = whole;
  duplicate(m, random, 0.1);
  const auto twice = std::int64_t(m.triangles.size() - whole.triangles.size());
  check("twice", m, "duplicates_dropped_count", twice);
  m = whole;
  for (int i = 0; i < 3; ++i) fin(m, random);
  check("fins", m, "fins_dropped_count", 3);
  m = whole;
  punch(m, random, 1, 2.5);
  check("hole", m, "holes_filled_count", 1, 0.02);
  m = whole;
  for (int i = 0; i < 8; ++i) sliver(m, random);
  check("slivers", m, "self_intersections_found_count", 0);
  m = whole;
  for (int i = 0; i < 3; ++i) spike(m, random);
  check("spikes", m, "self_intersections_found_count", -1, 0.05);
}

TEST(Repair, PiecesThatTouchOverlapOrLieWithin) {
  const TriMesh a = box({0, 0, 0}, {10, 10, 10});
  // Two boxes that share an edge, with its two points in common.
  TriMesh edge = together(a, box({10, 10, 0}, {20, 20, 10}));
  for (auto& t : edge.triangles)
    for (std::uint32_t& v : t)
      for (std::uint32_t w = 0; w < v; ++w)
        if (edge.points_mm[w] == edge.points_mm[v]) v = w;
  EXPECT_GT(topology_of(edge).nonmanifold_edges, 0u);
  EXPECT_NEAR(volume_mm3(repaired(edge).mesh), 2000, 0.1);
  // A whole face in common: the wall goes.
  EXPECT_NEAR(volume_mm3(repaired(together(a, box({10, 0, 0}, {20, 10, 10}))).mesh), 2000, 0.1);
  // Overlapping: united.
  const Result both = repaired(together(ball(), ball(10, {9, 1, 2})));
  EXPECT_EQ(both.count("united_count"), 1);
  EXPECT_EQ(topology_of(both.mesh).components, 1);
  // A cavity stays one, a shell about it is turned outwards.
  TriMesh hollow = ball(5);
  for (auto& t : hollow.triangles) std::swap(t[0], t[1]);
  TriMesh shell = together(ball(), hollow);
  for (auto& t : shell.triangles) std::swap(t[0], t[1]);
  const Result r = repaired(shell);
  EXPECT_EQ(topology_of(r.mesh).components, 2);
}

TEST(Repair, LastResort) {
  const TriMesh m = figure_of_eight();
  ASSERT_GT(check_validity(m).self_intersections, 0u);
  RepairParams p;
  p.recontour_voxels_count = 64;
  const Result r = repaired(m, p);
  EXPECT_EQ(r.text("method"), "recontoured");
  EXPECT_EQ(topology_of(r.mesh).components, 1);
  EXPECT_EQ(topology_of(r.mesh).genus, 2);
  EXPECT_LT(r.number("to_input_max_mm"), r.number("voxel_mm"));
  EXPECT_EQ(r.report.warnings.size(), 1u);
}

TEST(Repair, ScalesAndOffsets) {  // M6
  const auto soup = [](double scale, double offset) {
    Random random(2);
    TriMesh m = surface(sphere(18, scale, {offset, -offset, offset}));
    punch(m, random, 2, 0.2 * scale);
    unmerge(m, random);
    flip(m, random, 0.1);
    return m;
  };
  const double unit = volume_mm3(repaired(soup(1, 0)).mesh);
  for (const double scale : {1e-6, 1e-3, 30.0, 1e6})
    for (const double offset : {0.0, 1e6}) {
      if (offset > 0 && scale < 1) continue;  // a lattice origin in doubles has no digits left for it
      const Result r = repaired(soup(scale, offset));
      EXPECT_EQ(r.text("method"), "mended");
      EXPECT_NEAR(volume_mm3(r.mesh) / (unit * scale * scale * scale), 1, 1e-5) << scale << " " << offset;
    }
}

struct Corpus {
  int refused = 0, total = 0;
  std::map<std::string, int> methods;
};

/// Mixed faults on shapes of several kinds; every result is checked, refusals are counted.
Corpus corpus(std::uint64_t from, std::uint64_t to) {
  Corpus c;
  for (std::uint64_t seed = from; seed < to; ++seed) {
    Random random(seed);
    TriMesh m = seed % 4 == 0   ? ball()
                : seed % 4 == 1 ? torus()
                : seed % 4 == 2 ? box({0, 0, 0}, {10, 20, 5})
                                : surface(noise(9, seed, 0.25, false));
    const double volume = volume_mm3(m);
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
    RepairParams p;
    p.recontour_voxels_count = 64;
    try {
      const Result r = repaired(m, p);
      ++c.methods[r.text("method")];
      EXPECT_NEAR(volume_mm3(r.mesh) / volume, 1, r.text("method") == "mended" && !holes ? 0.1 : 0.3)
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
TriMesh read_off(const std::filesystem::path& file) {
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
  TriMesh m;
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
    const TriMesh m = read_off(root / (std::string(name) + ".off"));
    ASSERT_FALSE(m.triangles.empty()) << name;
    RepairParams p;
    p.recontour_voxels_count = 96;
    try {
      const Result r = repaired(m, p);
      const Bounds b = bounds_of(m);
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

TEST(Repair, BeyondItsTimeTheLastResort) {  // M11
  TriMesh m = surface(sphere(120, 10));
  Random random(3);
  punch(m, random, 1, 2);
  RepairParams p;
  p.time_limit_s = 0.1;
  p.recontour_voxels_count = 32;
  EXPECT_EQ(repaired(m, p).text("method"), "recontoured");
  p.recontour_voxels_count = 0;
  Report r;
  try {
    repair(m, p, r);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::internal);
    EXPECT_NE(std::string(e.what()).find("limit"), std::string::npos) << e.what();
  }
}

TEST(Repair, SameBytesWithAnyThreads) {
  Random random(11);
  TriMesh mended = torus();
  punch(mended, random, 2, 2);
  spike(mended, random);
  flip(mended, random, 0.1);
  unmerge(mended, random);
  RepairParams p;
  p.recontour_voxels_count = 48;
  for (const TriMesh& m : {mended, figure_of_eight()}) {
    set_thread_count(1);
    const Result one = repaired(m, p);
    set_thread_count(2);
    const Result two = repaired(m, p);
    set_thread_count(0);
    EXPECT_TRUE(one.mesh.points_mm == two.mesh.points_mm && one.mesh.triangles == two.mesh.triangles)
        << one.text("method");
  }
}

}  // namespace
}  // namespace trephine
