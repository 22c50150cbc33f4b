// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/rank.h"
#include "grid/resample.h"
#include "meshing/contour.h"
#include "page/pack.h"
#include "voxel/shape_field.h"

namespace trephine::page {
namespace {

void append_varint(std::string& out, std::uint64_t v) {
  for (; v > 127; v >>= 7) out += static_cast<char>((v & 127) | 128);
  out += static_cast<char>(v);
}

std::uint64_t zigzag(std::int64_t v) {
  return v < 0 ? 2 * static_cast<std::uint64_t>(-v) - 1 : 2 * static_cast<std::uint64_t>(v);
}

// Points in the order of their first use.
std::vector<std::uint32_t> append_triangles(const surface::TriMesh& mesh, std::string& out) {
  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> number(mesh.points_mm.size(), unused), order;
  order.reserve(number.size());
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t point : triangle) {
      if (number[point] == unused) {
        number[point] = static_cast<std::uint32_t>(order.size());
        append_varint(out, 0);
        order.push_back(point);
      } else {
        append_varint(out, order.size() - number[point]);
      }
    }
  return order;
}

void append_positions(const surface::TriMesh& mesh, const std::vector<std::uint32_t>& order, PackedSurface& packed) {
  Vec3 least{1e300, 1e300, 1e300}, most{-1e300, -1e300, -1e300};
  for (const std::uint32_t point : order)
    for (int k = 0; k < 3; ++k) {
      least[k] = std::min(least[k], mesh.world_mm(point)[k]);
      most[k] = std::max(most[k], mesh.world_mm(point)[k]);
    }
  packed.min_mm = least;
  packed.size_mm = most - least;
  std::array<std::int64_t, 3> last{0, 0, 0};
  for (const std::uint32_t point : order) {
    const Vec3 at = mesh.world_mm(point) - least;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t q = packed.size_mm[k] > 0 ? std::llround(at[k] / packed.size_mm[k] * 65535) : 0;
      append_varint(packed.bytes, zigzag(q - last[k]));
      last[k] = q;
    }
  }
}

void append_deviations(const std::vector<float>& deviation_mm, const std::vector<std::uint32_t>& order,
                       PackedSurface& packed) {
  std::vector<double> sizes;
  for (const std::uint32_t point : order)
    if (std::isfinite(deviation_mm[point])) sizes.push_back(std::abs(deviation_mm[point]));
  packed.has_deviation = true;
  if (!sizes.empty()) {
    packed.deviation_p99_mm = value_at_rank(sizes, (sizes.size() * 99 + 99) / 100 - 1);
    packed.deviation_scale_mm = *std::max_element(sizes.begin(), sizes.end());
  }
  const double scale = packed.deviation_scale_mm > 0 ? 127 / packed.deviation_scale_mm : 0;
  for (const std::uint32_t point : order) {
    const double d = deviation_mm[point];
    packed.bytes += static_cast<char>(std::isfinite(d) ? std::lround(d * scale) : -128);
  }
}

// A closed contour has a point on every edge of the raster that it crosses, and twice as many triangles.
std::uint64_t contour_triangles(const grid::Field& field) {
  std::uint64_t crossings = 0;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        const bool in = field.at(i, j, k) > 0;
        crossings += (i + 1 < field.size[0] && in != (field.at(i + 1, j, k) > 0)) +
                     (j + 1 < field.size[1] && in != (field.at(i, j + 1, k) > 0)) +
                     (k + 1 < field.size[2] && in != (field.at(i, j, k + 1) > 0));
      }
  return 2 * crossings;
}

grid::Field coarser(grid::Field field, double factor) {
  grid::ResampleParams params;
  for (int k = 0; k < 3; ++k) params.spacing_mm[k] = field.spacing_mm[k] * factor;
  return std::get<grid::Field>(grid::resample(grid::HuVolume(std::move(field)), params).value);
}

}  // namespace

PackedSurface pack_surface(const surface::TriMesh& mesh, const std::vector<float>& deviation_mm) {
  surface::check_mesh(mesh);
  if (!deviation_mm.empty() && deviation_mm.size() != mesh.points_mm.size())
    throw Error(ExitCode::internal, "", "deviation_mm", "is not one value a point");
  PackedSurface packed;
  packed.bytes.reserve(mesh.triangles.size() * 7);
  const std::vector<std::uint32_t> order = append_triangles(mesh, packed.bytes);
  packed.points = order.size();
  packed.triangles = mesh.triangles.size();
  if (order.empty()) return packed;
  append_positions(mesh, order, packed);
  if (!deviation_mm.empty()) append_deviations(deviation_mm, order, packed);
  return packed;
}

surface::TriMesh felt_surface_for_page(const voxel::HapticVolume& volume, int number, std::uint64_t triangles,
                                       const Progress& progress) {
  grid::Field field = voxel::shape_field(volume, number, progress);
  const std::uint64_t count = contour_triangles(field);
  if (count > triangles) field = coarser(std::move(field), std::sqrt(double(count) / double(triangles)));
  try {
    return meshing::contour_to_look_at(field, progress);
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
    return {};  // nothing of it is left on voxels of that size
  }
}

}  // namespace trephine::page
