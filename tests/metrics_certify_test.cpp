// SPDX-License-Identifier: GPL-3.0-or-later
// The proven bound against distances known in closed form, and against dense samples.
#include "metrics/certify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing_shapes.h"
#include "metrics/deviation.h"
#include "picture/deviation_picture.h"

namespace trephine {
namespace {

using namespace shapes;

/// A cube of 10 mm whose top is a pyramid's mantle, its tip `height` above the face (or below it).
surface::TriMesh roofed(double height) {
  surface::TriMesh m;
  for (int c = 0; c < 8; ++c) m.points_mm.push_back({c & 1 ? 10. : 0., c & 2 ? 10. : 0., c & 4 ? 10. : 0.});
  m.points_mm.push_back({5, 5, 10 + height});
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2},
                 {2, 4, 6}, {1, 3, 5}, {3, 7, 5}, {4, 5, 8}, {5, 7, 8}, {7, 6, 8}, {6, 4, 8}};
  return m;
}

surface::TriMesh cube() {
  surface::TriMesh m = roofed(0);
  m.triangles.resize(10);
  m.triangles.push_back({4, 5, 6});
  m.triangles.push_back({5, 7, 6});
  return m;
}

metrics::CertifiedDeviation certified(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                                      double tolerance_mm) {
  metrics::CertifyParams p;
  p.certify_tolerance_mm = tolerance_mm;
  return metrics::certify_deviation(mesh, reference, p);
}

TEST(Certify, TheLargestDistanceBetweenThePoints) {
  // From the cube's flat top down to a dent 3 mm deep: largest in the middle of the face, where no point of it lies.
  const metrics::CertifiedDeviation d = certified(cube(), roofed(-3), 1e-3);
  const double exact = 3 * std::cos(std::atan(3.0 / 5));
  EXPECT_LE(d.mesh_to_reference.lower_mm, exact + 1e-9);
  EXPECT_GE(d.mesh_to_reference.upper_mm, exact);
  EXPECT_LE(d.mesh_to_reference.upper_mm - d.mesh_to_reference.lower_mm, 1e-3 + 1e-6);
  EXPECT_NEAR(norm(d.mesh_to_reference.at_mm - Vec3{5, 5, 10}), 0, 0.1);
  EXPECT_NEAR(d.reference_to_mesh.upper_mm, 3, 1e-3 + 1e-6);
  EXPECT_EQ(d.upper_mm(), std::max(d.mesh_to_reference.upper_mm, d.reference_to_mesh.upper_mm));
}

TEST(Certify, OfASurfaceWithItself) {
  const surface::TriMesh m = contoured(sphere(20, 10));
  EXPECT_LT(certified(m, m, 1e-4).upper_mm(), 1e-4 + 1e-6);
}

TEST(Certify, NeverBelowDenseSamples) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const surface::TriMesh a = contoured(noise(8, seed, 0.3, false));
    surface::TriMesh b = contoured(noise(8, seed + 100, 0.3, false));
    b.origin_mm.x += 0.25;
    const metrics::CertifiedDeviation d = certified(a, b, 0.01);
    metrics::DeviationParams p;
    p.sample_count = 100000;
    const metrics::Deviation s = metrics::measure_deviation(a, b, p);
    EXPECT_GE(d.mesh_to_reference.upper_mm, s.mesh_to_reference.max_mm);
    EXPECT_GE(d.reference_to_mesh.upper_mm, s.reference_to_mesh.max_mm);
    EXPECT_LE(d.upper_mm() - d.lower_mm(), 0.01 + 1e-6);
    // The samples come close to it, so it is not just large.
    EXPECT_LE(d.lower_mm(), s.both.max_mm + 0.05);
  }
}

TEST(Certify, RefusesNothing) {
  try {
    certified(cube(), surface::TriMesh(), 0.01);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    EXPECT_EQ(e.field(), "reference");
  }
}

TEST(Certify, GivesUpWhereTooManyPiecesAreNeeded) {
  metrics::CertifyParams p;
  p.certify_tolerance_mm = 1e-6;
  const surface::TriMesh a = contoured(sphere(20, 10)), b = contoured(sphere(14, 10));
  for (const int threads : {1, 2}) {
    set_thread_count(threads);
    p.certify_max_pieces_count = 20000;
    try {
      metrics::certify_deviation(a, b, p);
      FAIL() << threads;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::internal);
      EXPECT_NE(std::string(e.what()).find("20,000 pieces; set --certify-tolerance-mm"), std::string::npos);
    }
    p.certify_max_pieces_count = 1000000000;
    EXPECT_LE(metrics::certify_deviation(a, b, p).upper_mm() - metrics::certify_deviation(a, b, p).lower_mm(),
              1e-6 + 1e-6)
        << threads;
  }
  set_thread_count(0);
}

TEST(Certify, SameBitsWithAnyThreads) {
  const surface::TriMesh a = contoured(noise(10, 1, 0.3, false)), b = contoured(noise(10, 2, 0.3, false));
  set_thread_count(1);
  const metrics::CertifiedDeviation one = certified(a, b, 0.01);
  set_thread_count(2);
  const metrics::CertifiedDeviation two = certified(a, b, 0.01);
  set_thread_count(0);
  EXPECT_EQ(one.upper_mm(), two.upper_mm());
  EXPECT_EQ(one.lower_mm(), two.lower_mm());
}

TEST(DeviationPicture, RedOutsideBlueInside) {
  const surface::TriMesh reference = contoured(sphere(24, 10));
  const auto share = [&](double radius, int channel) {
    const picture::Image image = picture::deviation_picture(contoured(sphere(24, radius)), reference, 1);
    int strong = 0, all = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width - 110; ++x) {
        const std::uint8_t* p = image.at(x, y);
        if (std::abs(p[0] - p[2]) < 40) continue;
        ++all;
        strong += p[channel] > p[2 - channel];
      }
    return all > 0 ? double(strong) / all : 0;
  };
  EXPECT_GT(share(11, 0), 0.95);
  EXPECT_GT(share(9, 2), 0.95);
  const std::vector<double> d = picture::signed_deviations_mm(contoured(sphere(24, 11)), reference);
  for (const double v : d) EXPECT_NEAR(v, 1, 0.06);
}

}  // namespace
}  // namespace trephine
