// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "phantom/spine.h"
#include "scenes.h"
#include "trunk_samples.h"

namespace trephine::extremes {

Scene spine_on(const std::string& name, const grid::Lattice& l) {
  Scene s;
  s.name = name;
  const auto bone_mm = [](Vec3 p) {
    const double r = std::hypot(p.x, p.y), at = std::fabs(std::remainder(p.z, 30.0));
    const double body = std::min(11 - at, 16 - std::hypot(p.x, p.y + 24));
    const double arch = std::min(9 - at, 14 - r);
    return std::min(std::max(body, arch), r - 9);
  };
  s.volume = scan_of(l, [&](Vec3 p) { return blend(bone_mm(p), 1.5, 20, 600); });
  s.fields[""] = s.fields["bone"] = sampled(l, bone_mm);
  s.fields["canal"] = sampled(l, [](Vec3 p) { return 9 - std::hypot(p.x, p.y); });
  add_meshes(s);
  return s;
}

Scene lumbar_on(const std::string& name, const grid::Lattice& l) {
  phantom::SpineParams params;
  params.vertebrae_count = 2;
  const phantom::Spine spine(params);
  Scene s;
  s.name = name;
  s.volume = scan_of(l, [&](Vec3 p) { return blend(spine.bone(p), 1.5, 20, 600); });
  s.fields[""] = s.fields["bone"] = sampled(l, [&](Vec3 p) { return spine.bone(p); });
  s.fields["canal"] = sampled(l, [&](Vec3 p) { return spine.canal(p); });
  add_meshes(s);
  return s;
}

Scene chest_on(const std::string& name, const grid::Lattice& l) {
  Scene s;
  s.name = name;
  const auto clavicle_mm = [](Vec3 p) {
    std::vector<Vec3> line;
    for (double t = 0; t <= 1.01; t += 0.2)
      line.push_back({18 + 105 * t, -60 + 45 * t - 7 * std::sin(2 * M_PI * t), 10 + 22 * t});
    return 6 - bodies::to_line(line, {std::fabs(p.x), p.y, p.z});
  };
  const auto other_mm = [](Vec3 p) {
    const double sternum = std::min({11 - std::fabs(p.x), 6 - std::fabs(p.y + 62), 8 - p.z});
    const double ring = (std::hypot(p.x / 75, (p.y + 5) / 62) - 1) * 62;
    const double rib = 4 - std::hypot(ring, p.z + 20 - 0.3 * p.y);
    return std::max({sternum, 14 - std::hypot(p.x, p.y - 45), rib});
  };
  const auto bone_mm = [&](Vec3 p) { return std::max(clavicle_mm(p), other_mm(p)); };
  s.volume = scan_of(l, [&](Vec3 p) {
    const double body = (1 - std::hypot(p.x / 150, (p.y + 5) / 85)) * 85;
    const double lung = (1 - norm(Vec3{(std::fabs(p.x) - 28) / 22, (p.y + 2) / 40, (p.z + 60) / 45})) * 22;
    return blend(bone_mm(p), 3, blend(lung, 3, blend(body, 3, air_hu, soft_hu), -850), 600);
  });
  s.fields[""] = s.fields["bone"] = sampled(l, bone_mm);
  add_meshes(s);
  return s;
}

Scene head_on(const std::string& name, const grid::Lattice& l) {
  Scene s;
  s.name = name;
  const auto ellipsoid = [](Vec3 radii, Vec3 centre) {
    return [=](Vec3 p) {
      const Vec3 q = p - centre;
      return (1 - norm(Vec3{q.x / radii.x, q.y / radii.y, q.z / radii.z})) * std::min({radii.x, radii.y, radii.z});
    };
  };
  const auto skin = ellipsoid({78, 98, 92}, {0, 0, 30}), outer = ellipsoid({71, 91, 85}, {0, 0, 30}),
             brain = ellipsoid({64, 84, 78}, {0, 0, 30}), nose = ellipsoid({12, 16, 20}, {0, -95, -10});
  const auto ventricles = [&](Vec3 p) { return ellipsoid({9, 30, 14}, {16, 0, 45})({std::fabs(p.x), p.y, p.z}); };
  const auto head = [&](Vec3 p) { return std::max(skin(p), nose(p)); };
  const auto skull = [&](Vec3 p) { return std::min(outer(p), -brain(p)); };
  s.volume = scan_of(l, [&](Vec3 p) {
    return blend(ventricles(p), 3,
                 blend(brain(p), 3, blend(outer(p), 3, blend(head(p), 3, air_hu, soft_hu), bone_hu), 35), 8);
  });
  s.fields[""] = s.fields["skin"] = sampled(l, head);
  s.fields["skull"] = s.fields["bone"] = sampled(l, skull);
  s.fields["brain"] = s.fields["within"] = sampled(l, brain);
  s.fields["ventricles"] = sampled(l, ventricles);
  add_meshes(s);
  s.landmarks.landmarks = {landmark("nasion", {0, -95, 12}), landmark("inion", {0, 97, 15}),
                           landmark("tragus_left", {73, 0, -5}), landmark("tragus_right", {-73, 0, -5}),
                           landmark("vertex", {0, 0, 122})};
  s.landmarks.midsagittal.confidence = 1;
  s.cutters = {drill({30, -40, 100}, 7, 20)};
  return s;
}

}  // namespace trephine::extremes
