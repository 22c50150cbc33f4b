// SPDX-License-Identifier: GPL-3.0-or-later
// Five fixed works whose instructions bench/guard counts: guard_works NAME. Each takes its input from a formula, so
// that nothing but the work is counted that could change, and runs on one thread.
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/decimate.h"
#include "meshing_shapes.h"
#include "picture/render.h"
#include "report_of.h"
#include "segmentation/segment.h"
#include "surface/bounds.h"
#include "voxel/voxelize.h"

namespace {

using namespace trephine;

grid::Lattice cube(int n, double side_mm) {
  const double spacing = side_mm / n;
  grid::Lattice l = shapes::lattice(n, n, n, {spacing, spacing, spacing});
  l.origin_mm = Vec3{-1, -1, -1} * (spacing * (n - 1) / 2);
  return l;
}

// About the depth below a ball of 60 mm with folds, mm.
double depth_mm(Vec3 p) { return 60 - norm(p) + 3 * std::sin(p.x / 5) * std::sin(p.y / 6) * std::sin(p.z / 7 + 1); }

grid::Field ball(int n) { return shapes::sample(cube(n, 140), depth_mm); }

surface::TriMesh ball_surface(int n) { return shapes::contoured(ball(n)); }

// A shell of bone around soft tissue, in air, with noise.
grid::HuVolume shell(int n) {
  grid::Grid<std::int16_t> volume(cube(n, 140), 0);
  Random random(1);
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double depth = depth_mm(volume.to_world_mm({double(i), double(j), double(k)}));
        const double hu = depth < -4 ? -1000 : depth < 0 ? 40 : depth < 6 ? 900 : 35;
        volume.at(i, j, k) = static_cast<std::int16_t>(hu + random(-20, 20));
      }
  return volume;
}

std::size_t segmented() {
  segmentation::SegmentParams p;
  p.seed_lower_hu = 400;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.fill = segmentation::SegmentFill::cavities;
  p.fill_close_mm = 2;
  p.fill_max_ml = 100;
  return segmentation::segment(shell(160), {}, p).value.voxels.size();
}

std::size_t decimated() {
  meshing::DecimateParams p;
  p.target_triangles_count = 12000;
  Report report;
  return value_of(report, meshing::decimate(ball_surface(90), p)).triangles.size();
}

std::size_t voxelized() {
  const surface::TriMesh mesh = ball_surface(90);
  voxel::VoxelizeShape shape;
  shape.name = "ball";
  shape.surface = &mesh;
  shape.shell_mm = 5;
  voxel::VoxelizeParams p;
  Report report;
  const grid::Lattice lattice = voxel::haptic_lattice(surface::bounds_of(mesh), {}, {}, p);
  return value_of(report, voxel::voxelize(lattice, {shape})).voxels.count();
}

std::size_t pictured() {
  const surface::TriMesh outer = ball_surface(120), inner = ball_surface(60);
  picture::RenderParams p;
  p.width = p.height = 640;
  return picture::encode_png(
             picture::render_surfaces({{&outer, {0.8, 0.7, 0.6}, 0.3}, {&inner, {0.8, 0.3, 0.3}, 1}}, p))
      .size();
}

}  // namespace

int main(int count, char** words) {
  const std::map<std::string, std::function<std::size_t()>> works{
      {"segment", segmented},
      {"contour", [] { return ball_surface(200).triangles.size(); }},
      {"decimate", decimated},
      {"voxelize", voxelized},
      {"picture", pictured}};
  const auto work = works.find(count == 2 ? words[1] : "");
  if (work == works.end()) {
    for (const auto& [name, run] : works) std::puts(name.c_str());
    return count == 1 ? 0 : 64;
  }
  set_thread_count(1);
  std::printf("%s: %zu\n", work->first.c_str(), work->second());
  return 0;
}
