// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace trephine::render {

/// What is looked at from where, in the coordinates of one surface's vertices.
struct Sight {
  enum class Faces { front, back, both };
  struct Plane {
    Vec3 normal;
    double offset = 0;  ///< seen where dot(normal, p) <= offset
  };
  std::vector<Plane> planes;  ///< the frustum's sides, and the cut
  Vec3 eye;
  Faces faces = Faces::both;  ///< which are drawn
  bool loose = true;          ///< with the triangles of no chunk, which stand where a surface is being cut
  bool coarse = false;        ///< coarser where that was made, but not within fine_mm of `near`
  Vec3 near;
  double fine_mm = 0;
};
/// Of the whole picture, relative to centre_mm.
Sight sight_of(const scene::EyeView& eye, const scene::SceneState& state, Vec3 centre_mm);
/// The same in coordinates q where p = axes * q + offset_mm, and axes are orthonormal.
Sight sight_in(const Sight& sight, const Mat3& axes, Vec3 offset_mm);

/// Triangles that lie near each other, in six ranges by where they face, so that whole ranges can be left out.
struct Chunk {
  struct Range {
    std::uint32_t first = 0, count = 0;  ///< of indices
    Vec3 axis;                           ///< of a cone that holds all normals
    double sine = 1;                     ///< of its half angle; 1: it is too wide to say anything
  };
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  Range range[6];
  /// The box becomes one that holds the other's too.
  void include(const Chunk& other);
};

/// Sorts triangles into chunks. `box_of(t)` is the number of the chunk of triangle t; `indices` is rearranged, and
/// where_of[t], if asked for, says where triangle t went (the first of its indices).
template <class Position>
std::vector<Chunk> make_chunks(std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& box_of,
                               std::size_t boxes, const Position& position, std::vector<std::uint32_t>* where_of);

/// Whether something of the chunk may be within the planes; whether the range may show a face.
bool may_be_seen(const Chunk& chunk, const Sight& sight);
bool may_face(const Chunk& chunk, const Chunk::Range& range, const Sight& sight);
/// Distance in mm from Sight::near to the chunk's bounding box.
double away_from_near(const Chunk& chunk, const Sight& sight);

// ----------------------------------------------------------------------------------------------------------------

template <class Position>
std::vector<Chunk> make_chunks(std::vector<std::uint32_t>& indices, const std::vector<std::uint32_t>& box_of,
                               std::size_t boxes, const Position& position, std::vector<std::uint32_t>* where_of) {
  const std::size_t count = indices.size() / 3;
  std::vector<Chunk> chunks(boxes);
  std::vector<std::uint32_t> bin(count), sizes(boxes * 6 + 1, 0);
  std::vector<Vec3> normals(count);
  for (std::size_t t = 0; t < count; ++t) {
    const Vec3 a = position(indices[3 * t]), b = position(indices[3 * t + 1]), c = position(indices[3 * t + 2]);
    normals[t] = normalized(cross(b - a, c - a));
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(normals[t][k]) > std::abs(normals[t][axis])) axis = k;
    bin[t] = box_of[t] * 6 + std::uint32_t(2 * axis + (normals[t][axis] < 0));
    ++sizes[bin[t] + 1];
    Chunk& chunk = chunks[box_of[t]];
    for (const Vec3 p : {a, b, c})
      for (int k = 0; k < 3; ++k) {
        chunk.low[k] = std::min(chunk.low[k], p[k]);
        chunk.high[k] = std::max(chunk.high[k], p[k]);
      }
    chunk.range[bin[t] % 6].axis += normals[t];
  }
  for (std::size_t n = 0; n + 1 < sizes.size(); ++n) sizes[n + 1] += sizes[n];
  for (std::size_t n = 0; n < boxes * 6; ++n) {
    Chunk::Range& r = chunks[n / 6].range[n % 6];
    r.first = 3 * sizes[n];
    r.count = 3 * (sizes[n + 1] - sizes[n]);
    r.axis = normalized(r.axis);
  }
  std::vector<std::uint32_t> sorted(indices.size());
  std::vector<double> least(boxes * 6, 1);
  if (where_of) where_of->resize(count);
  for (std::size_t t = 0; t < count; ++t) {
    const std::uint32_t to = 3 * sizes[bin[t]]++;
    for (std::uint32_t k = 0; k < 3; ++k) sorted[to + k] = indices[3 * t + k];
    if (where_of) (*where_of)[t] = to;
    if (normals[t] != Vec3{})
      least[bin[t]] = std::min(least[bin[t]], dot(normals[t], chunks[bin[t] / 6].range[bin[t] % 6].axis));
  }
  for (std::size_t n = 0; n < boxes * 6; ++n)
    if (least[n] > 0.05) chunks[n / 6].range[n % 6].sine = std::sqrt(std::max(0.0, 1 - least[n] * least[n]));
  indices.swap(sorted);
  return chunks;
}

}  // namespace trephine::render
