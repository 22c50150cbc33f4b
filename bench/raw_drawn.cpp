// SPDX-License-Identifier: GPL-3.0-or-later
// bench_raw_drawn CASE...: of each shape of a raw CT (encoding hu), the surface that the window draws and drills, with
// those of the shapes above it, beside the toolchain's contour of the CT at the low end of its window, from six sides
// at 800 x 800: how much of their silhouettes is common (intersection over union), and of the pixels that both cover
// the share whose depths lie within 0.5 mm, but for where the lattice cuts the surface.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "cases/load_case.h"
#include "drill/live_surface.h"
#include "meshing/contour.h"
#include "picture/raster.h"

using namespace trephine;

namespace {

constexpr int side_px = 800;
constexpr double near_mm = 0.5;

void add_live(surface::TriMesh& mesh, const voxel::HapticVolume& v, int number) {
  const drill::LiveSurface s(v, number);
  mesh.origin_mm = v.voxels.origin_mm;
  for (std::size_t b = 0; b < s.layout().count(); ++b) {
    const std::uint32_t first = std::uint32_t(mesh.points_mm.size());
    for (const drill::LiveVertex& p : s.brick(b).vertices) {
      const Vec3 at = v.voxels.direction * Vec3{p.position_mm[0], p.position_mm[1], p.position_mm[2]};
      mesh.points_mm.push_back(at);
    }
    const std::vector<std::uint16_t>& i = s.brick(b).indices;
    for (std::size_t n = 0; n < i.size(); n += 3)
      mesh.triangles.push_back({first + i[n], first + i[n + 1], first + i[n + 2]});
  }
}

surface::TriMesh contour_at(const grid::Grid<std::int16_t>& voxels, int hu) {
  grid::Field field(static_cast<const grid::Lattice&>(voxels));
  for (std::size_t n = 0; n < voxels.voxels.size(); ++n) field.voxels[n] = float(voxels.voxels[n] - hu) + 0.01f;
  return meshing::contour_to_look_at(field);
}

// Whether what is seen there lies where the lattice cuts it.
bool at_border(const grid::Lattice& lattice, const picture::detail::Camera& camera, int x, int y, double depth) {
  const Vec3 c = camera.at_depth(x + 0.5, y + 0.5, depth);
  const Vec3 index = lattice.to_index(camera.target_mm + camera.right * c.x + camera.up * c.y + camera.toward * c.z);
  bool border = false;
  for (int a = 0; a < 3; ++a) border = border || index[a] < 1 || index[a] > lattice.size[std::size_t(a)] - 2;
  return border;
}

// How far each pixel's nearest surface is before the target's plane, mm; NaN where there is none.
std::vector<double> depths(const surface::TriMesh& mesh, const picture::detail::Camera& camera) {
  using namespace picture::detail;
  const Projected projected = project(mesh, camera, 1, side_px, {});
  std::vector<double> out(std::size_t(side_px) * side_px, NAN);
  Layer layer;
  for (int band = 0; band * projected.band_rows < side_px; ++band) {
    const int rows = std::min(projected.band_rows, side_px - band * projected.band_rows);
    draw_band(projected, band, side_px, side_px, false, layer);
    if (layer.empty) continue;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < side_px; ++x) {
        const std::size_t at = std::size_t(y) * std::size_t(Layer::stride_of(side_px)) + std::size_t(x);
        if (layer.triangle[at] != Layer::none)
          out[std::size_t(band * projected.band_rows + y) * side_px + std::size_t(x)] =
              camera.z_of_magnification(layer.depth[at]);
      }
  }
  return out;
}

void compare(const grid::Lattice& lattice, const surface::TriMesh& drawn, const surface::TriMesh& shown,
             const std::string& name) {
  double least_iou = 1, least_near = 1;
  using picture::View;
  for (const View view : {View::front, View::back, View::left, View::right, View::top, View::oblique_left}) {
    picture::RenderParams params;
    params.view = view;
    params.width = params.height = side_px;
    const picture::detail::Camera camera = picture::detail::camera_for({{&shown, {}, 1}}, params);
    const std::vector<double> a = depths(drawn, camera), b = depths(shown, camera);
    double both = 0, either = 0, near = 0, judged = 0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      const bool in_a = !std::isnan(a[n]), in_b = !std::isnan(b[n]);
      both += in_a && in_b;
      either += in_a || in_b;
      if (!in_a || !in_b) continue;
      const int x = int(n % side_px), y = int(n / side_px);
      if (at_border(lattice, camera, x, y, a[n]) || at_border(lattice, camera, x, y, b[n])) continue;
      judged += 1;
      near += std::abs(a[n] - b[n]) <= near_mm;
    }
    least_iou = std::min(least_iou, both / either);
    least_near = std::min(least_near, near / judged);
  }
  std::printf("%-12s %8zu and %8zu triangles: silhouettes %.4f, depths %.4f at least\n", name.c_str(),
              drawn.triangles.size(), shown.triangles.size(), least_iou, least_near);
}

}  // namespace

int main(int argc, char** argv) try {
  for (int n = 1; n < argc; ++n) {
    const cases::LoadedCase loaded = cases::load_case(argv[n]);
    std::printf("%s\n", argv[n]);
    std::vector<voxel::HapticShape> shapes = loaded.haptic.shapes;
    std::sort(shapes.begin(), shapes.end(), [](const auto& a, const auto& b) { return a.window_low > b.window_low; });
    surface::TriMesh drawn;
    for (const voxel::HapticShape& s : shapes) {
      add_live(drawn, loaded.haptic, s.number);
      compare(loaded.haptic.voxels, drawn, contour_at(loaded.haptic.voxels, s.window_low), s.name);
    }
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_raw_drawn: %s\n", e.what());
  return 1;
}
