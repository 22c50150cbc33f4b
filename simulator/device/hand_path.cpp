// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/hand_path.h"

#include <cmath>

#include "base/error.h"

namespace trephine {

HandPath path_over(const ContactVolume& contact, const TouchableFaces& faces, const HandPathParams& params) {
  const Vec3 back = normalized(Vec3{params.from[0], params.from[1], params.from[2]});
  if (back == Vec3{}) throw Error(ExitCode::bad_config, "", "from", "must have a length");
  const Lattice& l = contact.volume().voxels;
  const Vec3 size{double(l.size[0]), double(l.size[1]), double(l.size[2])};
  const Vec3 middle = l.to_world_mm((size - Vec3{1, 1, 1}) * 0.5);
  const double reach = norm({size.x * l.spacing_mm.x, size.y * l.spacing_mm.y, size.z * l.spacing_mm.z});
  const Vec3 across = normalized(cross(back, std::abs(back.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 other = cross(back, across);
  HandPath path;
  constexpr int turns = 720;
  for (int n = 0; n <= turns; ++n) {
    const double a = 2 * M_PI * (n % turns) / turns;
    const Vec3 at = middle + (across * std::cos(a) + other * std::sin(a)) * params.radius_mm;
    const Contact c = contact.intersect(at + back * reach, at - back * reach, 0, faces);
    if (!c.hit) continue;
    if (path.points_mm.empty()) {
      path.shape = c.shape;
      path.points_mm.push_back(c.point_mm + back * params.approach_mm);
      path.loop_from = 1;
    }
    path.points_mm.push_back(c.point_mm - back * params.depth_mm);
  }
  if (path.points_mm.empty())
    throw Error(ExitCode::bad_config, "", "from", "no surface that can be felt lies that way");
  return path;
}

}  // namespace trephine
