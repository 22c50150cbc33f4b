// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/ventricle_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace trephine::head {
namespace {

constexpr double sure_ml = 0.3, least_ml = 0.1, near_mm = 3, near_share = 0.6;
constexpr double there_ml = 0.08;  ///< a part that holds less is missing
constexpr double streak_ml = 0.15;
constexpr double compressed_ratio = 0.25, compressed_ml = 0.6;

/// Calls with the template's coordinates of each voxel and its component.
template <class F>
void each(const mask::Components& pieces, const place::HeadPlace& place, F&& f) {
  mask::for_each_voxel(pieces, [&](int component, int i, int j, int k) {
    f(place.to_template(pieces.lattice.to_world_mm({double(i), double(j), double(k)})), std::size_t(component));
  });
}

double nearest_mm(Vec3 p) {
  return std::min({place::place_mm(place::Place::lateral_left, p), place::place_mm(place::Place::lateral_right, p),
                   place::place_mm(place::Place::third, p)});
}

}  // namespace

mask::BitMask believable_pieces(const mask::BitMask& found, const place::HeadPlace& place) {
  const mask::Components pieces = mask::components(found);
  std::vector<double> near(pieces.list.size(), 0);
  if (place.sure) each(pieces, place, [&](Vec3 p, std::size_t c) { near[c] += nearest_mm(p) <= near_mm; });
  std::vector<char> keep;
  for (std::size_t c = 0; c < near.size(); ++c) {
    const double voxels = double(pieces.list[c].voxels), ml = voxels * found.lattice().voxel_volume_mm3() / 1000;
    keep.push_back(ml >= sure_ml || (ml >= least_ml && (!place.sure || near[c] >= near_share * voxels)));
  }
  return mask::select(pieces, keep);
}

std::optional<Warning> warn_of_stubs(const mask::BitMask& cut_off, const mask::BitMask& ventricles) {
  mask::BitMask border = mask::at_least_ml(mask::components(cut_off, true), streak_ml);
  border &= mask::dilated_6(ventricles);
  if (!border.any()) return std::nullopt;
  const Vec3 at = mask::largest(mask::components(border, true)).centre_mm();
  return Warning{"stub_of_streak",
                 "a thin dark streak was cut off the ventricles at ({x_mm:.0f}, {y_mm:.0f}, {z_mm:.0f}) mm, as of a "
                 "catheter or a clip; what of it runs across them may be left as a stub: look there",
                 {{"x_mm", at.x}, {"y_mm", at.y}, {"z_mm", at.z}}};
}

std::optional<Warning> warn_of_streaks(const std::vector<mask::StreakedSlice>& slices, const grid::Lattice& lattice,
                                       const mask::BitMask& ventricles) {
  const grid::Box box = ventricles.bounds();
  const int first = int(std::lround(lattice.to_index(ventricles.lattice().to_world_mm({0, 0, 0})).z)) + box.begin[2];
  double worst_hu = 0, from_mm = 0, to_mm = 0;
  for (const mask::StreakedSlice& s : slices) {
    if (s.slice < first - 1 || s.slice > first + box.end[2] - box.begin[2]) continue;
    const double z = lattice.to_world_mm({0, 0, double(s.slice)}).z;
    from_mm = worst_hu > 0 ? std::min(from_mm, z) : z;
    to_mm = worst_hu > 0 ? std::max(to_mm, z) : z;
    worst_hu = std::max(worst_hu, s.rms_hu);
  }
  if (worst_hu == 0) return std::nullopt;
  return Warning{"streaks_cross_ventricles",
                 "streaks of {streaks_hu:.0f} HU cross the slices at z {from_mm:.0f} to {to_mm:.0f} mm, as of a holder "
                 "or fillings; they were taken off before the ventricles were sought, but what lies there is doubtful: "
                 "look there, or choose a series without them",
                 {{"streaks_hu", worst_hu}, {"from_mm", from_mm}, {"to_mm", to_mm}}};
}

Outcome<std::monostate, VentricleParts> measure_parts(const mask::BitMask& found, const place::HeadPlace& place) {
  Outcome<std::monostate, VentricleParts> out;
  const mask::Components pieces = mask::components(found);
  out.result.pieces_count = pieces.list.size();
  if (!place.sure) return out;
  enum Part { frontal, body, trigone, horns, parts };
  std::array<std::array<double, parts>, 2> ml{};
  double third = 0, third_x = 0;
  const double voxel_ml = found.lattice().voxel_volume_mm3() / 1000;
  each(pieces, place, [&](Vec3 p, std::size_t) {
    const double left = place::place_mm(place::Place::lateral_left, p),
                 right = place::place_mm(place::Place::lateral_right, p);
    if (place::place_mm(place::Place::third, p) < std::min(left, right)) {
      third += voxel_ml;
      third_x += voxel_ml * p.x;
      return;
    }
    const Part part = place::horns_mm(p) < 0 || p.z < 42 ? horns : p.y < -22 ? frontal : p.y < 14 ? body : trigone;
    ml[left < right ? 0 : 1][part] += voxel_ml;
  });
  std::array<double, 2> sum{};
  for (int side = 0; side < 2; ++side)
    for (const double v : ml[side]) sum[side] += v;
  VentricleSides& sides = out.result.sides.emplace(VentricleSides{sum[0], sum[1], third, sum[0] - sum[1], {}});
  if (third > 0) sides.third_shift_mm = third_x / third * place.scale.x;
  constexpr const char* side_names[2] = {"left", "right"};
  constexpr const char* part_names[3] = {"frontal horn", "body", "trigone"};
  for (int side = 0; side < 2; ++side)
    for (const Part part : {frontal, body, trigone}) {
      const double mine = ml[side][part], other = ml[1 - side][part];
      if (mine < there_ml)
        out.warnings.push_back({"no_part",
                                "no {part} of the {side} lateral ventricle found where it should be",
                                {{"part", part_names[part]}, {"side", side_names[side]}}});
      else if (mine < compressed_ratio * other && other > compressed_ml)
        out.warnings.push_back(
            {"compressed_part",
             "the {part} of the {side} lateral ventricle holds {part_ml:.1f} ml, the other side's {other_ml:.1f}",
             {{"part", part_names[part]}, {"side", side_names[side]}, {"part_ml", mine}, {"other_ml", other}}});
    }
  if (third < there_ml)
    out.warnings.push_back({"no_third_ventricle", "no third ventricle found where it should be", {}});
  return out;
}

}  // namespace trephine::head
