// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/paint.h"

#include <algorithm>
#include <cmath>

namespace trephine::picture::detail {
namespace {

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

Light light_of(Vec3 v) { return {float(v.x), float(v.y), float(v.z)}; }

}  // namespace

BandPainter::BandPainter(const Scene& scene, Pixels& pixels)
    : s_(scene), pixels_(pixels), layers_(scene.surfaces.size()) {}

void BandPainter::paint(int band) {
  const int width = s_.params.width * s_.samples, rows = s_.params.height * s_.samples;
  seen_.clear();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    draw_band(s_.projected[i], band, width, rows, s_.params.clip.has_value(), layers_[i]);
    if (!layers_[i].empty) seen_.push_back(i);
  }
  const int rows_of_band = band_rows_of(s_.samples), begin = band * rows_of_band;
  for (int y = begin; y < std::min(rows, begin + rows_of_band); y += s_.samples) paint_row(y / s_.samples, begin);
}

// Whether a surface is seen anywhere in a pixel, whose first sample stands there in the layers.
bool BandPainter::meets(std::size_t at) const {
  const std::size_t stride = Layer::stride_of(s_.params.width * s_.samples);
  for (const std::size_t i : seen_) {
    const std::uint32_t* first = &layers_[i].triangle[at];
    std::uint32_t all = Layer::none;
    for (int j = 0; j < s_.samples; ++j)
      for (int k = 0; k < s_.samples; ++k) all &= first[j * stride + k];
    if (all != Layer::none) return true;
  }
  return false;
}

void BandPainter::paint_row(int y, int begin) {
  hits_.clear();
  points_.count = 0;
  order_.clear();
  painted_.clear();
  if (seen_.empty()) return;
  const int n = s_.samples;
  const std::size_t stride = Layer::stride_of(s_.params.width * n), row = std::size_t(y * n - begin) * stride;
  const bool alone = seen_.size() == 1 && !s_.params.clip;
  for (int x = 0; x < s_.params.width; ++x) {
    if (!meets(row + x * n)) continue;
    painted_.push_back(x);
    first_of_pixel_ = hits_.size();
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const std::size_t at = row + j * stride + x * n + i;
        if (alone)
          paint_alone(x * n + i, y * n + j, at);
        else
          paint_sample(x * n + i, y * n + j, at);
      }
  }
  light(points_, static_cast<float>(s_.camera.distance_mm));
  blend_row(y);
}

void BandPainter::paint_sample(int x, int y, std::size_t at) {
  collect(x, y, at);
  for (const Fragment& f : found_) {
    order_.push_back(hit_of(f, x, y));
    if (hits_[order_.back()].opaque) return;
  }
  order_.push_back(background);
}

// The same, where the band shows one surface and nothing is cut.
void BandPainter::paint_alone(int x, int y, std::size_t at) {
  const Layer& layer = layers_[seen_[0]];
  const std::uint32_t value = layer.triangle[at];
  bool opaque = false;
  if (value != Layer::none) {
    const auto last = static_cast<std::uint32_t>(hits_.size() - 1);
    const bool same = hits_.size() > first_of_pixel_ && hits_[last].of.triangle == value / 2;
    const Fragment f{layer.depth[at], static_cast<int>(seen_[0]), value / 2, (value & 1) != 0, false};
    order_.push_back(same ? last : hit_of(f, x, y));
    opaque = hits_[order_.back()].opaque;
  }
  if (!opaque) order_.push_back(background);
}

// What is seen at a sample, from near to far. Of surfaces at equal depth (caps) the later one comes first.
void BandPainter::collect(int x, int y, std::size_t at) {
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
    std::size_t place = found_.size();
    found_.push_back(f);
    for (; place > 0 && !(found_[place - 1].depth > f.depth); --place) found_[place] = found_[place - 1];
    found_[place] = f;
  }
}

// Within a pixel a triangle looks the same: it is lit where the first of its samples lies.
std::uint32_t BandPainter::hit_of(const Fragment& f, int x, int y) {
  for (std::size_t h = hits_.size(); h > first_of_pixel_; --h) {
    const Fragment& other = hits_[h - 1].of;
    if (other.triangle == f.triangle && other.surface == f.surface && other.cap == f.cap)
      return static_cast<std::uint32_t>(h - 1);
  }
  hits_.push_back({f, is_warning(f) || s_.surfaces[std::size_t(f.surface)].opacity >= 1});
  const Vec3 at = s_.camera.at_depth((x + 0.5) / s_.samples, (y + 0.5) / s_.samples, z_of_depth(s_.camera, f.depth));
  Light normal{};
  if (f.cap) {
    const Vec3 to_eye = s_.camera.distance_mm > 0 ? Vec3{0, 0, s_.camera.distance_mm} - at : Vec3{0, 0, 1};
    normal = light_of(dot(s_.plane_normal, to_eye) < 0 ? -s_.plane_normal : s_.plane_normal);
  } else {
    // The weights are positive where the inner side is seen, whose normal is the other one: so the sum is turned
    // always.
    const Projected& p = s_.projected[std::size_t(f.surface)];
    const auto weight = weights_at(p, f.triangle, x, y, s_.camera.distance_mm > 0);
    const auto& t = p.mesh->triangles[f.triangle];
    for (int corner = 0; corner < 3; ++corner)
      for (int c = 0; c < 3; ++c) normal[c] -= p.normals[t[corner]][c] * weight[corner];
  }
  points_.add(normal, light_of(at));
  return static_cast<std::uint32_t>(hits_.size() - 1);
}

void BandPainter::blend_row(int y) {
  const int samples = s_.samples * s_.samples;
  const Light& back = s_.background[std::size_t(y)];
  const std::size_t row = std::size_t(y) * s_.params.width;
  std::size_t next = 0;  // in order_
  for (const int x : painted_) {
    Light open{}, shadowed{};
    for (int sample = 0; sample < samples; ++sample) {
      float left = 1.f / static_cast<float>(samples);
      for (;;) {
        const std::uint32_t h = order_[next++];
        if (h == background) {
          for (int c = 0; c < 3; ++c) open[c] += back[c] * left;
          break;
        }
        const Hit& hit = hits_[h];
        const Light& colour = is_warning(hit.of) ? s_.warning : s_.colours[std::size_t(hit.of.surface)];
        // As with glass, a surface that is seen at a grazing angle hides more.
        const auto opacity = static_cast<float>(s_.surfaces[std::size_t(hit.of.surface)].opacity);
        const float g = points_.grazing[h];
        const float share = hit.opaque ? left : left * (opacity + (1 - opacity) * 0.7f * g * g * g);
        Light& sum = hit.opaque ? shadowed : open;
        for (int c = 0; c < 3; ++c) sum[c] += (colour[c] * points_.diffuse[h] + points_.shine[h]) * share;
        left -= share;
        if (!hit.opaque) continue;
        if (sample == 0)
          pixels_.buffer.set(x, y, {points_.position[0][h], points_.position[1][h], points_.position[2][h]},
                             {points_.normal[0][h], points_.normal[1][h], points_.normal[2][h]});
        break;
      }
    }
    pixels_.open[row + x] = open;
    pixels_.shadowed[row + x] = shadowed;
    pixels_.painted[row + x] = 1;
  }
}

}  // namespace trephine::picture::detail
