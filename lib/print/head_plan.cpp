// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "base/refusal.h"
#include "mask/filters.h"
#include "print/head_parts.h"

namespace trephine::print {
namespace {

constexpr double around_mm = 22;            ///< of bone: room for marks and rims
constexpr double below_mm = 8;              ///< the cut: what bone is there says how thick it is above
constexpr double ring_gap_mm = 8;           ///< holes and clefts of the ring up to twice this width are closed
constexpr double least_inside_ratio = 0.4;  ///< of the ring's filled area
/// Of the balls' radius: what the raster, and evening it out, take off a wall.
constexpr double spare_mm = 0.15, spare_voxels = 0.3;
constexpr double normal_reach_mm = 1.5, normal_about_mm = 7;
constexpr int normals = 12;

// What a flood from the slice's corner does not reach.
mask::BitMask filled(const mask::BitMask& walls) {
  mask::BitMask open = walls;
  open.invert();
  const mask::Components pieces = mask::components(open);
  std::vector<char> outer(pieces.list.size(), 0);
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int) {
    const auto& size = walls.lattice().size;
    if (i == 0 || j == 0 || i == size[0] - 1 || j == size[1] - 1) outer[std::size_t(c)] = 1;
  });
  mask::BitMask out = mask::select(pieces, outer);
  return out.invert();
}

void find_ring(HeadPlan& plan) {
  const Solid& bone = plan.bone;
  plan.flat = bone;
  plan.flat.size[2] = 1;
  plan.flat.origin_mm.z = 0;
  plan.rim_bone = Solid(plan.flat, float(nowhere_mm));
  for (int k = 0; k < bone.size[2]; ++k) {
    const double z = bone.to_world_mm({0, 0, double(k)}).z;
    if (z < -0.5 * bone.spacing_mm.z || z > plan.rim_mm() + plan.params.gap_mm + bone.spacing_mm.z) continue;
    for (int j = 0; j < bone.size[1]; ++j)
      for (int i = 0; i < bone.size[0]; ++i)
        plan.rim_bone.at(i, j, 0) = std::max(plan.rim_bone.at(i, j, 0), bone.at(i, j, k));
  }
  const mask::BitMask walls = mask::positive(plan.rim_bone, plan.flat);
  const mask::BitMask closed = mask::closed(walls, ring_gap_mm);
  plan.ring_filled = filled(closed);
  plan.ring_inside = mask::without(plan.ring_filled, closed);
  if (double(plan.ring_inside.count()) < least_inside_ratio * double(plan.ring_filled.count()))
    throw refusal("cut_above_mm", "at the cut the bone makes no closed ring, so that nothing holds a base",
                  {"set another height of the cut (`cut_above_mm`)"});
}

}  // namespace

Solid one_piece(const HeadPlan& plan, const Solid& solid, const std::string& part, const Progress& progress) {
  Solid out = with_walls(solid, plan.ball_mm, plan.params.wall_mm, progress);
  if (const double crumbs_ml = keep_largest(out); crumbs_ml > most_crumbs_ml)
    throw refusal(part, fmt::format("{:.1f} ml of it would hang on nothing", crumbs_ml),
                  {"set a smaller least wall and a finer raster (`wall_mm`, `voxel_mm`)"});
  return out;
}

HeadPlan plan_head(const cases::LoadedCase& loaded, const PrintParams& params, const Progress& progress) {
  HeadPlan plan{loaded,
                params,
                frame_of(loaded, params.cut_above_mm),
                params.wall_mm / 2 + spare_mm + spare_voxels * params.voxel_mm,
                {},
                {},
                {},
                {},
                {},
                {},
                0};
  const FeltShape skull(loaded, plan.frame, "skull");
  if (params.ventricles != Ventricles::none) FeltShape(loaded, plan.frame, "ventricles");  // before all the work
  surface::Bounds box = skull.bounds(-below_mm);
  if (box.min_mm.z > -0.5 * below_mm)
    throw Error(ExitCode::bad_input, "case.json", "haptic",
                "the felt bone ends above the cut of the print; set a higher `cut_above_mm`");
  for (int a = 0; a < 3; ++a) {
    box.min_mm[a] -= around_mm;
    box.max_mm[a] += around_mm;
  }
  box.min_mm.z = -below_mm;
  Solid bone(lattice_over(box, params.voxel_mm));
  change(bone, [&](Vec3 p, double) { return skull(p); });
  // What hangs together above the cut; vertebrae and the like below it do not.
  mask::BitMask above = mask::make_mask(bone, [&](int j, int k, std::uint8_t* row) {
    const bool over = bone.to_world_mm({0, 0, double(k)}).z >= 0;
    for (int i = 0; i < bone.size[0]; ++i) row[i] = over && bone.at(i, j, k) > 0;
  });
  const std::size_t all = above.count();
  above = mask::largest(mask::components(above));
  plan.dropped_ml = double(all - above.count()) * bone.voxel_volume_mm3() / 1000;
  for (int k = 0; k < bone.size[2]; ++k) {
    if (bone.to_world_mm({0, 0, double(k)}).z < 0) continue;
    for (int j = 0; j < bone.size[1]; ++j)
      for (int i = 0; i < bone.size[0]; ++i)
        if (bone.at(i, j, k) > 0 && !above.get(i, j, k)) bone.at(i, j, k) = -0.5f;
  }
  const Vec3 middle = above.centre_mm();
  plan.middle_mm = {middle.x, middle.y, middle.z * 0.6};
  bone = as_distances(bone, progress.part(0, 0.3));
  plan.bone = thickened(bone, plan.thick_mm() / 2, progress.part(0.3, 1));
  find_ring(plan);
  return plan;
}

std::optional<OuterPlace> outer_place(const HeadPlan& plan, Vec3 way) {
  const Vec3 u = normalized(way);
  const double step = 0.25 * plan.bone.spacing_mm.x;
  double before = nowhere_mm;
  for (double d = 160; d > 10; d -= step) {
    const Vec3 p = plan.middle_mm + u * d;
    const double now = at(plan.bone, p);
    if (now >= 0) {
      OuterPlace place;
      place.at_mm = p + u * (before > nowhere_mm / 2 && now > before ? step * now / (now - before) : 0);
      const Vec3 a = normalized(cross(u, std::abs(u.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})), b = cross(u, a);
      Vec3 sum = -normalized(slope(plan.bone, place.at_mm, normal_reach_mm));
      for (int n = 0; n < normals; ++n) {
        const double turn = 6.283185307179586 * n / normals;
        const Vec3 beside =
            place.at_mm + a * (normal_about_mm * std::cos(turn)) + b * (normal_about_mm * std::sin(turn));
        for (double t = 8; t > -8; t -= step)
          if (at(plan.bone, beside + u * t) >= 0) {
            sum -= normalized(slope(plan.bone, beside + u * t, normal_reach_mm));
            break;
          }
      }
      place.out = normalized(sum);
      if (dot(place.out, u) < 0.5) place.out = u;
      return place;
    }
    before = now;
  }
  return {};
}

}  // namespace trephine::print
