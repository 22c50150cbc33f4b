// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/raster.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "surface/vertex_normals.h"

namespace trephine::picture::detail {
namespace {

constexpr int sub = 256;  // steps of a sample

// Twice the signed area of the triangle a, b, p.
std::int64_t side(std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t px,
                  std::int64_t py) {
  return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
}

std::int32_t snapped(double v) {
  return std::isfinite(v) ? static_cast<std::int32_t>(std::lround(std::clamp(v * sub, -1e8, 1e8))) : 0;
}

// An edge belongs to the triangle that has it on its upper or left side.
bool is_top_left(const Projected::Point& a, const Projected::Point& b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

// A triangle in the samples of a band. Edge e lies across from corner e; its value at a sample is twice the area of the
// triangle of both, less 1 on an edge that belongs to the neighbour: not negative inside.
struct Drawn {
  const Projected::Point* corner[3];
  std::uint32_t value;  // as Layer::triangle
  std::int64_t area;    // twice its area
  int i0, i1, j0, j1;   // samples whose centres may lie inside, both ends included
  std::int32_t size;    // of its box, in steps
  std::int64_t edge[3], step_x[3], step_y[3];

  // The values of the edges at a sample.
  void start_at(int i, int j) {
    for (int e = 0; e < 3; ++e) {
      const Projected::Point &a = *corner[(e + 1) % 3], &b = *corner[(e + 2) % 3];
      const std::int64_t x = std::int64_t{i} * sub + sub / 2, y = std::int64_t{j} * sub + sub / 2;
      edge[e] = side(a.x, a.y, b.x, b.y, x, y) - (is_top_left(a, b) ? 0 : 1);
      step_x[e] = -(std::int64_t{b.y} - a.y) * sub;
      step_y[e] = (std::int64_t{b.x} - a.x) * sub;
    }
  }
};

// False where it covers nothing of the band.
bool place(const Projected& s, std::uint32_t number, int width, int y_begin, int y_end, Drawn& d) {
  const auto& t = s.mesh->triangles[number];
  auto& p = d.corner;
  for (int c = 0; c < 3; ++c) p[c] = &s.points[t[c]];
  const auto [x_min, x_max] = std::minmax({p[0]->x, p[1]->x, p[2]->x});
  const auto [y_min, y_max] = std::minmax({p[0]->y, p[1]->y, p[2]->y});
  const auto first = [](std::int32_t v) { return (v - sub / 2 + sub - 1) >> 8; };
  const auto last = [](std::int32_t v) { return (v - sub / 2) >> 8; };
  d.i0 = std::max(0, first(x_min)), d.i1 = std::min(width - 1, last(x_max));
  d.j0 = std::max(y_begin, first(y_min)), d.j1 = std::min(y_end - 1, last(y_max));
  if (d.i0 > d.i1 || d.j0 > d.j1) return false;
  d.size = std::max(x_max - x_min, y_max - y_min);
  d.area = side(p[0]->x, p[0]->y, p[1]->x, p[1]->y, p[2]->x, p[2]->y);
  if (d.area == 0) return false;
  // Counter-clockwise seen from outside, y up, is clockwise here, y down: negative.
  d.value = number * 2 + (d.area > 0);
  if (d.area < 0) {
    std::swap(p[1], p[2]);
    d.area = -d.area;
  }
  return true;
}

void draw_sample_by_sample(Drawn& d, int stride, int y_begin, bool clipped, Layer& layer) {
  d.start_at(d.i0, d.j0);
  const auto& p = d.corner;
  const double scale = 1.0 / static_cast<double>(d.area);
  for (int j = d.j0; j <= d.j1; ++j) {
    std::int64_t e0 = d.edge[0], e1 = d.edge[1], e2 = d.edge[2];
    const std::size_t line = std::size_t(j - y_begin) * stride;
    for (int i = d.i0; i <= d.i1; ++i) {
      if ((e0 | e1 | e2) >= 0) {
        const double b0 = static_cast<double>(e0) * scale, b1 = static_cast<double>(e1) * scale, b2 = 1 - b0 - b1;
        const float depth = static_cast<float>(b0 * p[0]->depth + b1 * p[1]->depth + b2 * p[2]->depth);
        const bool kept = !clipped || b0 * p[0]->clip + b1 * p[1]->clip + b2 * p[2]->clip <= 0;
        if (kept && depth > layer.depth[line + i]) {
          layer.depth[line + i] = depth;
          layer.triangle[line + i] = d.value;
        }
      }
      e0 += d.step_x[0];
      e1 += d.step_x[1];
      e2 += d.step_x[2];
    }
    for (int e = 0; e < 3; ++e) d.edge[e] += d.step_y[e];
  }
}

// Most triangles are small, and half the time of a picture would go into them: four samples at a time, in 32 bits. The
// product of two differences within the box, and three samples beside it, keeps below 2^29.
constexpr std::int32_t small = 64 * sub;
using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));

void draw_four_by_four(Drawn& d, int stride, int y_begin, Layer& layer) {
  const int begin = d.i0 / 4 * 4;
  d.start_at(begin, d.j0);
  Ints row[3], step[3];
  for (int e = 0; e < 3; ++e) {
    const auto x = static_cast<std::int32_t>(d.step_x[e]);
    row[e] = static_cast<std::int32_t>(d.edge[e]) + Ints{0, x, 2 * x, 3 * x};
    step[e] = Ints{} + 4 * x;
  }
  const float scale = 1.f / static_cast<float>(d.area), base = d.corner[0]->depth;
  const float to_1 = (d.corner[1]->depth - base) * scale, to_2 = (d.corner[2]->depth - base) * scale;
  const Ints value = Ints{} + static_cast<std::int32_t>(d.value);
  for (int j = d.j0; j <= d.j1; ++j) {
    const std::size_t line = std::size_t(j - y_begin) * stride;
    Ints e0 = row[0], e1 = row[1], e2 = row[2];
    for (int i = begin; i <= d.i1; i += 4) {
      Floats seen;
      Ints by;
      std::memcpy(&seen, &layer.depth[line + i], sizeof seen);
      std::memcpy(&by, &layer.triangle[line + i], sizeof by);
      const Floats depth =
          base + __builtin_convertvector(e1, Floats) * to_1 + __builtin_convertvector(e2, Floats) * to_2;
      const Ints nearer = ((e0 | e1 | e2) >= 0) & (depth > seen);
      seen = nearer ? depth : seen;
      by = nearer ? value : by;
      std::memcpy(&layer.depth[line + i], &seen, sizeof seen);
      std::memcpy(&layer.triangle[line + i], &by, sizeof by);
      e0 += step[0], e1 += step[1], e2 += step[2];
    }
    for (int e = 0; e < 3; ++e) row[e] += static_cast<std::int32_t>(d.step_y[e]);
  }
}

constexpr std::int64_t grain = 1 << 14;

void sort_into_bands(Projected& s, bool perspective, int rows) {
  const auto& triangles = s.mesh->triangles;
  constexpr std::uint16_t nowhere = 0xffff;
  std::vector<std::uint16_t> first_band(triangles.size());
  s.last_band.resize(triangles.size());
  parallel_for(0, static_cast<std::int64_t>(triangles.size()), grain, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t t = from; t < to; ++t) {
      const auto &a = s.points[triangles[t][0]], &b = s.points[triangles[t][1]], &c = s.points[triangles[t][2]];
      const auto [low, high] = std::minmax({a.y, b.y, c.y});
      const int first = std::max(0, low >> 8), last = std::min(rows - 1, high >> 8);
      const bool behind = perspective && !(std::min({a.depth, b.depth, c.depth}) > 0);
      first_band[t] = first > last || behind ? nowhere : static_cast<std::uint16_t>(first / s.band_rows);
      s.last_band[t] = static_cast<std::uint16_t>(std::max(0, last) / s.band_rows);
    }
  });
  s.band_begin.assign((rows + s.band_rows - 1) / s.band_rows + 1, 0);
  const auto is_tall = [&](std::size_t t) { return s.last_band[t] > first_band[t] + 1; };
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (first_band[t] != nowhere && !is_tall(t)) ++s.band_begin[first_band[t] + 1];
  for (std::size_t b = 1; b < s.band_begin.size(); ++b) s.band_begin[b] += s.band_begin[b - 1];
  s.in_band.resize(s.band_begin.back());
  std::vector<std::uint32_t> next(s.band_begin.begin(), s.band_begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (first_band[t] == nowhere) continue;
    if (is_tall(t))
      s.tall.push_back(static_cast<std::uint32_t>(t));
    else
      s.in_band[next[first_band[t]]++] = static_cast<std::uint32_t>(t);
  }
}

}  // namespace

Projected project(const surface::TriMesh& mesh, const Camera& camera, int samples, int rows,
                  const std::optional<ClipPlane>& clip) {
  Projected out;
  out.mesh = &mesh;
  out.band_rows = band_rows_of(samples);
  out.points.resize(mesh.points_mm.size());
  out.normals.resize(mesh.points_mm.size());
  std::vector<Vec3> own;
  if (mesh.normals.empty()) own = surface::vertex_normals(mesh);
  const auto& normals = mesh.normals.empty() ? own : mesh.normals;
  parallel_for(0, static_cast<std::int64_t>(mesh.points_mm.size()), grain, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      const Vec3 world = mesh.world_mm(i), c = camera.to_camera(world);
      const double m = camera.magnification(c.z);
      auto& p = out.points[i];
      p.x = snapped(camera.screen_x(c) * samples);
      p.y = snapped(camera.screen_y(c) * samples);
      p.depth = static_cast<float>(camera.distance_mm > 0 ? m : c.z);
      p.clip = clip ? static_cast<float>(dot(world - clip->point_mm, normalized(clip->normal)) * m) : 0.f;
      const Vec3 n = normalized(normals[i]);
      out.normals[i] = {float(dot(n, camera.right)), float(dot(n, camera.up)), float(dot(n, camera.toward))};
    }
  });
  sort_into_bands(out, camera.distance_mm > 0, rows);
  return out;
}

void draw_band(const Projected& surface, int band, int width, int rows, bool clipped, Layer& layer) {
  const int begin = band * surface.band_rows, end = std::min(rows, begin + surface.band_rows);
  const int stride = Layer::stride_of(width);
  layer.empty = true;
  Drawn d;
  const auto draw = [&](std::uint32_t t) {
    if (surface.last_band[t] < band || !place(surface, t, width, begin, end, d)) return;
    if (layer.empty) {
      layer.depth.assign(std::size_t(stride) * (end - begin), std::numeric_limits<float>::lowest());
      layer.triangle.assign(layer.depth.size(), Layer::none);
      layer.empty = false;
    }
    if (clipped || d.size > small)
      draw_sample_by_sample(d, stride, begin, clipped, layer);
    else
      draw_four_by_four(d, stride, begin, layer);
  };
  for (const std::uint32_t t : surface.tall) draw(t);
  for (int b = std::max(0, band - 1); b <= band; ++b)
    for (std::uint32_t i = surface.band_begin[b]; i < surface.band_begin[b + 1]; ++i) draw(surface.in_band[i]);
}

std::array<float, 3> weights_at(const Projected& s, std::uint32_t triangle, int x, int y, bool perspective) {
  const auto& t = s.mesh->triangles[triangle];
  const auto &a = s.points[t[0]], &b = s.points[t[1]], &c = s.points[t[2]];
  const std::int64_t px = std::int64_t{x} * sub + sub / 2, py = std::int64_t{y} * sub + sub / 2;
  std::array<float, 3> w{float(side(b.x, b.y, c.x, c.y, px, py)), float(side(c.x, c.y, a.x, a.y, px, py)),
                         float(side(a.x, a.y, b.x, b.y, px, py))};
  if (perspective)
    for (int i = 0; i < 3; ++i) w[i] *= s.points[t[i]].depth;
  return w;
}

}  // namespace trephine::picture::detail
