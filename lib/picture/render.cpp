// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/render.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/srgb.h"
#include "picture/camera.h"
#include "picture/paint.h"
#include "surface/vertex_normals.h"

namespace trephine::picture {
namespace {

using detail::Light;
using detail::Scene;

constexpr Rgb warning_colour{1.0, 0.0, 0.85};

Light linear_of(Rgb c) {
  const auto linear = [](double s) { return static_cast<float>(linear_of_srgb(std::clamp(s, 0.0, 1.0))); };
  return {linear(c[0]), linear(c[1]), linear(c[2])};
}

std::uint8_t srgb_byte(float linear) {
  constexpr int steps = 1 << 14;
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(steps + 1);
    for (int i = 0; i <= steps; ++i) {
      t[i] = static_cast<std::uint8_t>(std::lround(srgb_of_linear(double(i) / steps) * 255));
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.f, 1.f) * steps + 0.5f)];
}

std::vector<Light> background_rows(const RenderParams& p) {
  std::vector<Light> rows;
  for (int y = 0; y < p.height; ++y) {
    const double t = p.height > 1 ? double(y) / (p.height - 1) : 0;
    Rgb c;
    for (int i = 0; i < 3; ++i) c[i] = p.background_top[i] + (p.background_bottom[i] - p.background_top[i]) * t;
    rows.push_back(linear_of(c));
  }
  return rows;
}

void check(const std::vector<SurfaceView>& surfaces, const RenderParams& p) {
  for (const auto& s : surfaces) {
    if (!s.mesh) throw Error(ExitCode::internal, "", "picture", "a surface is null");
    surface::check_mesh(*s.mesh);
  }
  if (p.width < 1 || p.height < 1 || p.width > 16384 || p.height > 16384)
    throw Error(ExitCode::internal, "", "picture", "the size must lie between 1 and 16384 pixels");
}

}  // namespace

void give_normals(surface::TriMesh& mesh) { mesh.normals = surface::vertex_normals(mesh); }

Image render_surfaces(const std::vector<SurfaceView>& surfaces, const RenderParams& params, const Progress& progress) {
  check(surfaces, params);
  Scene scene(surfaces, params);
  scene.camera = detail::camera_for(surfaces, params);
  scene.warning = linear_of(warning_colour);
  scene.samples = std::clamp(params.supersampling, 1, 4);
  scene.background = background_rows(params);
  const int rows = params.height * scene.samples;
  for (const auto& s : surfaces) {
    progress.check();
    scene.projected.push_back(detail::project(*s.mesh, scene.camera, scene.samples, rows, params.clip));
    scene.colours.push_back(linear_of(s.colour_rgb));
  }
  if (params.clip) {
    const Vec3 n = normalized(params.clip->normal);
    scene.plane_normal = {dot(n, scene.camera.right), dot(n, scene.camera.up), dot(n, scene.camera.toward)};
    scene.plane_offset = dot(scene.plane_normal, scene.camera.to_camera(params.clip->point_mm));
  }

  detail::Pixels pixels;
  const std::size_t count = std::size_t(params.width) * params.height;
  pixels.open.resize(count);
  pixels.shadowed.resize(count);
  pixels.painted.resize(count);
  pixels.buffer = detail::SurfaceBuffer(params.width, params.height);
  const int band_rows = detail::band_rows_of(scene.samples);
  parallel_for(0, (rows + band_rows - 1) / band_rows, 1, [&](std::int64_t from, std::int64_t to) {
    detail::BandPainter painter(scene, pixels);
    for (std::int64_t band = from; band < to; ++band) {
      progress.check();
      painter.paint(static_cast<int>(band));
    }
  });

  std::vector<float> reach;
  if (params.occlusion)
    reach = detail::openness(pixels.buffer, scene.camera,
                             0.08 * std::min(params.width, params.height) / scene.camera.px_per_mm);
  Image image(params.width, params.height);
  std::uint8_t* byte = image.rgb.data();
  for (int y = 0; y < params.height; ++y) {
    const Light& back = scene.background[std::size_t(y)];
    const std::array<std::uint8_t, 3> bytes{srgb_byte(back[0]), srgb_byte(back[1]), srgb_byte(back[2])};
    for (int x = 0; x < params.width; ++x, byte += 3) {
      const std::size_t at = std::size_t(y) * params.width + x;
      if (!pixels.painted[at]) {
        std::copy(bytes.begin(), bytes.end(), byte);
        continue;
      }
      const float through = params.occlusion ? reach[at] : 1.f;
      for (int c = 0; c < 3; ++c) byte[c] = srgb_byte(pixels.open[at][c] + pixels.shadowed[at][c] * through);
    }
  }
  detail::draw_marks(image, scene.camera, params);
  progress.report(1);
  return image;
}

}  // namespace trephine::picture
