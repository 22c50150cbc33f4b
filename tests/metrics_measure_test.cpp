// SPDX-License-Identifier: GPL-3.0-or-later
// What `measure` says of a surface.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "metrics/measure.h"
#include "metrics/quality.h"
#include "surface_shapes.h"

namespace trephine {
namespace {

double number(const Report& r, const std::string& name) {
  const ParameterValue* v = r.find(name);
  EXPECT_NE(v, nullptr) << name;
  if (!v) return NAN;
  if (const auto* i = std::get_if<std::int64_t>(v)) return double(*i);
  if (const auto* b = std::get_if<bool>(v)) return *b;
  return std::get<double>(*v);
}

TEST(Quality, CubeAndEquilateral) {
  const metrics::MeshMeasures m = metrics::measure_mesh(shapes::box({1, 1, 1}, {3, 3, 3}));
  EXPECT_DOUBLE_EQ(m.area_mm2, 24);
  EXPECT_DOUBLE_EQ(m.volume_mm3, 8);
  EXPECT_EQ(m.topology.edges, 18u);
  EXPECT_DOUBLE_EQ(m.edge_length_mm.min, 2);
  EXPECT_DOUBLE_EQ(m.edge_length_mm.median, 2);
  EXPECT_DOUBLE_EQ(m.edge_length_mm.max, std::sqrt(8.0));
  const double right = (2 + std::sqrt(2.0)) * std::sqrt(2.0) / (2 * std::sqrt(3.0));
  EXPECT_NEAR(m.aspect_ratio.min, right, 1e-12);
  EXPECT_NEAR(m.aspect_ratio.max, right, 1e-12);

  surface::TriMesh t;
  t.points_mm = {{0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0), 0}, {5, 0, 0}};
  t.triangles = {{0, 1, 2}, {0, 1, 3}};  // and one without area
  const metrics::MeshMeasures e = metrics::measure_mesh(t);
  EXPECT_NEAR(e.aspect_ratio.max, 1, 1e-12);
  EXPECT_EQ(e.topology.degenerate_triangles, 1u);
}

TEST(Measure, AloneAndAgainstAMesh) {
  const surface::TriMesh m = shapes::sphere(5, 30.1), reference = shapes::sphere(5, 30);
  const Report alone = printed(metrics::measure_surface(m, {}));
  EXPECT_EQ(number(alone, "triangles_count"), 20480);
  EXPECT_EQ(number(alone, "genus_count"), 0);
  EXPECT_EQ(number(alone, "components_count"), 1);
  EXPECT_EQ(number(alone, "valid"), 1);
  EXPECT_EQ(number(alone, "self_intersections_count"), 0);
  EXPECT_EQ(alone.find("deviation_max_mm"), nullptr);
  EXPECT_TRUE(alone.warnings.empty());

  const Report r = printed(metrics::measure_surface(m, metrics::MeshReference{&reference}));
  EXPECT_NEAR(number(r, "deviation_rms_mm"), 0.1, 0.02);
  EXPECT_NEAR(number(r, "deviation_bias_mm"), 0.1, 0.02);
  EXPECT_NEAR(number(r, "volume_difference_ratio"), std::pow(30.1 / 30, 3) - 1, 1e-9);
  EXPECT_EQ(number(r, "samples_count"), 2.0 * std::floor(surface::area_mm2(m)));
}

TEST(Measure, SmallSurfacesHaveFewerSamples) {
  const auto samples = [](double radius_mm, int asked) {
    const surface::TriMesh m = shapes::sphere(3, radius_mm);
    metrics::MeasureParams p;
    p.sample_count = asked;
    return number(printed(metrics::measure_surface(m, metrics::MeshReference{&m}, p)), "samples_count");
  };
  EXPECT_EQ(samples(10, 100000), 2 * 10000);
  EXPECT_EQ(samples(100, 100000), 2 * 100000);
  EXPECT_EQ(samples(10, 2000), 2 * 2000);
}

TEST(Measure, AgainstLabels) {
  grid::Mask labels{[] {
    grid::Lattice l;
    l.size = {60, 60, 60};
    l.origin_mm = {-30, -30, -30};
    return l;
  }()};
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) labels.at(i, j, k) = norm({i - 30.0, j - 30.0, k - 30.0}) <= 20 ? 2 : 0;
  const surface::TriMesh m = shapes::sphere(5, 20);
  const Report r = printed(metrics::measure_surface(m, metrics::LabelReference{&labels, 2}));
  EXPECT_GT(number(r, "dice_ratio"), 0.99);
  EXPECT_LT(number(r, "deviation_max_mm"), 0.9);   // a voxel's half diagonal
  EXPECT_LT(number(r, "deviation_rms_mm"), 0.35);  // the uniform error of a voxel's edge is 0.29
  EXPECT_NEAR(number(r, "volume_difference_ratio"), 0, 0.01);
  EXPECT_THROW(metrics::measure_surface(m, metrics::LabelReference{&labels, 3}), Error);
}

TEST(Measure, AgainstTheTruth) {
  const surface::TriMesh m = shapes::sphere(5, 20.2), truth = shapes::sphere(6, 20);
  const Report r =
      printed(metrics::measure_surface(m, metrics::TruthReference{[](Vec3 p) { return norm(p) - 20; }, &truth}));
  EXPECT_NEAR(number(r, "to_reference_rms_mm"), 0.2, 0.01);
  EXPECT_NEAR(number(r, "from_reference_rms_mm"), 0.2, 0.01);
  EXPECT_NEAR(number(r, "deviation_bias_mm"), 0.2, 0.01);
}

TEST(Measure, SaysWhatIsWrong) {
  surface::TriMesh open = shapes::sphere(3, 20);
  open.triangles.pop_back();
  const surface::TriMesh reference = shapes::sphere(3, 20);
  const Report r = printed(metrics::measure_surface(open, metrics::MeshReference{&reference}));
  EXPECT_EQ(number(r, "closed"), 0);
  EXPECT_EQ(number(r, "valid"), 0);
  EXPECT_EQ(r.warnings.size(), 2u);

  // Two spheres through each other.
  surface::TriMesh crossed = shapes::sphere(2, 10);
  const auto shift = std::uint32_t(crossed.points_mm.size());
  for (std::uint32_t i = 0; i < shift; ++i) crossed.points_mm.push_back(crossed.points_mm[i] + Vec3{7.03, 0.02, 0.01});
  const auto triangles = crossed.triangles;
  for (const auto& t : triangles) crossed.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  const Report c = printed(metrics::measure_surface(crossed, {}));
  EXPECT_EQ(number(c, "components_count"), 2);
  EXPECT_GT(number(c, "self_intersections_count"), 10);
  EXPECT_EQ(number(c, "valid"), 0);
  EXPECT_FALSE(metrics::measure_surface(crossed, {},
                                        [] {
                                          metrics::MeasureParams p;
                                          p.validity = false;
                                          return p;
                                        }())
                   .result.validity.has_value());
  EXPECT_THROW(metrics::measure_surface(surface::TriMesh{}, {}), Error);
}

}  // namespace
}  // namespace trephine
