// SPDX-License-Identifier: GPL-3.0-or-later
#include "device/hand_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/joined.h"
#include "haptics/tool.h"

namespace trephine::device {

HandPath path_over(const contact::ContactVolume& contact, const contact::TouchableFaces& faces,
                   const HandPathParams& params) {
  const Vec3 back = normalized(Vec3{params.from[0], params.from[1], params.from[2]});
  if (back == Vec3{}) throw Error(ExitCode::bad_config, "", "from", "must have a length");
  const grid::Lattice& l = contact.volume().voxels;
  const Vec3 size{double(l.size[0]), double(l.size[1]), double(l.size[2])};
  const Vec3 middle = l.to_world_mm((size - Vec3{1, 1, 1}) * 0.5);
  const double reach = norm({size.x * l.spacing_mm.x, size.y * l.spacing_mm.y, size.z * l.spacing_mm.z});
  const Vec3 across = normalized(cross(back, std::abs(back.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 other = cross(back, across);
  HandPath path;
  path.axis = back;
  constexpr int turns = 720;
  for (int n = 0; n <= turns; ++n) {
    const double a = 2 * M_PI * (n % turns) / turns;
    const Vec3 at = middle + (across * std::cos(a) + other * std::sin(a)) * params.radius_mm;
    const contact::Contact c = contact.intersect(at + back * reach, at - back * reach, 0, faces);
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

HandPath drill_path(const contact::ContactVolume& contact, std::uint64_t drilled,
                    const std::vector<std::pair<std::string, Vec3>>& sites, double tool_radius_mm,
                    const HandPathParams& params) {
  const auto site = std::find_if(sites.begin(), sites.end(), [&](const auto& s) { return s.first == params.site; });
  if (site == sites.end()) {
    throw Error(ExitCode::usage, "", "--site",
                params.site + ": the case has no such place, but " +
                    joined(sites, ", ", [](const auto& s) { return s.first; }));
  }
  const grid::Lattice& l = contact.volume().voxels;
  const Vec3 middle = l.to_world_mm(Vec3{double(l.size[0]), double(l.size[1]), double(l.size[2])} * 0.5);
  Vec3 out = normalized(site->second - middle);
  const contact::TouchableFaces outer{drilled, 0}, inner{0, drilled};
  const auto from_above = [&](Vec3 at) { return contact.intersect(at + out * 25, at - out * 25, outer); };
  const contact::Contact first = from_above(site->second);
  if (!first.hit) throw Error(ExitCode::bad_input, "", params.site, "nothing that can be drilled lies there");
  // Across the surface: the mean normal of a disc as wide as the hole.
  const double hole = 0.5 * params.hole_diameter_mm;
  const auto ring = [&](const Mat3& frame, double radius, int n) {
    return (frame.column[0] * std::cos(0.25 * M_PI * n) + frame.column[1] * std::sin(0.25 * M_PI * n)) * radius;
  };
  Mat3 frame = haptics::frame_along(out);
  Vec3 mean = first.normal;
  for (int n = 0; n < 8; ++n)
    if (const contact::Contact c = from_above(first.point_mm + ring(frame, hole, n)); c.hit) mean += c.normal;
  out = normalized(mean);
  frame = haptics::frame_along(out);
  // Outer and inner table along the axis.
  double top = 0, bottom = 0;
  for (int n = 0; n < 17; ++n) {
    const Vec3 at = first.point_mm + ring(frame, n == 0 ? 0 : n < 9 ? hole : 0.5 * hole, n);
    const contact::Contact above = from_above(at);
    if (!above.hit) continue;
    top = std::max(top, dot(above.point_mm - first.point_mm, out));
    const contact::Contact below =
        contact.intersect(above.point_mm - out * 0.01, above.point_mm - out * 40, above.into, inner);
    if (below.hit) bottom = std::min(bottom, dot(below.point_mm - first.point_mm, out));
  }
  if (!(bottom < 0)) throw Error(ExitCode::bad_input, "", params.site, "what lies there is thicker than 40 mm");
  HandPath path;
  path.axis = out;
  path.shape = first.shape;
  const auto add = [&](double radius, double angle, double height) {
    path.points_mm.push_back(first.point_mm + out * height +
                             (frame.column[0] * std::cos(angle) + frame.column[1] * std::sin(angle)) * radius);
  };
  add(0, 0, top + params.approach_mm);
  const double widest = std::max(0.0, hole - tool_radius_mm);
  const int turns = widest > 0 ? std::max(1, int(std::ceil(widest / (0.5 * tool_radius_mm)))) + 1 : 0;
  const int layers = std::max(1, int(std::ceil((top + 0.5 - bottom + params.past_mm) / params.layer_mm)));
  double angle = 0;
  for (int n = 0; n <= layers; ++n) {
    const double height = top + 0.5 + (bottom - params.past_mm - top - 0.5) * n / layers;
    if (turns == 0) add(0, 0, height);
    constexpr int around = 24;
    for (int step = 0; step < turns * around; ++step, angle += 2 * M_PI / around) {
      const double share = std::min(1.0, double(step) / ((turns - 1) * around));  // the last turn is a circle
      const double back = std::max(0.0, double(step - around) / ((turns - 1) * around));
      add(widest * (n % 2 == 0 ? share : 1 - back), angle, height);
    }
  }
  path.loop_from = path.points_mm.size() - 1;
  return path;
}

}  // namespace trephine::device
