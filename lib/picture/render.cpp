// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "picture/camera.h"
#include "picture/occlusion.h"
#include "picture/raster.h"
#include "surface/vertex_normals.h"

namespace trephine::picture {
namespace {

using detail::Camera;
using detail::Layer;
using detail::Projected;

using Light = std::array<float, 3>;  // linear
constexpr Rgb warning_colour{1.0, 0.0, 0.85};

float linear_of_srgb(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

Light linear_of(Rgb c) { return {linear_of_srgb(c[0]), linear_of_srgb(c[1]), linear_of_srgb(c[2])}; }

std::uint8_t srgb_byte(float linear) {
  constexpr int steps = 1 << 14;
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(steps + 1);
    for (int i = 0; i <= steps; ++i) {
      const double v = double(i) / steps;
      const double s = v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
      t[i] = static_cast<std::uint8_t>(std::lround(s * 255));
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.f, 1.f) * steps + 0.5f)];
}

Vec3 direction(double x, double y, double z) { return normalized({x, y, z}); }

// The lights: a key light from the upper left, a weak one from the right, and a rim light from behind. The sky is a
// little brighter than the ground.
Light shaded(const Light& albedo, Vec3 n, Vec3 to_eye) {
  static const Vec3 key = direction(-0.45, 0.62, 0.64), fill = direction(0.80, 0.05, 0.45),
                    rim = direction(0.25, 0.55, -0.80);
  static const Vec3 sky{0, 1, 0};
  const double diffuse = 0.70 * std::max(0.0, dot(n, key)) + 0.30 * std::max(0.0, dot(n, fill)) +
                         0.12 * std::max(0.0, dot(n, rim)) + 0.26 + 0.08 * dot(n, sky);
  double shine = std::max(0.0, dot(n, normalized(key + to_eye)));
  for (int i = 0; i < 5; ++i) shine *= shine;
  Light out;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(albedo[c] * diffuse + 0.10 * shine);
  return out;
}

struct Scene {
  Scene(const std::vector<SurfaceView>& s, const RenderParams& p) : surfaces(s), params(p) {}
  const std::vector<SurfaceView>& surfaces;
  const RenderParams& params;
  Camera camera;
  int samples = 1;
  std::vector<Projected> projected;
  std::vector<Light> colours;
  Light warning = linear_of(warning_colour);
  // The clip plane in camera coordinates: dot(normal, p) = offset.
  Vec3 plane_normal;
  double plane_offset = 0;
  std::vector<Light> background;  // of each row
};

// What is seen of one surface at one sample.
struct Fragment {
  float depth;
  int surface;
  std::uint32_t triangle;
  bool inner, cap;
};

// The depth at which the ray through a sample meets the clip plane. Returns false where it does not meet it in front of
// the eye.
bool plane_depth(const Scene& s, double x, double y, float& depth) {
  const Camera& c = s.camera;
  const double px = (x - c.center_x) / c.px_per_mm, py = (c.center_y - y) / c.px_per_mm;
  const Vec3 n = s.plane_normal;
  if (!(c.distance_mm > 0)) {
    if (std::abs(n.z) < 1e-9) return false;
    depth = static_cast<float>((s.plane_offset - n.x * px - n.y * py) / n.z);
    return true;
  }
  // The point is (px k, py k, D - D k) with k = 1 / magnification.
  const double slope = n.x * px + n.y * py - n.z * c.distance_mm, rest = s.plane_offset - n.z * c.distance_mm;
  const double k = rest / slope;
  if (!(std::abs(slope) > 1e-9) || !(k > 0)) return false;
  depth = static_cast<float>(1 / k);
  return true;
}

double z_of_depth(const Camera& c, float depth) { return c.distance_mm > 0 ? c.z_of_magnification(depth) : depth; }

struct Lit {
  Light colour;
  Vec3 normal, position;
  double opacity;
};

Lit lit(const Scene& s, const Fragment& f, int x, int y) {
  const double sx = (x + 0.5) / s.samples, sy = (y + 0.5) / s.samples;
  Lit out;
  out.position = s.camera.at_depth(sx, sy, z_of_depth(s.camera, f.depth));
  const Vec3 to_eye =
      s.camera.distance_mm > 0 ? normalized(Vec3{0, 0, s.camera.distance_mm} - out.position) : Vec3{0, 0, 1};
  if (f.cap) {
    out.normal = dot(s.plane_normal, to_eye) < 0 ? -s.plane_normal : s.plane_normal;
  } else {
    const Projected& p = s.projected[f.surface];
    const auto w = detail::weights_at(p, f.triangle, x, y, s.camera.distance_mm > 0);
    const auto& t = p.mesh->triangles[f.triangle];
    for (int corner = 0; corner < 3; ++corner) {
      const auto& n = p.normals[t[corner]];
      out.normal += Vec3{n[0], n[1], n[2]} * w[corner];
    }
    out.normal = normalized(out.normal);
    if (f.inner) out.normal = -out.normal;
  }
  const SurfaceView& view = s.surfaces[f.surface];
  const bool warn = f.inner && !f.cap && !s.params.clip;
  out.colour = shaded(warn ? s.warning : s.colours[f.surface], out.normal, to_eye);
  // As with glass, a surface that is seen at a grazing angle hides more.
  const double grazing = 1 - std::abs(dot(out.normal, to_eye));
  out.opacity = warn || view.opacity >= 1 ? 1 : view.opacity + (1 - view.opacity) * 0.7 * grazing * grazing * grazing;
  return out;
}

// Sums over the samples of a pixel: the light that occlusion darkens (of opaque surfaces), and the light that it does
// not.
struct Pixels {
  std::vector<Light> open, shadowed;
  detail::SurfaceBuffer buffer;
};

class BandPainter {
 public:
  BandPainter(const Scene& scene, Pixels& pixels)
      : s_(scene), pixels_(pixels), layers_(scene.surfaces.size()), last_(std::size_t(scene.params.width)) {}

  void paint(int band) {
    const int width = s_.params.width * s_.samples, rows = s_.params.height * s_.samples;
    const int begin = band * detail::band_rows, end = std::min(rows, begin + detail::band_rows);
    seen_.clear();
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      detail::draw_band(s_.projected[i], band, width, rows, s_.params.clip.has_value(), layers_[i]);
      if (!layers_[i].empty) seen_.push_back(i);
    }
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < width; ++x) paint_sample(x, y, std::size_t(y - begin) * width + x);
  }

 private:
  void collect(int x, int y, std::size_t at) {
    found_.clear();
    for (const std::size_t i : seen_) {
      const std::uint32_t value = layers_[i].triangle[at];
      if (value == Layer::none) continue;
      Fragment f{layers_[i].depth[at], static_cast<int>(i), value / 2, (value & 1) != 0, false};
      float depth = 0;
      // The nearest side that is left is an inner one, so the plane cuts through the solid here.
      if (f.inner && s_.params.clip && plane_depth(s_, (x + 0.5) / s_.samples, (y + 0.5) / s_.samples, depth) &&
          depth >= f.depth) {
        f.depth = depth;
        f.cap = true;
      }
      found_.push_back(f);
    }
    if (found_.size() < 2) return;
    // Sorted from near to far. Of surfaces at equal depth (caps) the later one comes first.
    std::sort(found_.begin(), found_.end(), [](const Fragment& a, const Fragment& b) {
      return a.depth != b.depth ? a.depth > b.depth : a.surface > b.surface;
    });
  }

  void paint_sample(int x, int y, std::size_t at) {
    collect(x, y, at);
    const int px = x / s_.samples, py = y / s_.samples;
    const std::size_t pixel = std::size_t(py) * s_.params.width + px;
    Light& open = pixels_.open[pixel];
    Light& shadowed = pixels_.shadowed[pixel];
    float left = 1.f / static_cast<float>(s_.samples * s_.samples);
    for (const Fragment& f : found_) {
      const Lit& l = lit_once(f, x, y, pixel);
      const float share = left * static_cast<float>(l.opacity);
      Light& sum = l.opacity >= 1 ? shadowed : open;
      for (int c = 0; c < 3; ++c) sum[c] += l.colour[c] * share;
      if (l.opacity >= 1) {
        if (x % s_.samples == 0 && y % s_.samples == 0) remember(pixel, l);
        return;
      }
      left -= share;
    }
    const Light& back = s_.background[py];
    for (int c = 0; c < 3; ++c) open[c] += back[c] * left;
  }

  // Within a pixel a triangle looks the same: it is lit where the first of its samples lies.
  const Lit& lit_once(const Fragment& f, int x, int y, std::size_t pixel) {
    Last& last = last_[pixel % last_.size()];
    if (last.pixel != pixel || last.surface != f.surface || last.triangle != f.triangle || last.cap != f.cap)
      last = {pixel, f.surface, f.triangle, f.cap, lit(s_, f, x, y)};
    return last.light;
  }

  void remember(std::size_t pixel, const Lit& l) {
    pixels_.buffer.covered[pixel] = 1;
    for (int c = 0; c < 3; ++c) {
      pixels_.buffer.position[pixel][c] = static_cast<float>(l.position[c]);
      pixels_.buffer.normal[pixel][c] = static_cast<float>(l.normal[c]);
    }
  }

  struct Last {
    std::size_t pixel = ~std::size_t{0};
    int surface = 0;
    std::uint32_t triangle = 0;
    bool cap = false;
    Lit light{};
  };

  const Scene& s_;
  Pixels& pixels_;
  std::vector<Layer> layers_;
  std::vector<std::size_t> seen_;  // those that are not empty
  std::vector<Last> last_;         // of each column of pixels
  std::vector<Fragment> found_;
};

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

  Pixels pixels;
  const std::size_t count = std::size_t(params.width) * params.height;
  pixels.open.resize(count);
  pixels.shadowed.resize(count);
  pixels.buffer.width = params.width;
  pixels.buffer.height = params.height;
  constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();
  pixels.buffer.position.resize(count, {nowhere, nowhere, nowhere});
  pixels.buffer.normal.resize(count);
  pixels.buffer.covered.resize(count);
  // A piece begins and ends at whole pixels. So all samples of a pixel lie in one piece and are summed in one order.
  const std::int64_t bands = (rows + detail::band_rows - 1) / detail::band_rows;
  const std::int64_t grain = scene.samples == 3 ? 3 : 1;
  parallel_for(0, bands, grain, [&](std::int64_t from, std::int64_t to) {
    BandPainter painter(scene, pixels);
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
  for (std::size_t i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c)
      image.rgb[i * 3 + c] = srgb_byte(pixels.open[i][c] + pixels.shadowed[i][c] * (params.occlusion ? reach[i] : 1.f));
  detail::draw_marks(image, scene.camera, params);
  progress.report(1);
  return image;
}

}  // namespace trephine::picture
