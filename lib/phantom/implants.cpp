// SPDX-License-Identifier: GPL-3.0-or-later
// Where what was put in lies.
#include "phantom/implants.h"

#include <cmath>

#include "base/pi.h"
#include "phantom/model.h"

namespace trephine::phantom {
namespace {

constexpr double in_mm = 16, out_mm = 25;  ///< a hole's cutter, from the bone's outside
constexpr double under_scalp_mm = 2.2;
constexpr int nodes = 16;

struct Surfaces {
  const Model& model;
  Vec3 inside(Vec3 world) const {
    const PointD p = model.to_model(PointD{world.x, world.y, world.z});
    return {p.x, p.y, p.z};
  }
  /// Above 0 outside of the bone.
  double hull(Vec3 world) const {
    const Vec3 p = inside(world);
    const PointD m{std::sqrt(p.x * p.x + 2.25), p.y, p.z};
    return model.bone_hull(m, model.cranial_vault(m));
  }
  Vec3 outwards(Vec3 world) const {
    constexpr double h = 0.5;
    return normalized(Vec3{hull(world + Vec3{h, 0, 0}) - hull(world - Vec3{h, 0, 0}),
                           hull(world + Vec3{0, h, 0}) - hull(world - Vec3{0, h, 0}),
                           hull(world + Vec3{0, 0, h}) - hull(world - Vec3{0, 0, h})});
  }
  /// A radius about an axis in the model's coordinates, which an individual's size stretches.
  double radius_inside(Vec3 at, Vec3 axis, double radius_mm) const {
    const Vec3 u = normalized(axis), a = normalized(cross(u, std::abs(u.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})),
               b = cross(u, a);
    return radius_mm * std::sqrt(norm(inside(at + a) - inside(at)) * norm(inside(at + b) - inside(at)));
  }
  /// Where the ray first gets so far out of the bone.
  Vec3 leave(Vec3 from, Vec3 way, double level) const {
    const Vec3 u = normalized(way);
    double low = 0, high = 0;
    while (high < 250 && hull(from + u * high) < level) low = high, high += 1;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (hull(from + u * middle) < level ? low : high) = middle;
    }
    return from + u * high;
  }
};

}  // namespace

void Model::add_implants(const ImplantParams& is, const Landmarks& landmarks) {
  const auto landmark = [&](const std::string& name) {
    for (const auto& [known, at] : landmarks)
      if (known == name) return at;
    return Vec3{};
  };
  const Surfaces bone{*this};
  hard.catheter_hu = is.catheter_hu;
  const auto add = [&](bool left) {
    const double side = left ? 1 : -1;
    const std::string name = left ? "left" : "right";
    const Vec3 foramen = landmark("monro_" + name);
    const Vec3 over = landmark("kocher_" + name) + Vec3{side * is.lateral_mm, -is.anterior_mm, 0};
    ImplantTruth t;
    t.on_left = left;
    t.hole_mm = bone.leave(foramen, over - foramen, 0);
    t.hole_out = bone.outwards(t.hole_mm);
    t.hole_diameter_mm = is.hole_mm;
    const double hole = bone.radius_inside(t.hole_mm, t.hole_out, is.hole_mm / 2);
    hard.holes.push_back(
        {bone.inside(t.hole_mm - t.hole_out * in_mm), bone.inside(t.hole_mm + t.hole_out * out_mm), hole, hole});
    if (is.implants != Implants::burr_hole) {
      t.has_catheter = true;
      t.catheter_diameter_mm = is.catheter_mm;
      const Vec3 end = foramen + Vec3{is.aim_mm[0], is.aim_mm[1], is.aim_mm[2]}, way = t.hole_mm - end;
      const Vec3 aside = normalized(cross(way, Vec3{1, 0, 0}));
      for (int n = 0; n <= nodes; ++n) {
        const double a = double(n) / nodes;
        t.course_mm.push_back(end + way * a + aside * (is.bend_mm * 4 * a * (1 - a)));
      }
      const double radius = is.catheter_mm / 2;
      t.tip_mm = end + normalized(end - t.course_mm[1]) * radius;
      std::vector<Vec3> all = t.course_mm;
      const Vec3 start = bone.leave(foramen, way, under_scalp_mm) - foramen;
      const Vec3 leaves = over + Vec3{side * 12, 60, 0} - foramen;  // to the back, under the scalp
      for (int n = 0; n <= 6; ++n)
        all.push_back(bone.leave(foramen, start * (1 - n / 6.0) + leaves * (n / 6.0), under_scalp_mm));
      for (std::size_t n = 0; n + 1 < all.size(); ++n) {
        const double r = bone.radius_inside(all[n], all[n + 1] - all[n], radius);
        hard.catheter.push_back({bone.inside(all[n]), bone.inside(all[n + 1]), r, r});
      }
    }
    const Vec3 front = normalized(cross(cross(t.hole_out, Vec3{0, -1, 0}), t.hole_out)),
               across = cross(t.hole_out, front);
    if (is.air_ml > 0) {
      const double radius = std::cbrt(is.air_ml * 1000 * 3 / (4 * pi));
      hard.air.push_back({bone.inside(t.hole_mm + front * (10 + radius) - t.hole_out * (9 + 0.6 * radius)), radius});
    }
    for (int n = 0; n < is.staples_count; ++n) {
      const Vec3 over_hole = t.hole_mm + front * (6.0 * (n - 0.5 * (is.staples_count - 1))) + across * 9.0;
      hard.metal.push_back({bone.inside(bone.leave(foramen, over_hole - foramen, scalp_mm - 0.5)), 0.7});
      metal_world.push_back(to_world(hard.metal.back().centre));
    }
    implants.push_back(t);
  };
  add(is.on_left);
  if (is.implants == Implants::two_catheters) add(!is.on_left);
}

}  // namespace trephine::phantom
