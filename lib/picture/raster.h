// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "picture/camera.h"

namespace trephine::picture::detail {

/// A surface on the screen of `samples` x `samples` supersampled pixels.
struct Projected {
  struct Point {
    std::int32_t x, y;  ///< 1/256 of a sample, so that neighbours share their edges exactly
    float depth;        ///< grows towards the viewer and is linear on the screen: z, or the magnification
    float clip;         ///< signed distance from the clip plane times that magnification; the part above 0 is removed
  };
  std::vector<Point> points;
  std::vector<std::array<float, 3>> normals;  ///< camera coordinates, unit
  const surface::TriMesh* mesh = nullptr;
  /// The triangles whose first row lies in band b are in_band[band_begin[b]] up to band_begin[b + 1]; they end in that
  /// band or the next. Triangles that reach further are in `tall`.
  std::vector<std::uint32_t> band_begin, in_band, tall;
  std::vector<std::uint16_t> last_band;  ///< of each triangle
};

constexpr int band_rows = 32;

Projected project(const surface::TriMesh& mesh, const Camera& camera, int samples, int rows,
                  const std::optional<ClipPlane>& clip);

/// The nearest part of a surface in a band of sample rows.
struct Layer {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;  ///< twice its number, plus 1 where its inner side is seen
  bool empty = true;                    ///< no triangle reaches into the band, and the lists say nothing of it
};

/// Fills the layer for rows [band * band_rows, ...) of `width` samples.
void draw_band(const Projected& surface, int band, int width, int rows, bool clipped, Layer& layer);

/// Weights of the triangle's corners at a sample's centre, in space (not on the screen).
std::array<double, 3> weights_at(const Projected& surface, std::uint32_t triangle, int x, int y, bool perspective);

}  // namespace trephine::picture::detail
