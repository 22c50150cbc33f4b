// SPDX-License-Identifier: GPL-3.0-or-later
#include "look/orientation.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "place/cranium.h"

namespace trephine::look {
namespace {

constexpr double min_cavity_ml = 500, max_cavity_ml = 2300;
constexpr double skull_mm = 12;    ///< bone within this of the cavity is its own wall
constexpr double about_mm = 130;   ///< of the cavity's middle: what lies farther is neck and trunk
constexpr double min_alike = 0.8;  ///< of a skull with its mirror image: heads have 0.9 and more, a rib cage 0.7
constexpr double shift_mm = 12;    ///< the plane of symmetry lies within this of the cavity's middle

/// The share of `mask` that its mirror image across a plane of this axis covers; of a few planes the best.
double alike_across(const mask::BitMask& mask, int axis, Vec3 centre_index) {
  const grid::Lattice& l = mask.lattice();
  const grid::Box box = mask.bounds();
  const mask::BitMask wide = mask::dilated_6(mask);
  double best = 0;
  const int reach = int(std::lround(2 * shift_mm / l.spacing_mm[axis]));
  const int twice = int(std::lround(2 * centre_index[axis]));
  for (int shift = -reach; shift <= reach; ++shift) {
    std::size_t all = 0, met = 0;
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          if (!mask.get(i, j, k)) continue;
          int at[3] = {i, j, k};
          at[axis] = twice + shift - at[axis];
          ++all;
          met += wide.at(at[0], at[1], at[2]);
        }
    if (all) best = std::max(best, double(met) / double(all));
  }
  return best;
}

/// The mean place of a mask's cells within reach of a place, and their volume.
Vec3 middle_of(const mask::BitMask& mask, Vec3 about, double& ml) {
  const grid::Lattice& l = mask.lattice();
  Vec3 sum;
  std::size_t count = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!mask.get(i, j, k)) continue;
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        if (norm(p - about) > about_mm) continue;
        sum += p;
        ++count;
      }
  ml = double(count) * l.voxel_volume_mm3() / 1000;
  return count ? sum / double(count) : about;
}

}  // namespace

HeadSigns head_signs(const mask::BitMask& bone, const mask::BitMask& air, const Progress& progress) {
  HeadSigns signs;
  mask::BitMask cavity;
  try {
    cavity = place::cranial_cavity(bone, progress).value;
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
    return signs;
  }
  const double ml = double(cavity.count()) * bone.lattice().voxel_volume_mm3() / 1000;
  signs.found = ml > min_cavity_ml && ml < max_cavity_ml;
  if (!signs.found) return signs;
  const Vec3 middle = cavity.centre_mm();
  const mask::BitMask wall = mask::dilated(cavity, skull_mm, progress);
  const mask::BitMask face = mask::without(bone, wall);
  signs.bone_mm = middle_of(face, middle, signs.bone_ml) - middle;
  signs.air_mm = middle_of(mask::without(air, cavity), middle, signs.air_ml) - middle;
  mask::BitMask skull(bone.lattice());
  const grid::Lattice& l = bone.lattice();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (bone.get(i, j, k) && norm(l.to_world_mm({double(i), double(j), double(k)}) - middle) < about_mm)
          skull.set(i, j, k);
  for (int a = 0; a < 3; ++a) {
    progress.check();
    signs.alike[std::size_t(a)] = alike_across(skull, a, l.to_index(middle));
  }
  const auto best = std::max_element(signs.alike.begin(), signs.alike.end());
  signs.found = *best > min_alike;
  double second = 0;
  for (const double v : signs.alike)
    if (v < *best) second = std::max(second, v);
  if (*best > second + 0.08) signs.left_right_axis = int(best - signs.alike.begin());
  return signs;
}

}  // namespace trephine::look
