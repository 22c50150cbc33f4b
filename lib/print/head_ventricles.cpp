// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/refusal.h"
#include "mask/filters.h"
#include "print/head_parts.h"

namespace trephine::print {
namespace {

constexpr double channel_radius_mm = 1.75;  ///< of the stem, to the outside
constexpr double into_mm = 4;               ///< of the stem, beyond where it meets the ventricles
constexpr double collar_mm = 4;             ///< height of what rests on the base; its width beyond the stem
constexpr double into_void_mm = 0.5;        ///< of the channel
constexpr double spare_mm = 0.4;            ///< by which necks between pieces are wider than a wall
constexpr double least_piece_ml = 0.2;
constexpr double foot_weight = 0.7;  ///< of how far a stem stands from the middle, against how low it meets

double to_segment_mm(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double t = std::clamp(dot(p - a, d) / std::max(1e-9, dot(d, d)), 0.0, 1.0);
  return norm(p - a - d * t);
}

// Pieces of what is printed of a solid that do not hang together, such as lateral ventricles whose foramen the scan
// does not show, get a rod between their nearest places in it.
int bridged(Solid& solid, const Solid& printed, double radius_mm) {
  const mask::BitMask all = inside_of(printed);
  const mask::Components pieces = mask::components(all);
  mask::BitMask whole = mask::largest(pieces);
  int bridges = 0;
  const double voxel_ml = solid.voxel_volume_mm3() / 1000;
  std::vector<std::pair<Vec3, Vec3>> rods;
  for (std::size_t c = 0; c < pieces.list.size(); ++c) {
    if (double(pieces.list[c].voxels) * voxel_ml < least_piece_ml) continue;
    std::vector<char> only(pieces.list.size(), 0);
    only[c] = 1;
    mask::BitMask piece = mask::select(pieces, only);
    if (mask::both(piece, whole).any()) continue;
    const grid::Grid<float> off = mask::distance_mm(whole);
    Vec3 from;
    double least = 1e9;
    mask::for_each_voxel(pieces, [&](int of, int i, int j, int k) {
      if (std::size_t(of) != c || off.at(i, j, k) >= least) return;
      least = off.at(i, j, k);
      from = solid.to_world_mm({double(i), double(j), double(k)});
    });
    const Solid grown = off;  // its slope leads away from the whole
    Vec3 to = from - normalized(slope(grown, from, solid.spacing_mm.x)) * (least + 2 * radius_mm);
    const Vec3 way = normalized(to - from);
    rods.emplace_back(from - way * (2 * radius_mm), to);
    whole |= piece;
    ++bridges;
  }
  change(solid, [&](Vec3 p, double d) {
    for (const auto& [a, b] : rods) d = std::max(d, radius_mm - to_segment_mm(p, a, b));
    return d;
  });
  return bridges;
}

// The column in which a stem reaches the ventricles low and near their middle, past no bone: its height.
std::optional<Vec3> stem_top(const HeadPlan& plan, const Solid& ventricles, double clear_mm, double deep_mm) {
  const Vec3 middle = inside_of(ventricles).centre_mm();
  std::optional<Vec3> best;
  double least = 1e9;
  for (int j = 0; j < ventricles.size[1]; ++j)
    for (int i = 0; i < ventricles.size[0]; ++i) {
      for (int k = 0; k < ventricles.size[2]; ++k) {
        const Vec3 p = ventricles.to_world_mm({double(i), double(j), double(k)});
        if (p.z >= 0 && at(plan.bone, p) > -clear_mm) break;  // bone under them
        if (ventricles.at(i, j, k) < deep_mm) continue;
        const Vec3 off = p - middle;
        const double cost = p.z + foot_weight * std::hypot(off.x, off.y);
        const Vec3 foot = plan.flat.to_index({p.x, p.y, 0});
        const bool within = plan.ring_inside.at(int(std::lround(foot.x)), int(std::lround(foot.y)), 0) &&
                            at(plan.rim_bone, {p.x, p.y, 0}) < -(clear_mm + plan.params.wall_mm + 6);
        if (within && cost < least) {
          least = cost;
          best = p;
        }
        break;
      }
    }
  return best;
}

// What is hollow and drains into the channel; a pocket that does not is filled.
Solid hollow_of(const Solid& outer, double shell_mm, Vec3 top) {
  Solid inner = as_distances(outer);
  change(inner, [&](Vec3 p, double d) {
    const double off = std::hypot(p.x - top.x, p.y - top.y);
    const double channel = p.z <= top.z ? channel_radius_mm - off : nowhere_mm;
    return std::max(d - shell_mm, channel);
  });
  keep_largest(inner);
  return inner;
}

}  // namespace

VentriclesPart ventricles_part(const HeadPlan& plan, const Progress& progress) {
  const FeltShape felt(plan.loaded, plan.frame, "ventricles");
  const double ball = plan.ball_mm, shell = plan.thick_mm();
  const bool is_hollow = plan.params.ventricles == Ventricles::hollow;
  VentriclesPart made;
  made.stem_radius_mm = is_hollow ? channel_radius_mm + shell : std::max(3.5, shell / 2);
  made.collar_radius_mm = made.stem_radius_mm + collar_mm;
  const double from_z_mm = plan.params.gap_mm + collar_mm + shell;  // lower down they would grow onto the collar
  surface::Bounds box = felt.bounds(from_z_mm);
  const double room = std::max(made.collar_radius_mm, ball) + 4;
  for (int a = 0; a < 3; ++a) {
    box.min_mm[a] -= room;
    box.max_mm[a] += room;
  }
  box.min_mm.z = -plan.plate_mm() - 3;
  std::array<double, 3> colour{0.25, 0.5, 0.9};
  if (const cases::CaseAnatomy* a = plan.loaded.manifest.find_anatomy("ventricles")) colour = a->colour_rgb;
  made.part = {"ventricles", colour, Solid(lattice_over(box, plan.params.voxel_mm))};
  Solid& solid = made.part.solid;
  change(solid, [&](Vec3 p, double) { return std::min(felt(p), p.z - from_z_mm); });
  solid = thickened(as_distances(solid, progress.part(0, 0.2)), shell / 2, progress.part(0.2, 0.5));
  made.bridges = bridged(solid, opened(solid, shell / 2 + spare_mm), shell / 2 + 1.5 * spare_mm);
  // Beside bone there is no room for what was made thicker.
  change(solid, [&](Vec3 p, double d) { return std::min(d, -at(plan.bone, p) - plan.params.gap_mm - 0.2); });
  const auto top = stem_top(plan, solid, made.stem_radius_mm + 0.5, is_hollow ? shell + into_void_mm : 0.5);
  if (!top)
    throw refusal(
        "ventricles",
        is_hollow ? "they are too narrow to be hollow where a stem from the base reaches them"
                  : "no stem from the base reaches them past the bone",
        {is_hollow ? "print them as a core (`ventricles`: core), or set a smaller `wall_mm` and `voxel_mm`"
                   : "leave them out (`ventricles`: none), or set another height of the cut (`cut_above_mm`)"});
  made.stem_mm = {top->x, top->y, 0};
  const double gap = plan.params.gap_mm;
  change(solid, [&](Vec3 p, double d) {
    const double off = std::hypot(p.x - top->x, p.y - top->y);
    const double stem =
        std::min({made.stem_radius_mm - off, p.z + plan.plate_mm(), (is_hollow ? top->z : top->z + into_mm) - p.z});
    const double collar = std::min({made.collar_radius_mm - off, p.z - gap, gap + collar_mm - p.z});
    return std::max({d, stem, collar});
  });
  solid = one_piece(plan, solid, made.part.name, progress.part(0.5, 0.8));
  if (is_hollow) {
    const Solid inner = hollow_of(solid, shell, *top);
    for (std::size_t n = 0; n < solid.voxels.size(); ++n) solid.voxels[n] = std::min(solid.voxels[n], -inner.voxels[n]);
    solid = one_piece(plan, solid, made.part.name, progress.part(0.8, 1));
  }
  return made;
}

}  // namespace trephine::print
