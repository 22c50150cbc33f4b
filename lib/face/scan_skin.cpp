// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/scan_skin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mask/bits.h"
#include "mask/coarse.h"
#include "mask/hu_view.h"
#include "surface/point_to_mesh.h"

namespace trephine::face {
namespace {

constexpr double cell_mm = 2;
constexpr double skin_hu = -400;
constexpr double close_mm = 10;        // half the width of passages that are closed
constexpr double cut_cavity_ml = 100;  // a sinus or airway that the scan's end cuts open is smaller than that
constexpr double shown_mm = 1.5;

/// The limit between background and tissue: two classes whose means lie as far from it on either side
/// [Ridler1978], and from the lower one a quarter of the way.
double limit_of_brightness(const grid::Grid<float>& mean) {
  double limit = 0;
  for (const float v : mean.voxels) limit += double(v) / double(mean.count());
  double low = limit, high = limit;
  for (int round = 0; round < 30; ++round) {
    double sum[2] = {0, 0};
    std::size_t count[2] = {0, 0};
    for (const float v : mean.voxels) {
      sum[v > limit] += v;
      ++count[v > limit];
    }
    if (!count[0] || !count[1]) break;
    low = sum[0] / double(count[0]);
    high = sum[1] / double(count[1]);
    const double next = (low + high) / 2;
    if (next == limit) break;
    limit = next;
  }
  return low + 0.25 * (high - low);
}

/// What can be reached from outside of the shape without passing through a passage narrower than 2 * close_mm.
mask::BitMask outside_of(const mask::BitMask& shape, const Progress& progress) {
  mask::BitMask free = shape, open = mask::closed(shape, close_mm, progress);
  free.invert();
  open.invert();
  const mask::Components spaces = mask::components(open);
  const double voxel_ml = shape.lattice().voxel_volume_mm3() / 1000;
  std::vector<char> is_outside(spaces.list.size());
  for (std::size_t c = 0; c < is_outside.size(); ++c) {
    const mask::Component& space = spaces.list[c];
    is_outside[c] = space.faces > 1 || (space.faces == 1 && double(space.voxels) * voxel_ml > cut_cavity_ml);
  }
  return mask::grown_within(mask::select(spaces, is_outside), free, close_mm, progress);
}

/// Calls point(world position, area in mm2) where the skin crosses the raster's edges. Of a surface in any direction
/// the crossings along the three axes are as many as an area of 1.5 times its own has, on average.
template <class F>
void each_crossing(const grid::Field& f, const F& point) {
  const Vec3 s = f.spacing_mm;
  const double area_mm2[3] = {s.y * s.z / 1.5, s.x * s.z / 1.5, s.x * s.y / 1.5};
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i)
        for (int a = 0; a < 3; ++a) {
          int n[3] = {i, j, k};
          if (++n[a] >= f.size[a]) continue;
          const float here = f.at(i, j, k), there = f.at(n[0], n[1], n[2]);
          if ((here > 0) == (there > 0)) continue;
          Vec3 at{double(i), double(j), double(k)};
          at[a] += double(here) / (double(here) - double(there));
          point(f.to_world_mm(at), area_mm2[a]);
        }
}

template <class T>
bool differs_about(const grid::Grid<T>& g, Vec3 world_mm) {
  const Vec3 at = g.to_index(world_mm);
  const int i = int(std::floor(at.x)), j = int(std::floor(at.y)), k = int(std::floor(at.z));
  if (!g.contains(i, j, k) || !g.contains(i + 1, j + 1, k + 1)) return false;
  for (int corner = 1; corner < 8; ++corner)
    if (g.at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)) != g.at(i, j, k)) return true;
  return false;
}

template <class T>
double shown_in(const grid::Field& skin, const grid::Grid<T>& g) {
  double mm2 = 0;
  each_crossing(skin, [&](Vec3 at, double area) { mm2 += differs_about(g, at) ? area : 0; });
  return mm2 / 100;
}

}  // namespace

std::optional<grid::Field> scan_skin(const grid::HuVolume& scan, ScanValues values, const Progress& progress) {
  const mask::HuView view(scan);
  const mask::CoarseRaster raster = mask::coarse_raster(view.lattice(), cell_mm);
  mask::BitMask all(view.lattice());
  all.invert();
  grid::Field skin = mask::coarse_mean(view, all, raster, 0);
  progress.check();
  const double limit = values == ScanValues::hu ? skin_hu : limit_of_brightness(skin);
  const mask::BitMask shape = mask::largest(mask::components(mask::above(mask::HuView(skin), limit)));
  if (!shape.any()) return {};
  const mask::BitMask outside = outside_of(shape, progress);
  float least = 1e30f;  // the step from air to what is no longer air, for cells that belong to the other side
  for (const float v : skin.voxels) least = std::min(least, v);
  const float step = std::max(1e-6f, float(limit) - least);
  bool ends = false;
  for (int k = 0; k < skin.size[2]; ++k)
    for (int j = 0; j < skin.size[1]; ++j)
      for (int i = 0; i < skin.size[0]; ++i) {
        float& v = skin.at(i, j, k);
        v -= float(limit);
        const bool is_outside = outside.get(i, j, k);
        ends = ends || is_outside;
        if (is_outside != (v <= 0)) v = is_outside ? -step : step;
        if (!is_outside && v == 0) v = step;
      }
  if (!ends) return {};
  return skin;
}

double skin_shown_cm2(const grid::Field& skin, const surface::TriMesh& mesh, const Progress& progress) {
  if (mesh.triangles.empty()) return 0;
  std::vector<Vec3> points;
  std::vector<double> areas;
  each_crossing(skin, [&](Vec3 at, double area) {
    points.push_back(at);
    areas.push_back(area);
  });
  const std::vector<double> distances = surface::PointToMesh(mesh, progress).distances_mm(points, progress);
  double mm2 = 0;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (distances[p] <= shown_mm) mm2 += areas[p];
  return mm2 / 100;
}

double skin_shown_cm2(const grid::Field& skin, const grid::HuVolume& volume, const Progress& progress) {
  progress.check();
  return std::visit([&](const auto& g) { return shown_in(skin, g); }, volume);
}

double skin_shown_cm2(const grid::Field& skin, const voxel::HapticVolume& volume, const Progress& progress) {
  progress.check();
  return shown_in(skin, volume.voxels);
}

}  // namespace trephine::face
