// SPDX-License-Identifier: GPL-3.0-or-later
#include "print/solid.h"

#include <algorithm>

#include "mask/filters.h"
#include "meshing/contour.h"

namespace trephine::print {
namespace {

constexpr double level_slope = 0.75;     ///< distances rise less steeply than this in the middle of a wall
constexpr double smooth_voxels = 0.8;    ///< sigma by which what single voxels are off is evened out
constexpr double hair_mm = 0.05;         ///< of a radius: what is left of distances' errors
constexpr double off_thick_ratio = 0.5;  ///< of the radius: nearer to what is thick a thin place is its edge

void add(Solid& solid, double mm) {
  for (float& v : solid.voxels) v += float(mm);
}

}  // namespace

grid::Lattice lattice_over(const surface::Bounds& box, double voxel_mm) {
  grid::Lattice l;
  l.spacing_mm = {voxel_mm, voxel_mm, voxel_mm};
  for (int a = 0; a < 3; ++a) {
    const double first = std::floor(box.min_mm[a] / voxel_mm), last = std::ceil(box.max_mm[a] / voxel_mm);
    l.origin_mm[a] = first * voxel_mm;
    l.size[std::size_t(a)] = int(last - first) + 1;
  }
  return l;
}

Vec3 slope(const Solid& solid, Vec3 mm, double reach_mm) {
  Vec3 out;
  for (int a = 0; a < 3; ++a) {
    Vec3 e;
    e[a] = reach_mm;
    out[a] = (at(solid, mm + e) - at(solid, mm - e)) / (2 * reach_mm);
  }
  return out;
}

bool is_empty(const Solid& solid) {
  return std::none_of(solid.voxels.begin(), solid.voxels.end(), [](float v) { return v > 0; });
}

mask::BitMask inside_of(const Solid& solid) { return mask::positive(solid, solid); }

double volume_ml(const Solid& solid) { return double(inside_of(solid).count()) * solid.voxel_volume_mm3() / 1000; }

Solid as_distances(const Solid& solid, const Progress& progress) {
  if (is_empty(solid)) return Solid(solid, float(nowhere_mm));
  return mask::signed_distance_mm(solid, progress);
}

Solid opened(const Solid& solid, double radius_mm, const Progress& progress) {
  const Solid distances = as_distances(solid, progress.part(0, 0.5));
  Solid shrunk = distances;
  add(shrunk, -radius_mm);
  Solid out = as_distances(shrunk, progress.part(0.5, 1));
  // It reaches nowhere beyond the solid, though distances of single voxels are off.
  for (std::size_t n = 0; n < out.voxels.size(); ++n)
    out.voxels[n] = std::min(out.voxels[n] + float(radius_mm), distances.voxels[n]);
  return out;
}

Solid with_walls(const Solid& solid, double ball_mm, double least_mm, const Progress& progress) {
  Solid smooth = opened(solid, ball_mm, progress.part(0, 0.5));
  mask::gaussian(smooth, smooth_voxels * smooth.spacing_mm.x);
  return opened(smooth, least_mm / 2 + hair_mm, progress.part(0.5, 1));
}

Solid thickened(const Solid& distances, double radius_mm, const Progress& progress) {
  const Solid thick = opened(distances, radius_mm, progress.part(0, 0.7));
  const double voxel = distances.spacing_mm.x;
  const mask::BitMask middles = mask::make_mask(distances, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < distances.size[0]; ++i) {
      const double d = distances.at(i, j, k);
      row[i] = 0;
      if (d <= 0 || d >= radius_mm || thick.at(i, j, k) > -off_thick_ratio * radius_mm) continue;
      const Vec3 p = distances.to_world_mm({double(i), double(j), double(k)});
      row[i] = norm(slope(distances, p, voxel)) < level_slope;
    }
  });
  if (!middles.any()) return distances;
  Solid out = mask::distance_mm(middles, progress.part(0.7, 1));
  for (std::size_t n = 0; n < out.voxels.size(); ++n)
    out.voxels[n] = std::max(distances.voxels[n], float(radius_mm) - out.voxels[n]);
  return out;
}

double keep_largest(Solid& solid) {
  const mask::BitMask all = inside_of(solid), one = mask::largest(mask::components(all));
  const std::size_t rest = all.count() - one.count();
  if (rest == 0) return 0;
  for (int k = 0; k < solid.size[2]; ++k)
    for (int j = 0; j < solid.size[1]; ++j)
      for (int i = 0; i < solid.size[0]; ++i)
        if (all.get(i, j, k) && !one.get(i, j, k)) solid.at(i, j, k) = -float(solid.spacing_mm.x);
  return double(rest) * solid.voxel_volume_mm3() / 1000;
}

surface::TriMesh surface_of(const Solid& solid, const Progress& progress) {
  meshing::ContourParams contour;
  contour.keep_cavities = true;
  contour.min_component_mm3 = 0;
  return meshing::contour(solid, contour, progress).value;
}

}  // namespace trephine::print
