// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/deviation_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "base/error.h"
#include "base/rank.h"
#include "base/text.h"
#include "meshing/normals.h"
#include "picture/render.h"
#include "surface/point_to_mesh.h"

namespace trephine::picture {
namespace {

constexpr int shades = 33;  // from -full to full
constexpr int bar_width = 110;

/// The colour of x from -1 to 1: from blue over grey to red.
Rgb colour_at(double x) {
  const Rgb low{0.10, 0.25, 0.85}, none{0.80, 0.80, 0.80}, high{0.85, 0.10, 0.10};
  const double w = std::min(1.0, std::abs(x));
  Rgb c;
  for (int i = 0; i < 3; ++i) c[i] = none[i] + w * ((x < 0 ? low : high)[i] - none[i]);
  return c;
}

int shade_of(double deviation, double full) {
  const double x = std::clamp(deviation / full, -1.0, 1.0);
  return static_cast<int>(std::lround((x + 1) / 2 * (shades - 1)));
}

double percentile99(std::vector<double> d) {
  for (double& v : d) v = std::abs(v);
  return value_at_rank(d, (d.size() * 99 + 99) / 100 - 1);
}

void draw_scale(Image& image, double full) {
  const int left = image.width - bar_width + 10, top = image.height / 5, height = image.height * 3 / 5;
  for (int y = 0; y < height; ++y) {
    const Rgb c = colour_at(1 - 2.0 * y / (height - 1));
    for (int x = left; x < left + 22; ++x)
      for (int i = 0; i < 3; ++i) image.at(x, top + y)[i] = static_cast<std::uint8_t>(std::lround(255 * c[i]));
  }
  for (int n = -2; n <= 2; ++n) {
    char text[32];
    std::snprintf(text, sizeof text, "%+.2g", n * full / 2);
    std::string number = n == 0 ? "0" : text;
    std::replace(number.begin(), number.end(), ',', '.');
    draw_text(image, left + 28, top + (2 - n) / 4.0 * (height - 1) - 6, number, 12, {0, 0, 0}, {1, 1, 1});
  }
  draw_text(image, left, top - 28, "mm", 12, {0, 0, 0}, {1, 1, 1});
}

}  // namespace

std::vector<double> signed_deviations_mm(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                                         const Progress& progress) {
  std::vector<Vec3> world(mesh.points_mm.size());
  for (std::size_t i = 0; i < world.size(); ++i) world[i] = mesh.world_mm(i);
  return surface::PointToMesh(reference, progress).signed_distances_mm(world, progress);
}

Image deviation_picture(const surface::TriMesh& mesh, const surface::TriMesh& reference, double full_scale_mm,
                        const Progress& progress) {
  surface::check_mesh(mesh);
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "surface", "has no triangles");
  const std::vector<double> deviation = signed_deviations_mm(mesh, reference, progress.part(0, 0.4));
  double full = full_scale_mm > 0 ? full_scale_mm : percentile99(deviation);
  if (!(full > 0)) full = 1e-3;
  surface::TriMesh smooth = mesh;
  if (smooth.normals.empty()) {
    meshing::compute_normals(smooth, meshing::NormalsParams());
  }
  // There is one surface for each shade, because the renderer gives a surface one colour.
  std::vector<surface::TriMesh> parts(shades);
  for (const auto& t : smooth.triangles) {
    const double mean = (deviation[t[0]] + deviation[t[1]] + deviation[t[2]]) / 3;
    parts[std::size_t(shade_of(mean, full))].triangles.push_back(t);
  }
  std::vector<SurfaceView> surfaces;
  for (int s = 0; s < shades; ++s) {
    surface::TriMesh& part = parts[std::size_t(s)];
    if (part.triangles.empty()) continue;
    part.origin_mm = smooth.origin_mm;
    part.points_mm = smooth.points_mm;
    part.normals = smooth.normals;
    surface::drop_unused_points(part);
    surfaces.push_back({&part, colour_at(2.0 * s / (shades - 1) - 1), 1});
  }
  RenderParams params;
  params.width = params.height = 480;
  params.frame = surface::bounds_of(mesh);
  std::vector<Image> images;
  for (const View v : {View::oblique_left, View::oblique_right, View::back, View::top}) {
    params.view = v;
    images.push_back(render_surfaces(surfaces, params, progress.part(0.4, 1)));
  }
  const Image sheet = contact_sheet(images, 2);
  Image out(sheet.width + bar_width, sheet.height, {1, 1, 1});
  for (int y = 0; y < sheet.height; ++y) std::copy(sheet.at(0, y), sheet.at(0, y) + 3 * sheet.width, out.at(0, y));
  draw_scale(out, full);
  progress.report(1);
  return out;
}

}  // namespace trephine::picture
