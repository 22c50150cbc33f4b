// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_parts.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/parallel.h"

namespace trephine::render {
namespace {

constexpr double chunk_mm = 25;
constexpr int chunk_bricks = 4;

Vec3 vec(const float* p) { return {p[0], p[1], p[2]}; }

void turn_axes(std::vector<Chunk>& chunks) {
  for (Chunk& chunk : chunks)
    for (Chunk::Range& r : chunk.range) r.axis = r.axis * -1;
}

}  // namespace

SurfaceParts parts_of(const scene::SceneSurface& s) {
  SurfaceParts out;
  out.vertices = s.vertices;
  out.indices = s.indices;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> box_of(s.indices.size() / 3);
  for (std::size_t t = 0; t < box_of.size(); ++t) {
    std::uint64_t key = 0;
    for (int a = 0; a < 3; ++a)
      key = key << 20 |
            (std::uint64_t(std::floor(s.vertices[s.indices[3 * t]].position_mm[a] / chunk_mm) + 524288) & 0xfffff);
    box_of[t] = numbers.emplace(key, std::uint32_t(numbers.size())).first->second;
  }
  out.chunks = make_chunks(
      out.indices, box_of, numbers.size(), [&](std::uint32_t v) { return vec(out.vertices[v].position_mm); }, nullptr);
  return out;
}

scene::SceneVertex packed(const drill::LiveVertex& v) {
  scene::SceneVertex out;
  for (int a = 0; a < 3; ++a) {
    out.position_mm[a] = v.position_mm[a];
    out.normal[a] = std::int8_t(std::lrint(127 * std::clamp(v.normal[a], -1.f, 1.f)));
  }
  out.normal[3] = 0;
  return out;
}

void append(const drill::BrickMesh& mesh, bool mirrored, std::uint32_t first_vertex,
            std::vector<scene::SceneVertex>& vertices, std::vector<std::uint32_t>& indices) {
  for (const drill::LiveVertex& v : mesh.vertices) vertices.push_back(packed(v));
  const std::size_t begin = indices.size();
  for (const std::uint16_t i : mesh.indices) indices.push_back(first_vertex + i);
  if (mirrored)
    for (std::size_t n = begin; n + 2 < indices.size(); n += 3) std::swap(indices[n + 1], indices[n + 2]);
}

SurfaceParts parts_of(const drill::LiveSurface& surface, bool mirrored, BrickPlaces& places) {
  const drill::BrickLayout& layout = surface.layout();
  const std::size_t count = layout.count();
  int boxes[3];
  for (std::size_t a = 0; a < 3; ++a) boxes[a] = (layout.bricks[a] + chunk_bricks - 1) / chunk_bricks;
  SurfaceParts out;
  out.mirrored = mirrored;
  places.chunk_of.assign(count, 0);
  places.first.assign(count + 1, 0);
  std::vector<std::uint32_t> box_of;
  std::size_t vertices = 0;
  for (std::size_t b = 0; b < count; ++b) vertices += surface.brick(b).vertices.size();
  const std::size_t triangles = surface.triangles();
  out.vertices.reserve(vertices);
  out.indices.reserve(3 * triangles);
  box_of.reserve(triangles);
  for (std::size_t b = 0; b < count; ++b) {
    append(surface.brick(b), mirrored, std::uint32_t(out.vertices.size()), out.vertices, out.indices);
    places.first[b + 1] = std::uint32_t(out.indices.size() / 3);
    const std::array<int, 3> at = layout.place(b);
    const int box = (at[2] / chunk_bricks * boxes[1] + at[1] / chunk_bricks) * boxes[0] + at[0] / chunk_bricks;
    places.chunk_of[b] = std::uint32_t(box);
    box_of.resize(out.indices.size() / 3, std::uint32_t(box));
  }
  out.chunks = make_chunks(
      out.indices, box_of, std::size_t(boxes[0] * boxes[1] * boxes[2]),
      [&](std::uint32_t v) { return vec(out.vertices[v].position_mm); }, &places.where);
  // The normals of mirrored triangles point the right way after the model's mirroring: chunks know them as they are in
  // the lattice.
  if (mirrored) turn_axes(out.chunks);
  return out;
}

std::optional<CoarseParts> coarse_parts(const SurfaceParts& whole, double within_mm, std::size_t max_bytes,
                                        const Progress& progress) {
  CoarseTriangles coarse = coarse_triangles(whole.vertices, whole.indices, within_mm, progress);
  if (coarse.indices.empty() || !is_worth_it(coarse.indices.size(), whole.indices.size()) ||
      coarse.indices.size() * sizeof(std::uint32_t) > max_bytes)
    return std::nullopt;
  CoarseParts out;
  on_one_thread([&] { out.facts = coarse_facts(whole.vertices, whole.indices.size() / 3, coarse.indices, progress); });
  std::vector<std::uint32_t> chunk_of(whole.indices.size() / 3);
  for (std::size_t n = 0; n < whole.chunks.size(); ++n)
    for (const Chunk::Range& r : whole.chunks[n].range)
      std::fill_n(chunk_of.begin() + r.first / 3, r.count / 3, std::uint32_t(n));
  std::vector<std::uint32_t> box_of;
  box_of.reserve(coarse.from.size());
  for (const std::uint32_t t : coarse.from) box_of.push_back(chunk_of[t]);
  progress.check();
  out.indices = std::move(coarse.indices);
  out.chunks = make_chunks(
      out.indices, box_of, whole.chunks.size(), [&](std::uint32_t v) { return vec(whole.vertices[v].position_mm); },
      nullptr);
  if (whole.mirrored) turn_axes(out.chunks);
  return out;
}

}  // namespace trephine::render
