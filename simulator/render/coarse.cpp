// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/coarse.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>

#include "surface/point_to_mesh.h"

namespace trephine::render {
namespace {

constexpr std::uint32_t none = 0xffffffff;
constexpr std::size_t check_every = 1 << 16;  // vertices

struct Cell {
  double sum[3] = {0, 0, 0};
  std::uint32_t count = 0, nearest = none;
  double away = 0;
};

double away_from_mean(const scene::SceneVertex& v, const Cell& c) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = v.position_mm[a] - c.sum[a] / c.count;
    sum += d * d;
  }
  return sum;
}

Vec3 place_of(const scene::SceneVertex& v) { return {v.position_mm[0], v.position_mm[1], v.position_mm[2]}; }

CoarseFacts facts_of(const std::vector<scene::SceneVertex>& places, std::size_t whole_triangles,
                     const std::vector<scene::SceneVertex>& vertices, const std::vector<std::uint32_t>& indices,
                     const Progress& progress) {
  surface::TriMesh coarse;
  std::vector<std::uint32_t> number(vertices.size(), none);
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = indices[t + k];
      if (number[v] == none) {
        number[v] = std::uint32_t(coarse.points_mm.size());
        coarse.points_mm.push_back(place_of(vertices[v]));
      }
      corners[k] = number[v];
    }
    coarse.triangles.push_back(corners);
  }
  std::vector<Vec3> all;
  all.reserve(places.size());
  for (const scene::SceneVertex& v : places) all.push_back(place_of(v));
  const double worst_mm = surface::PointToMesh(coarse, progress).largest_distance_mm(all, 0, progress);
  return {whole_triangles, indices.size() / 3, places.size(), worst_mm, 0};
}

}  // namespace

CoarseTriangles coarse_triangles(const std::vector<scene::SceneVertex>& vertices,
                                 const std::vector<std::uint32_t>& indices, double within_mm,
                                 const Progress& progress) {
  const double side = within_mm / std::sqrt(3.0);  // two places in a cell are no further apart than within_mm
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  numbers.reserve(vertices.size() / 4);
  std::vector<Cell> cells;
  std::vector<std::uint32_t> cell_of(vertices.size());
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    if (n % check_every == 0) progress.check();
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a)
      key = key << 21 | (std::uint64_t(std::floor(vertices[n].position_mm[a] / side) + (1 << 20)) & 0x1fffff);
    const auto [at, fresh] = numbers.emplace(key, std::uint32_t(cells.size()));
    if (fresh) cells.emplace_back();
    cell_of[n] = at->second;
    Cell& cell = cells[at->second];
    for (int a = 0; a < 3; ++a) cell.sum[a] += vertices[n].position_mm[a];
    ++cell.count;
  }
  progress.check();
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    Cell& cell = cells[cell_of[n]];
    const double away = away_from_mean(vertices[n], cell);
    if (cell.nearest != none && away >= cell.away) continue;
    cell.nearest = std::uint32_t(n);
    cell.away = away;
  }
  progress.check();
  CoarseTriangles out;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const std::uint32_t a = cell_of[indices[t]], b = cell_of[indices[t + 1]], c = cell_of[indices[t + 2]];
    if (a == b || b == c || c == a) continue;
    for (const std::uint32_t cell : {a, b, c}) out.indices.push_back(cells[cell].nearest);
    out.from.push_back(std::uint32_t(t / 3));
  }
  return out;
}

scene::SceneSurface coarse_surface(const scene::SceneSurface& whole, double within_mm, const Progress& progress) {
  const CoarseTriangles coarse = coarse_triangles(whole.vertices, whole.indices, within_mm, progress);
  if (coarse.indices.empty()) return whole;
  scene::SceneSurface out{
      whole.name, whole.colour_rgb, whole.opacity, whole.shape, whole.live, whole.incised, whole.skin, {}, {}};
  std::vector<std::uint32_t> number(whole.vertices.size(), none);
  for (const std::uint32_t v : coarse.indices) {
    if (number[v] == none) {
      number[v] = std::uint32_t(out.vertices.size());
      out.vertices.push_back(whole.vertices[v]);
    }
    out.indices.push_back(number[v]);
  }
  return out;
}

CoarseFacts coarse_facts(const scene::SceneSurface& whole, const scene::SceneSurface& coarse,
                         const Progress& progress) {
  return facts_of(whole.vertices, whole.indices.size() / 3, coarse.vertices, coarse.indices, progress);
}

CoarseFacts coarse_facts(const std::vector<scene::SceneVertex>& vertices, std::size_t whole_triangles,
                         const std::vector<std::uint32_t>& coarse_indices, const Progress& progress) {
  CoarseFacts facts = facts_of(vertices, whole_triangles, vertices, coarse_indices, progress);
  facts.bytes = coarse_indices.size() * sizeof(std::uint32_t);
  return facts;
}

std::vector<std::string> CoarseFacts::values(const std::string& name) const {
  return {name, std::to_string(left), std::to_string(whole), std::to_string(places), fmt::format("{:.2f}", worst_mm)};
}

}  // namespace trephine::render
