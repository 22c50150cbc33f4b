// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/normals.h"

#include <algorithm>

#include "base/parallel.h"
#include "surface/incidence.h"
#include "surface/vertex_normals.h"

namespace trephine::meshing {

NormalsResult compute_normals(surface::TriMesh& mesh, const NormalsParams& params, const Progress& progress) {
  mesh.normals.clear();
  surface::check_mesh(mesh);
  const surface::TriMesh& in = mesh;
  const surface::Incidence incidence(in);
  progress.report(0.3);
  std::vector<Vec3> normals(mesh.points_mm.size());
  std::vector<char> replaced(mesh.points_mm.size(), 0);
  parallel_for(0, static_cast<std::int64_t>(normals.size()), 16384, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (std::int64_t p = from; p < to; ++p) {
      Vec3 sum, largest;
      double total = 0;
      for (std::uint32_t n = incidence.begin[p]; n < incidence.begin[p + 1]; ++n) {
        const std::uint32_t t = incidence.triangle[n];
        const auto& v = in.triangles[t];
        const int c = v[0] == p ? 0 : v[1] == p ? 1 : 2;
        const Vec3 a = in.points_mm[v[(c + 1) % 3]] - in.points_mm[p];
        const Vec3 b = in.points_mm[v[(c + 2) % 3]] - in.points_mm[p];
        const Vec3 twice_area = cross(a, b);
        const double weight = params.weight == NormalWeight::area ? norm(twice_area) : surface::steady_angle(a, b);
        sum += normalized(twice_area) * weight;
        total += weight;
        if (norm(twice_area) > norm(largest)) largest = twice_area;
      }
      replaced[p] = !(norm(sum) > 1e-6 * total);
      normals[p] = normalized(replaced[p] ? largest : sum);
      if (!(norm(normals[p]) > 0.5)) normals[p] = {0, 0, 1};
    }
  });
  mesh.normals = std::move(normals);
  progress.report(1);
  return {mesh.normals.size(), static_cast<std::int64_t>(std::count(replaced.begin(), replaced.end(), 1))};
}

}  // namespace trephine::meshing
