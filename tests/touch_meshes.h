// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Meshes that a hand can meet in tests, beside volumes.
#include <memory>
#include <vector>

#include "haptics_tools.h"
#include "touch/felt_space.h"

namespace trephine::touched {

using namespace tools;

constexpr int mesh = touch::first_mesh_shape;

/// A closed surface about the origin: r(direction) from its middle, of about 4 rings^2 triangles.
inline surface::TriMesh round_mesh(int rings, const std::function<double(Vec3)>& radius_mm) {
  const int segments = 2 * rings;
  surface::TriMesh m;
  const auto add = [&](double theta, double phi) {
    const Vec3 unit{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    m.points_mm.push_back(unit * radius_mm(unit));
  };
  add(0, 0);
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s) add(M_PI * r / rings, 2 * M_PI * s / segments);
  add(M_PI, 0);
  const auto at = [&](int r, int s) { return std::uint32_t(1 + (r - 1) * segments + s % segments); };
  const auto last = std::uint32_t(m.points_mm.size() - 1);
  for (int s = 0; s < segments; ++s) {
    m.triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    m.triangles.push_back({at(rings - 1, s), last, at(rings - 1, s + 1)});
  }
  return m;
}

/// Hills and valleys as an organ has them, on a ball of 20 mm.
inline double organ_mm(Vec3 u) {
  return 20 * (1 + 0.06 * std::sin(7 * u.x) * std::cos(6 * u.y) + 0.05 * std::sin(9 * u.z));
}

/// An open sheet of n x n squares in the plane through `middle`, along two unit directions.
inline surface::TriMesh sheet(Vec3 middle, Vec3 along, Vec3 across, double side_mm, int n) {
  surface::TriMesh m;
  m.origin_mm = middle;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      m.points_mm.push_back(along * (side_mm * (double(i) / n - 0.5)) + across * (side_mm * (double(j) / n - 0.5)));
  const auto at = [&](int i, int j) { return std::uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

/// A volume, empty unless it is filled, and surfaces beside it.
struct Scene {
  voxel::HapticVolume volume;
  std::unique_ptr<contact::ContactVolume> contact;
  std::unique_ptr<touch::MeshSurfaces> meshes;
  explicit Scene(const std::vector<touch::MeshSurfaces::Part>& parts,
                 voxel::HapticVolume v = haptic_scenes::empty(8, {0.5, 0.5, 0.5}))
      : volume(std::move(v)) {
    if (volume.shapes.empty()) volume.shapes = {voxel::occupancy_shape("none", 1)};
    contact = std::make_unique<contact::ContactVolume>(volume);
    meshes = std::make_unique<touch::MeshSurfaces>(parts, 0.00025 * contact->smallest_side_mm());
  }
  touch::FeltSpace space() const { return {*contact, {meshes.get(), nullptr}}; }
};

}  // namespace trephine::touched
