// SPDX-License-Identifier: GPL-3.0-or-later
// Contouring: valid whatever the samples are (M1 to M5), and where the surface lies against analytic truth.
#include "meshing/contour.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace shapes;

meshing::ContourParams everything() {
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  p.keep_cavities = true;
  return p;
}

surface::TriMesh contoured(const grid::Field& f, const meshing::ContourParams& p = everything()) {
  Report r;
  return value_of(r, meshing::contour(f, p));
}

std::string refusal(const std::function<void()>& f, ExitCode code) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code) << e.what();
    return e.line("test");
  }
  ADD_FAILURE() << "was not refused";
  return "";
}

void expect_valid(const surface::TriMesh& m, const std::string& what) {
  const meshing::Validity v = meshing::check_validity(m);
  EXPECT_TRUE(v.valid()) << what << ": " << v.text();
  EXPECT_TRUE(v.float32) << what;
}

double deviation_from_sphere(const surface::TriMesh& m, Vec3 centre, double radius) {
  double d = 0;
  for (std::size_t i = 0; i < m.points_mm.size(); ++i) d = std::max(d, std::abs(norm(m.world_mm(i) - centre) - radius));
  return d;
}

TEST(Contour, SphereLiesWhereItIs) {
  const surface::TriMesh m = contoured(sphere(40, 20, {3, -4, 5}));
  expect_valid(m, "sphere");
  // Linear interpolation of a distance on 1.2 mm voxels: the error is about h^2 / (8 r).
  EXPECT_LT(deviation_from_sphere(m, {3, -4, 5}, 20), 0.012);
  EXPECT_NEAR(surface::volume_mm3(m) / (4.0 / 3 * M_PI * 8000), 1, 0.005);
  EXPECT_EQ(surface::topology_of(m).genus, 0);
}

TEST(Contour, ToLookAtIsTheSameSurface) {
  const grid::Field ball = sphere(40, 20, {3, -4, 5});
  const surface::TriMesh proven = contoured(ball), seen = meshing::contour_to_look_at(ball);
  EXPECT_EQ(seen.triangles, proven.triangles);
  EXPECT_EQ(seen.points_mm, proven.points_mm);
  EXPECT_EQ(seen.origin_mm, proven.origin_mm);
  EXPECT_THROW(meshing::contour_to_look_at(grid::Field(ball, -1.f)), Error);
}

TEST(Contour, SamplesAtTheIsovalue) {  // M1
  grid::Field f = sphere(20, 8);
  for (float& v : f.voxels) v = std::nearbyint(v);  // every level is hit exactly
  expect_valid(contoured(f), "rounded sphere");

  grid::Grid<std::int16_t> hu(lattice(16, 16, 16));
  Random random(1);
  for (auto& v : hu.voxels) v = static_cast<std::int16_t>(225 + 3 * random());  // 225, 226, 227
  meshing::ContourParams p = everything();
  p.isovalue_hu = 226;
  Report r;
  const surface::TriMesh m = value_of(r, meshing::contour(grid::HuVolume(hu), p));
  expect_valid(m, "integers");
  EXPECT_EQ(std::get<double>(*r.find("isovalue_hu")), 225.5);
  EXPECT_EQ(r.warnings.size(), 1u);

  grid::Grid<float> real(lattice(16, 16, 16));
  for (std::size_t i = 0; i < real.voxels.size(); ++i) real.voxels[i] = hu.voxels[i];
  Report q;
  expect_valid(value_of(q, meshing::contour(grid::HuVolume(real), p)), "reals equal to the isovalue");
  EXPECT_EQ(std::get<double>(*q.find("isovalue_hu")), 226);
}

TEST(Contour, ClosedAtTheBorder) {  // M2
  grid::Field f = sample(lattice(20, 20, 20), [](Vec3 p) { return 9 - norm(p - Vec3{0, 10, 12}); });
  const surface::TriMesh m = contoured(f);
  expect_valid(m, "half a sphere");
  EXPECT_NEAR(surface::bounds_of(m).min_mm.x, -0.5, 1e-4);  // the border of the first voxels
}

TEST(Contour, RefusesWhatHasNoSurface) {  // M3
  const auto mask = [](const std::function<bool(int, int, int)>& in) {
    return sample(lattice(8, 9, 10), [&](Vec3 p) { return in(int(p.x), int(p.y), int(p.z)) ? 0.5 : -0.5; });
  };
  EXPECT_NE(refusal([&] { contoured(mask([](int, int, int) { return false; })); }, ExitCode::quality)
                .find("contour: 0 of 720 voxels"),
            std::string::npos);
  EXPECT_NE(refusal([&] { contoured(mask([](int, int, int) { return true; })); }, ExitCode::quality)
                .find("720 of 720 voxels"),
            std::string::npos);
  EXPECT_NE(refusal([&] { contoured(mask([](int, int j, int) { return j == 4; })); }, ExitCode::quality)
                .find("80 of 720 voxels are inside, all in one slice"),
            std::string::npos);
}

TEST(Contour, HardConfigurations) {  // M4
  const auto of = [](const std::function<bool(int, int, int)>& in) {
    return sample(lattice(10, 10, 10), [&](Vec3 p) { return in(int(p.x), int(p.y), int(p.z)) ? 0.5 : -0.5; });
  };
  expect_valid(contoured(of([](int i, int j, int k) { return (i + j + k) % 2 == 0; })), "checkerboard");
  expect_valid(contoured(of([](int i, int j, int k) { return i % 2 == 0 && j % 2 == 0 && k % 2 == 0; })),
               "single voxels");
  expect_valid(
      contoured(of([](int i, int j, int k) { return (i == 4 && j == 4 && k == 4) || (i == 5 && j == 5 && k == 5); })),
      "touching at a corner");
  expect_valid(
      contoured(of([](int i, int j, int k) { return (i == 4 && j == 4 && k < 6) || (i == 5 && j == 5 && k < 6); })),
      "touching at an edge");
  // Every sign pattern of one cell, in the middle of a 4^3 grid.
  for (int signs = 1; signs < 256; ++signs) {
    grid::Field f(lattice(4, 4, 4), -0.5f);
    for (int c = 0; c < 8; ++c)
      if (signs >> c & 1) f.at(1 + (c & 1), 1 + (c >> 1 & 1), 1 + (c >> 2 & 1)) = 0.5f;
    try {
      expect_valid(contoured(f), "pattern " + std::to_string(signs));
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("one slice"), std::string::npos) << e.what();
    }
  }
}

void contour_noise(std::uint64_t seeds) {
  for (std::uint64_t seed = 0; seed < seeds; ++seed)
    for (const double fill : {0.02, 0.1, 0.25, 0.4, 0.6})
      for (const bool binary : {true, false})
        expect_valid(contoured(noise(12, seed, fill, binary)), "noise " + std::to_string(seed));
}

TEST(Contour, RandomNoise) { contour_noise(6); }  // M4: at most 1 % refused; none is
TEST(LongContour, RandomNoise) { contour_noise(200); }

TEST(Contour, RefusesWhatIsNotFinite) {  // M5
  grid::Field f = sphere(12, 5);
  f.at(3, 4, 5) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(refusal([&] { contoured(f); }, ExitCode::bad_input).find("voxel 3 4 5"), std::string::npos);
  f.at(3, 4, 5) = -std::numeric_limits<float>::infinity();
  refusal([&] { contoured(f); }, ExitCode::bad_input);
}

TEST(Contour, ScalesAndOffsets) {  // M6
  const double unit = surface::volume_mm3(contoured(sphere(24, 1)));
  for (const double scale : {1e-6, 1e-3, 1.0, 30.0, 1e3, 1e6})
    for (const double offset : {0.0, 1e6}) {
      const Vec3 centre{offset, -offset, offset};
      if (offset > 0 && scale < 1) continue;  // a lattice origin in doubles has no digits left for it
      const surface::TriMesh m = contoured(sphere(24, scale, centre));
      expect_valid(m, "scale " + std::to_string(scale));
      EXPECT_NEAR(surface::volume_mm3(m) / (unit * scale * scale * scale), 1, 1e-5) << scale << " " << offset;
    }
}

TEST(Contour, OutwardsInEitherHandedness) {
  grid::Field f = sphere(16, 5);
  f.direction.column = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
  expect_valid(contoured(f), "left-handed");
  const double c = std::cos(0.4), s = std::sin(0.4);
  f.direction.column = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
  expect_valid(contoured(f), "oblique");
}

TEST(Contour, CavitiesAndSmallPieces) {
  // A shell with a ball in its cavity, and a small ball beside it.
  const grid::Field f = sample(lattice(40, 24, 24), [](Vec3 p) {
    const double r = norm(p - Vec3{12, 12, 12});
    return std::max({std::min(10 - r, r - 7), 3 - r, 2.5 - norm(p - Vec3{32, 12, 12})});
  });
  EXPECT_EQ(surface::topology_of(contoured(f)).components, 4);
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  Report r;
  surface::TriMesh m = value_of(r, meshing::contour(f, p));
  EXPECT_EQ(surface::topology_of(m).components, 2);  // the cavity went, and the ball in it
  EXPECT_EQ(std::get<std::int64_t>(*r.find("cavities_dropped_count")), 2);
  EXPECT_NEAR(surface::volume_mm3(m), 4.0 / 3 * M_PI * (1000 + 15.6), 60);
  p.min_component_mm3 = 100;
  Report q;
  m = value_of(q, meshing::contour(f, p));
  EXPECT_EQ(surface::topology_of(m).components, 1);
  EXPECT_EQ(std::get<std::int64_t>(*q.find("small_components_dropped_count")), 1);
}

TEST(Contour, SameBytesWithAnyThreads) {
  const grid::Field f = noise(30, 7, 0.3, false);
  set_thread_count(1);
  const surface::TriMesh one = contoured(f);
  set_thread_count(2);
  const surface::TriMesh two = contoured(f);
  set_thread_count(0);
  EXPECT_TRUE(one.points_mm == two.points_mm && one.triangles == two.triangles && one.origin_mm == two.origin_mm);
}

}  // namespace
}  // namespace trephine
