// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/model.h"

#include "base/pi.h"
#include "phantom/random.h"

namespace trephine::phantom {
namespace {

/// Mastoid cells: balls within the process, apart from each other, drawn by dart throwing.
std::vector<Model::Ball> mastoid_cells(std::uint64_t seed) {
  std::vector<Model::Ball> cells;
  for (int side = -1; side <= 1; side += 2) {
    const std::size_t first = cells.size();
    for (int dart = 0; dart < 400 && cells.size() < first + 12; ++dart) {
      const std::uint64_t n = (side > 0 ? 0 : 10000) + 4 * dart;
      const Vec3 u{uniform(seed, 1, n), uniform(seed, 1, n + 1), uniform(seed, 1, n + 2)};
      if (norm(u) > 1) continue;
      Model::Ball ball{{side * (54 + 7 * u.x), 17 + 9 * u.y, -9 + 13 * u.z}, 2.1 + 0.8 * uniform(seed, 1, n + 3)};
      bool free = true;
      for (std::size_t i = first; i < cells.size(); ++i)
        free = free && norm(cells[i].centre - ball.centre) > cells[i].radius + ball.radius + 0.6;
      if (free) cells.push_back(ball);
    }
  }
  return cells;
}

/// What ventricles() and passages() are worth at least.
void bound_shapes(Model& m) {
  const auto add = [&](const Model::Node& n) {  // and its mirror image
    for (const double side : {-1.0, 1.0})
      m.ventricles_within.add({side * n.at.x, n.at.y, n.at.z}, {n.radius, n.radius, n.radius});
  };
  for (const Model::Node& n : m.lateral) add(n);
  for (const Model::Node& n : m.temporal_horn) add(n);
  add(m.monro_top);
  add(m.monro_bottom);
  m.ventricles_within.add(m.third_centre, m.third_radii);
  m.ventricles_within.ratio = 0.75;
  m.ventricles_within.slack_mm = 0.5 * double(m.lateral.size() + m.temporal_horn.size());
  m.passages_within.add(m.passages_start, {1.1, 1.1, 1.1});
  m.passages_within.add({0, 31, 4}, {7.5, 5, 11});
  m.passages_within.add({0, 45, -11}, {1.2, 1.2, 1.2});
  m.passages_within.ratio = 0.7;
  m.passages_within.slack_mm = 1;
}

}  // namespace

Model::Model(const HeadParams& params) : clinical(params.level != Level::simple) {
  const std::uint64_t seed = static_cast<std::uint64_t>(params.seed);
  std::uint64_t draws = 0;
  const auto draw = [&](double mean, double half_range) { return mean + half_range * uniform(seed, 0, draws++); };

  scale = {draw(1, 0.03), draw(1, 0.03), draw(1, 0.03)};
  lean = draw(0, 0.02);
  skew = draw(0, 0.02);
  scalp_mm = draw(5.5, 0.5);
  bone_mm = draw(6.8, 0.6);
  csf_mm = draw(2.4, 0.3);
  nose = draw(1, 0.1);
  jaw = draw(1, 0.04);
  for (double& p : phase) p = draw(0, pi);
  const double size = draw(1, 0.06);

  // Radii of the lateral ventricle, of the third, of the foramen of Monro; a dilated ventricle also lies farther out.
  double lateral_scale = 1, third_scale = 1, monro_radius = 1.9;
  switch (params.variant) {
    case Variant::hydrocephalic:
      lateral_scale = 2.0, third_scale = 2.4, monro_radius = 3.4;
      break;
    case Variant::small:
      lateral_scale = 0.64, third_scale = 0.72, monro_radius = 1.5;
      break;
    case Variant::slit:
      lateral_scale = 0.38, third_scale = 0.5, monro_radius = 1.1;
      break;
    case Variant::shifted:
      shift_mm = 8;
      break;
    case Variant::normal:
      break;
  }
  lateral_scale *= size;
  third_scale *= size;
  cells = mastoid_cells(seed);
  if (clinical) fillings = {{-22.5, -75, -47}};

  // The x of a node leaves its radius and half of the septum beside the midline, and grows with the dilation.
  const double r = lateral_scale, out = 4 * (lateral_scale - 1);
  const auto node = [&](double x, double y, double z, double radius) {
    return Node{{std::max(x + out, radius * r + 1.3), y, z}, radius * r};
  };
  lateral = {node(12.5, -44, 56, 3.4), node(8.5, -30, 60, 5.2), node(6.5, -13, 61, 5.0), node(9, 4, 64, 4.6),
             node(17, 22, 62, 5.0),    node(24.5, 34, 55, 6.6), node(24.5, 48, 49, 4.0), node(22.5, 58, 47, 2.2)};
  temporal_horn = {lateral[5], node(31, 26, 44, 3.2), node(34, 8, 31, 2.5), node(33, -8, 26, 2.0)};
  // The third ventricle: a slit in the midline under the bodies, whose roof stays clear of theirs.
  third_radii = {2.2 * third_scale, 13.0, 9.5};
  third_centre = {0, -2, 61 - 5.0 * r - 3.2 - 9.5};
  thalamus_centre = {third_radii.x + 8.5, 4, third_centre.z + 1};
  monro_top = {{lateral[2].at.x - 0.25 * lateral[2].radius, -13.5, 61 - 0.72 * 5.0 * r}, monro_radius};
  monro_bottom = {{0.4, -11, third_centre.z + 5.5}, monro_radius};
  passages_start = {0, third_centre.y + third_radii.y - 3.5, third_centre.z - 3};
  bound_shapes(*this);
  if (params.level == Level::hard) make_hard(params);
  for (const Vec3& f : fillings) metal_world.push_back(to_world(f));
  for (const Ball& b : hard.metal) metal_world.push_back(to_world(b.centre));
}

Vec3 Model::to_world(Vec3 model) const {
  // x + lean x^2 / 100 is inverted by iteration: its slope differs from 1 by a few percent.
  double x = model.x;
  for (int i = 0; i < 40; ++i) x = model.x - x * x * lean / 100;
  Vec3 world{x * scale.x, (model.y - x * skew) * scale.y, model.z * scale.z};
  if (hard.moves) {
    const PointD p = unmoved(PointD{world.x, world.y, world.z});  // the shift depends on z alone
    world += world - Vec3{p.x, p.y, p.z};
  }
  return world;
}

}  // namespace trephine::phantom
