// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "picture/camera.h"

namespace trephine::picture::detail {

/// Sample rows of a band: those of whole pixels.
constexpr int band_rows_of(int samples) { return 32 / samples * samples; }

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
  int band_rows = 0;
  /// The triangles whose first row lies in band b are in_band[band_begin[b]] up to band_begin[b + 1]; they end in that
  /// band or the next. Triangles that reach further are in `tall`.
  std::vector<std::uint32_t> band_begin, in_band, tall;
  std::vector<std::uint16_t> last_band;  ///< of each triangle
};

Projected project(const surface::TriMesh& mesh, const Camera& camera, int samples, int rows,
                  const std::optional<ClipPlane>& clip);

/// The nearest part of a surface in a band of sample rows, each of stride_of(width) samples.
struct Layer {
  static constexpr std::uint32_t none = 0xffffffffu;
  /// Rows are filled four samples at a time; what stands beyond the width means nothing.
  static int stride_of(int width) { return (width + 3) / 4 * 4; }
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;  ///< twice its number, plus 1 where its inner side is seen
  bool empty = true;                    ///< no triangle reaches into the band, and the lists say nothing of it
};

/// Fills the layer for the band's rows of `width` samples.
void draw_band(const Projected& surface, int band, int width, int rows, bool clipped, Layer& layer);

/// Weights of the triangle's corners at a sample's centre, in space (not on the screen). Their sum is positive where
/// the inner side is seen, otherwise negative, and of any size.
std::array<float, 3> weights_at(const Projected& surface, std::uint32_t triangle, int x, int y, bool perspective);

}  // namespace trephine::picture::detail
