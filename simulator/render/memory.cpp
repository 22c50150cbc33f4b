// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/memory.h"

#include <algorithm>

namespace trephine::render {

std::size_t bytes_of(const scene::SceneSurface& s) {
  return s.vertices.size() * sizeof(scene::SceneVertex) + s.indices.size() * sizeof(std::uint32_t);
}

std::size_t picture_bytes(int width, int height, int samples) {
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  return pixels * 8 + pixels / 2 + (samples > 1 ? pixels * 8 * std::size_t(samples) : 0);
}

grid::Grid<std::int16_t> halved(const grid::Grid<std::int16_t>& grid) {
  grid::Grid<std::int16_t> out;
  static_cast<grid::Lattice&>(out) = grid;
  Vec3 first;  // of the new lattice, in voxels of the old one
  for (std::size_t a = 0; a < 3; ++a) {
    out.size[a] = (grid.size[a] + 1) / 2;
    first[int(a)] = grid.size[a] > 1 ? 0.5 : 0;
    out.spacing_mm[int(a)] = grid.spacing_mm[int(a)] * 2;
  }
  out.origin_mm = grid.to_world_mm(first);
  out.voxels.resize(out.count());
  const auto last = [&](int n, std::size_t a) { return std::min(n, grid.size[a] - 1); };
  std::size_t at = 0;
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i) {
        int sum = 0;
        for (int c = 0; c < 8; ++c)
          sum += grid.at(last(2 * i + (c & 1), 0), last(2 * j + (c >> 1 & 1), 1), last(2 * k + (c >> 2), 2));
        out.voxels[at++] = std::int16_t(sum >= 0 ? (sum + 4) / 8 : -((4 - sum) / 8));
      }
  return out;
}

}  // namespace trephine::render
