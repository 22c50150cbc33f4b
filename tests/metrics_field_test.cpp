// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "meshing/contour.h"

namespace trephine {
namespace {

constexpr double inner_mm = 8, outer_mm = 12;

grid::Lattice cube() {
  grid::Lattice l;
  l.size = {40, 40, 40};
  l.spacing_mm = {0.8, 0.8, 0.8};
  l.origin_mm = {-15.6, -15.6, -15.6};
  return l;
}

double shell(Vec3 p, double inner, double outer) { return std::max(norm(p) - outer, inner - norm(p)); }

grid::Field field_of(const grid::Lattice& l, double inner, double outer) {
  grid::Field f(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        f.at(i, j, k) = float(-shell(l.to_world_mm({double(i), double(j), double(k)}), inner, outer)) + 1e-4f;
  return f;
}

double figure(const Report& r, const char* name) { return std::get<double>(*r.find(name)); }

TEST(MeasureField, AShellThatIsTooThickOnEitherSide) {
  const grid::Lattice l = cube();
  const grid::Field truth = field_of(l, inner_mm, outer_mm);
  grid::Mask solid(l);
  for (std::size_t v = 0; v < solid.voxels.size(); ++v) solid.voxels[v] = truth.voxels[v] > 0;
  meshing::ContourParams all;
  all.keep_cavities = true;
  const surface::TriMesh mesh = meshing::contour(truth, all).value;
  metrics::FieldTruth t;
  t.solid = &solid;
  t.distance = [](Vec3 p) { return shell(p, inner_mm, outer_mm); };
  t.mesh = &mesh;
  t.is_inner = [](Vec3 p) { return norm(p) < 10; };
  // 0.3 mm too far in, 0.1 mm too far out; cropped as fields are.
  const grid::Field found = field_of(grid::cropped(l, {{3, 3, 3}, {37, 37, 37}}), inner_mm - 0.3, outer_mm + 0.1);
  const Report r = printed(figures_of(metrics::measure_field(found, t, 5000)), {});
  EXPECT_NEAR(figure(r, "inner_bias_mm"), 0.3, 0.03);
  EXPECT_NEAR(figure(r, "outer_bias_mm"), 0.1, 0.03);
  EXPECT_NEAR(figure(r, "width_bias_mm"), 0.4, 0.04);
  const double grown = (std::pow(12.1, 3) - std::pow(7.7, 3)) / (std::pow(12.0, 3) - std::pow(8.0, 3));
  EXPECT_NEAR(figure(r, "volume_difference_ratio"), grown - 1, 0.03);
  EXPECT_NEAR(figure(r, "dice_ratio"), 2 / (1 + grown), 0.015);
  EXPECT_NEAR(figure(r, "deviation_mean_mm"), 0.16, 0.04);
}

TEST(MeasureField, RefusesAnotherRaster) {
  const grid::Lattice l = cube();
  grid::Mask solid(l);
  solid.voxels[0] = 1;
  grid::Lattice other = l;
  other.origin_mm.x += 0.3;
  metrics::FieldTruth t;
  t.solid = &solid;
  try {
    metrics::measure_field(field_of(other, inner_mm, outer_mm), t, 1000);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
  }
}

}  // namespace
}  // namespace trephine
