// SPDX-License-Identifier: GPL-3.0-or-later
// Decimation: always valid, never beyond the bound, and the reason for stopping is said (M8).
#include "meshing/decimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/collapse_mesh.h"
#include "meshing/contour.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"
#include "surface/triangle_tree.h"

namespace trephine {
namespace {

using namespace shapes;

Result decimated(const surface::TriMesh& m, std::int64_t count, double ratio, double deviation) {
  meshing::DecimateParams p;
  p.target_triangles_count = count;
  p.keep_ratio = ratio;
  p.max_deviation_mm = deviation;
  Result r;
  r.mesh = value_of(r.report, meshing::decimate(m, p));
  const meshing::Validity v = meshing::check_validity(r.mesh);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_TRUE(v.float32);
  return r;
}

/// Largest distance of dense samples over a to b: a measurement that shares no code with the one under test but the
/// search.
double distance(const surface::TriMesh& a, const surface::TriMesh& b, int n) {
  const surface::TriangleTree tree(b);
  double d2 = 0;
  for (const auto& t : a.triangles) {
    const Vec3 o = a.points_mm[t[0]], u = a.points_mm[t[1]] - o, v = a.points_mm[t[2]] - o;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n - i; ++j)
        d2 = std::max(d2,
                      tree.squared_distance(o + u * (double(i) / n) + v * (double(j) / n) + a.origin_mm - b.origin_mm,
                                            std::numeric_limits<double>::infinity()));
  }
  return std::sqrt(d2);
}

/// A gyroid shell of 2 mm within a ball: thin, of high genus.
grid::Field gyroid(int n) {
  const double side = 40.0 / n;
  grid::Lattice l = lattice(n, n, n, {side, side, side}, {-20, -20, -20});
  return sample(l, [](Vec3 p) {
    const double k = 2 * M_PI / 12;
    const double g = std::sin(k * p.x) * std::cos(k * p.y) + std::sin(k * p.y) * std::cos(k * p.z) +
                     std::sin(k * p.z) * std::cos(k * p.x);
    return std::min(1 - std::abs(g) / (k * 1.3), 18 - norm(p));
  });
}

TEST(Decimate, EveryLevel) {  // M8
  const surface::TriMesh m = contoured(sphere(30, 20));
  const auto n = static_cast<double>(m.triangles.size());
  for (const double keep : {0.5, 0.1, 0.05, 0.01, 0.001}) {
    const Result r = decimated(m, 0, keep, 0);
    EXPECT_EQ(r.text("stopped_by"), "count") << keep;
    EXPECT_LE(r.mesh.triangles.size(), std::max(4.0, keep * n + 1));
    EXPECT_GE(r.mesh.triangles.size() + 2.0, std::max(4.0, keep * n));
    EXPECT_NEAR(r.number("deviation_max_mm"), std::max(distance(m, r.mesh, 3), distance(r.mesh, m, 12)),
                0.1 * r.number("deviation_max_mm") + 0.01);
  }
  const Result least = decimated(m, 4, 0, 0);
  EXPECT_EQ(least.mesh.triangles.size(), 4u);
}

/// A plate with a ridge, holes and a step: flat parts with sharp edges.
grid::Field machined() {
  return sample(lattice(34, 28, 16, {1.2, 1.2, 1.2}), [](Vec3 p) {
    const double plate = std::min({p.x - 2.3, 37 - p.x, p.y - 2.1, 29 - p.y, p.z - 3.2, (p.x < 20 ? 9.1 : 12.4) - p.z});
    const double hole = 4.2 - std::hypot(p.x - 11, p.y - 14), ridge = 1.1 - std::hypot(p.x - 28, p.z - 12.6);
    return std::max(std::min(plate, -hole), std::min(ridge, std::min(p.y - 3, 27 - p.y)));
  });
}

/// How many samples of a lie beyond the bound of b. As many to a triangle's side as the bound asks for.
int beyond(const surface::TriMesh& a, const surface::TriMesh& b, double bound) {
  const surface::TriangleTree tree(b);
  int found = 0;
  for (const auto& t : a.triangles) {
    const Vec3 o = a.points_mm[t[0]], u = a.points_mm[t[1]] - o, v = a.points_mm[t[2]] - o;
    const double longest = std::max({norm(u), norm(v), norm(v - u)});
    const int n = std::clamp(static_cast<int>(std::ceil(2 * longest / bound)), 2, 8);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n - i; ++j)
        found += tree.squared_distance(o + u * (double(i) / n) + v * (double(j) / n), bound * bound) >= bound * bound;
  }
  return found;
}

/// No allowance but for the floats that the result is made of.
Result holds(const surface::TriMesh& m, double bound, std::int64_t count = 0) {
  constexpr double rounding = 1e-5;
  Result r = decimated(m, count, 0, bound);
  EXPECT_LE(r.number("deviation_max_mm"), bound);
  EXPECT_EQ(r.mesh.origin_mm, m.origin_mm);
  EXPECT_EQ(beyond(m, r.mesh, bound + rounding), 0) << bound;
  EXPECT_EQ(beyond(r.mesh, m, bound + rounding), 0) << bound;
  EXPECT_EQ(surface::topology_of(r.mesh).genus, surface::topology_of(m).genus);
  return r;
}

TEST(Decimate, BoundIsKeptBothWays) {
  const surface::TriMesh ball = contoured(sphere(40, 20)), thin = contoured(gyroid(30));
  EXPECT_GT(surface::topology_of(thin).genus, 10);
  for (const double bound : {0.1, 0.5})
    for (const surface::TriMesh* m : {&ball, &thin}) {
      const Result r = holds(*m, bound);
      EXPECT_EQ(r.text("stopped_by"), "deviation");
      EXPECT_LT(r.mesh.triangles.size(), m->triangles.size() / (m == &ball ? 4.0 : bound < 0.2 ? 1 : 2));
    }
}

void bounds_of_every_shape(std::uint64_t seeds, const std::vector<double>& bounds) {
  std::vector<surface::TriMesh> shapes{contoured(sphere(20, 12, {3, 1, 2})), contoured(gyroid(20)),
                                       contoured(machined())};
  for (std::uint64_t seed = 0; seed < seeds; ++seed) shapes.push_back(contoured(noise(9, seed, 0.4, seed % 2 == 0)));
  for (const surface::TriMesh& m : shapes)
    for (const double bound : bounds) holds(m, bound);
}

TEST(Decimate, BoundHoldsForEveryShape) { bounds_of_every_shape(2, {0.3, 1.0}); }
TEST(LongDecimate, BoundHoldsForEveryShape) {
  bounds_of_every_shape(40, {0.1, 0.3, 0.5, 1.0});
  for (const int n : {30, 37, 45, 60})
    for (const double bound : {0.1, 0.3, 0.5, 1.0}) {
      holds(contoured(gyroid(n)), bound);
      holds(contoured(gyroid(n)), bound, 2000);
    }
}

TEST(Decimate, CountOrBoundWhicheverComesFirst) {
  const surface::TriMesh m = contoured(sphere(40, 20));
  EXPECT_EQ(decimated(m, 2000, 0, 1.0).text("stopped_by"), "count");
  EXPECT_LE(decimated(m, 2000, 0, 1.0).mesh.triangles.size(), 2000u);
  const Result bound = decimated(m, 50, 0, 0.05);
  EXPECT_EQ(bound.text("stopped_by"), "deviation");
  EXPECT_GT(bound.mesh.triangles.size(), 50u);
  // The larger of the two counts holds.
  EXPECT_GE(decimated(m, 50, 0.25, 0).mesh.triangles.size() + 2.0, 0.25 * double(m.triangles.size()));
  // Nothing to do.
  EXPECT_EQ(decimated(m, 1 << 30, 0, 1).mesh.triangles.size(), m.triangles.size());
  EXPECT_EQ(decimated(m, 0, 0, 0).mesh.triangles.size(), m.triangles.size());
}

TEST(Decimate, SphereStaysRound) {
  const surface::TriMesh m = contoured(sphere(60, 20));
  const Result r = decimated(m, 1500, 0, 0);
  EXPECT_NEAR(surface::volume_mm3(r.mesh) / (4.0 / 3 * M_PI * 8000), 1, 0.01);
  for (std::size_t i = 0; i < r.mesh.points_mm.size(); ++i) EXPECT_NEAR(norm(r.mesh.world_mm(i)), 20, 0.15);
}

void decimate_noise(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    for (const double fill : {0.1, 0.3, 0.5}) {
      const surface::TriMesh m = contoured(noise(12, seed, fill, seed % 2 == 0));
      decimated(m, 0, 0.1, 0);
      const Result r = decimated(m, 0, 0.1, 0.3);
      EXPECT_LE(r.number("deviation_max_mm"), 0.3);
    }
}

TEST(Decimate, RandomNoise) { decimate_noise(3); }  // high genus, touching sheets
TEST(LongDecimate, RandomNoise) { decimate_noise(100); }

// Where collapses meet each other all over, they are undone again: how often is bounded, and with it the time.
TEST(Decimate, ASurfaceOfNoiseIsNotCollapsedInVain) {
  std::mt19937_64 random(3);
  std::normal_distribution<float> error(0, 0.75f);
  grid::Field f = sphere(90, 20);  // voxels of half a millimetre
  for (float& v : f.voxels) v = std::abs(v) < 2.9f ? v + error(random) : v;
  meshing::ContourParams one;
  one.min_component_mm3 = 50;
  const surface::TriMesh m = meshing::contour(f, one).value;
  const Result r = decimated(m, 2000, 0, 1.5);
  EXPECT_EQ(r.text("stopped_by"), "deviation");
  EXPECT_LT(double(r.count("collapses_undone_count")), 0.5 * double(m.triangles.size()));
  EXPECT_LT(double(r.mesh.triangles.size()), 0.5 * double(m.triangles.size()));
}

TEST(Decimate, ScalesAndOffsets) {  // M6
  const Result unit = decimated(contoured(sphere(24, 1)), 600, 0, 0);
  for (const double scale : {1e-6, 1.0, 1e3, 1e6}) {
    surface::TriMesh m = contoured(sphere(24, scale));
    m.origin_mm += Vec3{1e6, -1e6, 1e6};
    const Result r = decimated(m, 600, 0, 0);
    EXPECT_EQ(r.mesh.triangles.size(), unit.mesh.triangles.size());
    EXPECT_NEAR(surface::volume_mm3(r.mesh) / (surface::volume_mm3(unit.mesh) * scale * scale * scale), 1, 1e-3)
        << scale;
  }
}

TEST(Decimate, RefusesWhatIsNotASurface) {
  surface::TriMesh m = contoured(sphere(16, 5));
  const auto code = [](const surface::TriMesh& mesh) {
    meshing::DecimateParams p;
    p.keep_ratio = 0.5;
    Report r;
    try {
      value_of(r, meshing::decimate(mesh, p));
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  surface::TriMesh open = m;
  open.triangles.pop_back();
  EXPECT_EQ(code(open), ExitCode::quality);
  surface::TriMesh nan = m;
  nan.points_mm[7].z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code(nan), ExitCode::bad_input);
  surface::TriMesh index = m;
  index.triangles[3][1] = 1u << 30;
  EXPECT_EQ(code(index), ExitCode::bad_input);
  surface::TriMesh crossing = m;
  crossing.points_mm[crossing.triangles[0][0]] = -crossing.points_mm[crossing.triangles[0][0]] * 2.0;
  EXPECT_EQ(code(crossing), ExitCode::quality);
}

TEST(Decimate, SameBytesWithAnyThreads) {
  const surface::TriMesh m = contoured(gyroid(60));  // large enough for the sweeps
  ASSERT_GT(m.triangles.size(), 30000u);
  set_thread_count(1);
  const Result one = decimated(m, 5000, 0, 0.3);
  set_thread_count(2);
  const Result two = decimated(m, 5000, 0, 0.3);
  set_thread_count(0);
  EXPECT_TRUE(one.mesh.points_mm == two.mesh.points_mm && one.mesh.triangles == two.mesh.triangles);
  EXPECT_EQ(one.report.figures, two.report.figures);
}

TEST(CollapseMesh, UndoingRestoresTheMesh) {
  const surface::TriMesh m = contoured(sphere(12, 5));
  meshing::CollapseMesh c(m);
  Random random(3);
  meshing::CollapseMesh::Log log = c.open_log(400);
  for (int n = 0; n < 400; ++n) {
    const auto h = static_cast<std::uint32_t>(random() * 3 * double(c.triangles()));
    if (c.live_triangle(h / 3) && c.keeps_manifold(h)) c.collapse(h, c.point_mm(c.from(h)) + Vec3{0.1, 0, 0}, log);
  }
  c.keep(std::move(log));
  ASSERT_LT(c.live_triangles(), m.triangles.size() / 2);
  const surface::Topology t = surface::topology_of(c.to_mesh({}));
  EXPECT_TRUE(t.closed() && t.manifold());
  EXPECT_EQ(t.genus, 0);
  while (c.live_triangles() < m.triangles.size()) {
    // Any live triangle's last change, in random order; what depends on it goes with it.
    const auto triangle = static_cast<std::uint32_t>(random() * double(c.triangles()));
    if (!c.live_triangle(triangle) || c.last_change(triangle) == meshing::CollapseMesh::none) continue;
    c.undo(
        c.last_change(triangle), [](std::uint32_t, std::uint32_t) {}, [](std::uint32_t, std::uint32_t) {});
    const surface::Topology now = surface::topology_of(c.to_mesh({}));
    ASSERT_TRUE(now.closed() && now.manifold());
  }
  const surface::TriMesh back = c.to_mesh(m.origin_mm);
  EXPECT_TRUE(back.points_mm == m.points_mm);
  EXPECT_TRUE(back.triangles == m.triangles);
}

}  // namespace
}  // namespace trephine
