// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/shape_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "base/error.h"
#include "drill/live_surface.h"

namespace trephine::peers {
namespace {

using Place = std::array<float, 3>;

// Numbers equal places, in the order in which they first come.
class Places {
 public:
  std::uint32_t number(const Place& place) {
    return number_.emplace(place, std::uint32_t(number_.size())).first->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const Place& p) const {
      std::uint32_t bits[3];
      std::memcpy(bits, p.data(), sizeof bits);
      return (bits[0] * 0x9e3779b97f4a7c15ull ^ bits[1]) * 0xbf58476d1ce4e5b9ull ^ bits[2] * 0x94d049bb133111ebull;
    }
  };
  std::unordered_map<Place, std::uint32_t, Hash> number_;
};

// Each triangle in four, by the middles of its sides.
surface::TriMesh parted_in_four(const surface::TriMesh& mesh) {
  surface::TriMesh out;
  out.origin_mm = mesh.origin_mm;
  std::vector<Vec3> points = mesh.points_mm;
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  middles.reserve(mesh.triangles.size() * 3 / 2);
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middles.emplace(std::uint64_t(std::min(a, b)) << 32 | std::max(a, b), std::uint32_t(points.size()));
    if (is_new) points.push_back((points[a] + points[b]) * 0.5);
    return at->second;
  };
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(4 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const std::uint32_t ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    triangles.push_back({t[0], ab, ca});
    triangles.push_back({ab, t[1], bc});
    triangles.push_back({ca, bc, t[2]});
    triangles.push_back({ab, bc, ca});
  }
  out.points_mm = std::move(points);
  out.triangles = std::move(triangles);
  return out;
}

}  // namespace

surface::TriMesh mesh_of_shape(const voxel::HapticVolume& volume, int shape) {
  const drill::LiveSurface live(volume, shape);
  const grid::Lattice& l = volume.voxels;
  const bool mirrored = determinant(l.direction) < 0;
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Places places;
  std::vector<std::uint32_t> number;
  for (std::size_t brick = 0; brick < live.layout().count(); ++brick) {
    const drill::BrickMesh& part = live.brick(brick);
    number.clear();
    for (const drill::LiveVertex& v : part.vertices) {
      number.push_back(places.number({v.position_mm[0], v.position_mm[1], v.position_mm[2]}));
      if (number.back() == points.size())
        points.push_back(l.direction * Vec3{v.position_mm[0], v.position_mm[1], v.position_mm[2]});
    }
    for (std::size_t n = 0; n + 2 < part.indices.size(); n += 3) {
      std::array<std::uint32_t, 3> t = {number[part.indices[n]], number[part.indices[n + 1]],
                                        number[part.indices[n + 2]]};
      if (mirrored) std::swap(t[1], t[2]);
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
  }
  if (triangles.empty()) throw Error(ExitCode::bad_input, "", "shape", "has no surface in the haptic volume");
  surface::TriMesh mesh;
  mesh.origin_mm = l.origin_mm;
  mesh.points_mm = std::move(points);
  mesh.triangles = std::move(triangles);
  return mesh;
}

surface::TriMesh with_triangles(const surface::TriMesh& mesh, std::size_t triangles, double* off_mm) {
  if (off_mm) *off_mm = 0;
  surface::TriMesh out = mesh;
  while (out.triangles.size() < triangles) out = parted_in_four(out);
  if (out.triangles.size() == triangles) return out;
  std::vector<float> points;
  points.reserve(3 * out.points_mm.size());
  for (const Vec3 p : out.points_mm) points.insert(points.end(), {float(p.x), float(p.y), float(p.z)});
  std::vector<unsigned> indices;
  indices.reserve(3 * out.triangles.size());
  for (const auto& t : out.triangles) indices.insert(indices.end(), t.begin(), t.end());
  std::vector<unsigned> left(indices.size());
  float error = 0;
  left.resize(meshopt_simplify(left.data(), indices.data(), indices.size(), points.data(), out.points_mm.size(),
                               3 * sizeof(float), 3 * triangles, 1.0f, 0, &error));
  if (off_mm)
    *off_mm = double(error) * double(meshopt_simplifyScale(points.data(), out.points_mm.size(), 3 * sizeof(float)));
  surface::TriMesh fewer;
  fewer.origin_mm = out.origin_mm;
  fewer.points_mm = out.points_mm;
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (std::size_t n = 0; n + 2 < left.size(); n += 3) kept.push_back({left[n], left[n + 1], left[n + 2]});
  fewer.triangles = std::move(kept);
  surface::drop_unused_points(fewer);
  return fewer;
}

}  // namespace trephine::peers
