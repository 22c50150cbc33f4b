// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/raster.h"

#include <algorithm>
#include <cmath>
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

void draw_triangle(const Projected& s, std::uint32_t number, int x_end, int y_begin, int y_end, bool clipped,
                   Layer& layer) {
  const auto& t = s.mesh->triangles[number];
  const Projected::Point* p[3] = {&s.points[t[0]], &s.points[t[1]], &s.points[t[2]]};
  std::int64_t area = side(p[0]->x, p[0]->y, p[1]->x, p[1]->y, p[2]->x, p[2]->y);
  if (area == 0) return;
  // Counter-clockwise seen from outside, y up, is clockwise here, y down: negative.
  const std::uint32_t value = number * 2 + (area > 0);
  if (area < 0) {
    std::swap(p[1], p[2]);
    area = -area;
  }
  const auto [x_min, x_max] = std::minmax({p[0]->x, p[1]->x, p[2]->x});
  const auto [y_min, y_max] = std::minmax({p[0]->y, p[1]->y, p[2]->y});
  // The range of samples whose centres (i + 1/2) may lie inside.
  const auto first = [](std::int32_t v) { return (v - sub / 2 + sub - 1) >> 8; };
  const auto last = [](std::int32_t v) { return (v - sub / 2) >> 8; };
  const int i0 = std::max(0, first(x_min)), i1 = std::min(x_end - 1, last(x_max));
  const int j0 = std::max(y_begin, first(y_min)), j1 = std::min(y_end - 1, last(y_max));
  if (i0 > i1 || j0 > j1) return;

  std::int64_t row[3], step_x[3], step_y[3];
  for (int e = 0; e < 3; ++e) {
    const Projected::Point &a = *p[(e + 1) % 3], &b = *p[(e + 2) % 3];
    const std::int64_t x = std::int64_t{i0} * sub + sub / 2, y = std::int64_t{j0} * sub + sub / 2;
    row[e] = side(a.x, a.y, b.x, b.y, x, y) - (is_top_left(a, b) ? 0 : 1);
    step_x[e] = -(std::int64_t{b.y} - a.y) * sub;
    step_y[e] = (std::int64_t{b.x} - a.x) * sub;
  }
  const double scale = 1.0 / static_cast<double>(area);
  for (int j = j0; j <= j1; ++j) {
    std::int64_t e0 = row[0], e1 = row[1], e2 = row[2];
    const std::size_t line = std::size_t(j - y_begin) * x_end;
    for (int i = i0; i <= i1; ++i) {
      if ((e0 | e1 | e2) >= 0) {
        const double b0 = static_cast<double>(e0) * scale, b1 = static_cast<double>(e1) * scale, b2 = 1 - b0 - b1;
        const float depth = static_cast<float>(b0 * p[0]->depth + b1 * p[1]->depth + b2 * p[2]->depth);
        const bool kept = !clipped || b0 * p[0]->clip + b1 * p[1]->clip + b2 * p[2]->clip <= 0;
        if (kept && depth > layer.depth[line + i]) {
          layer.depth[line + i] = depth;
          layer.triangle[line + i] = value;
        }
      }
      e0 += step_x[0];
      e1 += step_x[1];
      e2 += step_x[2];
    }
    for (int e = 0; e < 3; ++e) row[e] += step_y[e];
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
      first_band[t] = first > last || behind ? nowhere : static_cast<std::uint16_t>(first / band_rows);
      s.last_band[t] = static_cast<std::uint16_t>(std::max(0, last) / band_rows);
    }
  });
  s.band_begin.assign((rows + band_rows - 1) / band_rows + 1, 0);
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
  const int begin = band * band_rows, end = std::min(rows, begin + band_rows);
  layer.empty = true;
  const auto draw = [&](std::uint32_t t) {
    if (surface.last_band[t] < band) return;
    if (layer.empty) {
      layer.depth.assign(std::size_t(width) * (end - begin), std::numeric_limits<float>::lowest());
      layer.triangle.assign(layer.depth.size(), Layer::none);
      layer.empty = false;
    }
    draw_triangle(surface, t, width, begin, end, clipped, layer);
  };
  for (const std::uint32_t t : surface.tall) draw(t);
  for (int b = std::max(0, band - 1); b <= band; ++b)
    for (std::uint32_t i = surface.band_begin[b]; i < surface.band_begin[b + 1]; ++i) draw(surface.in_band[i]);
}

std::array<double, 3> weights_at(const Projected& s, std::uint32_t triangle, int x, int y, bool perspective) {
  const auto& t = s.mesh->triangles[triangle];
  const auto &a = s.points[t[0]], &b = s.points[t[1]], &c = s.points[t[2]];
  const std::int64_t px = std::int64_t{x} * sub + sub / 2, py = std::int64_t{y} * sub + sub / 2;
  std::array<double, 3> w{double(side(b.x, b.y, c.x, c.y, px, py)), double(side(c.x, c.y, a.x, a.y, px, py)),
                          double(side(a.x, a.y, b.x, b.y, px, py))};
  if (perspective)
    for (int i = 0; i < 3; ++i) w[i] *= s.points[t[i]].depth;
  const double sum = w[0] + w[1] + w[2];
  for (double& v : w) v /= sum;
  return w;
}

}  // namespace trephine::picture::detail
