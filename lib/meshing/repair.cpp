// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "base/time_limit.h"
#include "meshing/repair_child.h"
#include "meshing/repair_soup.h"
#include "meshing/repair_winding.h"
#include "meshing/validity.h"
#include "surface/point_to_mesh.h"

namespace trephine::meshing {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int rounds = 3;
constexpr double max_changed_ratio = 0.05;

struct Repaired {
  surface::TriMesh mesh;
  SoupCounts soup;
  Mended mended;
  double voxel_mm = 0;
};

void add(SoupCounts& to, const SoupCounts& more) {
  to.merged += more.merged;
  to.sideless += more.sideless;
  to.duplicates += more.duplicates;
  to.fins += more.fins;
  to.sheets += more.sheets;
  to.flipped += more.flipped;
  to.split += more.split;
}

/// How far the mesh lies from the surface, measured at the points and the centres of its triangles.
double reach_mm(const surface::TriMesh& mesh, const surface::PointToMesh& surface, const Progress& progress) {
  std::vector<Vec3> points;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points_mm[t[0]], b = mesh.points_mm[t[1]], c = mesh.points_mm[t[2]];
    for (const Vec3 p : {a, b, c, (a + b + c) / 3}) points.push_back(mesh.origin_mm + p);
  }
  return surface.largest_distance_mm(points, 0, progress);
}

/// A number of a Halton sequence: as even as a raster, but its points do not lie on facets.
double halton(std::uint32_t i, std::uint32_t base) {
  double f = 1, r = 0;
  for (++i; i > 0; i /= base) r += (f /= base) * (i % base);
  return r;
}

/// The share of the space within the soup (winding number above 1/2) or the mesh that lies within only one of them.
double changed_ratio(const surface::TriMesh& soup, const surface::TriMesh& mesh) {
  const surface::Bounds b = surface::bounds_of(soup);
  const WindingNumber before(soup), after(mesh);
  constexpr int count = 20000;
  std::vector<char> in(count, 0);
  parallel_for(0, count, 500, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      const Vec3 s = b.max_mm - b.min_mm;
      const auto n = static_cast<std::uint32_t>(i);
      const Vec3 p = b.min_mm + Vec3{s.x * halton(n, 2), s.y * halton(n, 3), s.z * halton(n, 5)};
      in[i] = static_cast<char>((before.at(p - soup.origin_mm) > 0.5) + 2 * (after.at(p - mesh.origin_mm) > 0.5));
    }
  });
  const auto any = count - std::count(in.begin(), in.end(), 0), both = std::count(in.begin(), in.end(), 3);
  return any > 0 ? double(any - both) / double(any) : 0;
}

/// Repairs the mesh in place and returns false where the result is not valid. `cleaned` receives the soup as an
/// oriented manifold with borders.
bool mend_in_place(const surface::TriMesh& input, const RepairParams& params, Repaired& r, surface::TriMesh& cleaned,
                   const Progress& progress) {
  const auto start = Clock::now();
  surface::TriMesh mesh = input;
  double flattest = 8 * float32_step_mm(mesh);
  for (int round = 0; round < rounds; ++round, flattest *= 4) {
    SoupCounts counts;
    clean_soup(mesh, params.merge_mm, counts, progress.part(0, 0.2));
    add(r.soup, counts);
    if (round == 0) cleaned = mesh;
    if (mesh.triangles.empty()) return false;
    const double left_s = params.time_limit_s - std::chrono::duration<double>(Clock::now() - start).count();
    Mended m = mend(mesh, flattest, std::max(0.1, left_s), progress.part(0.2, 0.9));
    m.holes += r.mended.holes;
    m.degenerate += r.mended.degenerate;
    if (round > 0) m.self_intersections = r.mended.self_intersections;
    m.united += r.mended.united;
    r.mended = std::move(m);
    if (!r.mended.fault.empty()) return false;
    mesh = r.mended.mesh;
    snap_to_float32(mesh);
    if (check_validity(mesh, progress.part(0.9, 1)).valid()) {
      // A surface that crosses itself widely is cut into pieces that differ from the space that it encloses.
      if (r.mended.self_intersections > 0 && changed_ratio(cleaned, mesh) > max_changed_ratio) {
        r.mended.fault = "it passes through itself";
        return false;
      }
      r.mesh = std::move(mesh);
      return true;
    }
  }
  r.mended.fault = "it crosses itself still";
  return false;
}

Outcome<surface::TriMesh, RepairResult> repair_now(const surface::TriMesh& input, const RepairParams& params,
                                                   const Progress& progress) {
  surface::check_mesh(input);
  if (input.triangles.empty()) throw Error(ExitCode::bad_input, "", "repair", "the mesh has no triangles");
  Repaired r;
  r.mesh = input;
  r.mesh.normals.clear();
  centre_origin(r.mesh);
  snap_to_float32(r.mesh);
  surface::drop_unused_points(r.mesh);
  const surface::TriMesh before = r.mesh;
  const char* method = "none";
  Warnings warnings;
  if (!r.mesh.proven_valid() && !check_validity(r.mesh, progress.part(0, 0.1)).valid()) {
    surface::TriMesh cleaned;
    method = "mended";
    if (!mend_in_place(before, params, r, cleaned, progress.part(0.1, 0.5))) {
      if (params.recontour_voxels_count == 0 || cleaned.triangles.empty())
        throw r.mended.over_limit
            ? Error(ExitCode::internal, "", "repair", r.mended.fault)
            : refusal("repair", cleaned.triangles.empty() ? "the triangles enclose nothing" : r.mended.fault,
                      {"set `recontour_voxels_count` for a new surface through voxels, or lower `min_component_mm3`"});
      method = "recontoured";
      r.mesh = with_field("repair: last resort", [&] {
        return recontour(cleaned, static_cast<int>(params.recontour_voxels_count), r.voxel_mm, progress.part(0.5, 0.9));
      });
      warnings.push_back({"repaired_by_voxels",
                          "not repaired in place ({fault}): a new surface through voxels; see to_input_max_mm and "
                          "from_input_max_mm",
                          {{"fault", r.mended.fault}}});
    }
  }
  const int dropped =
      params.min_component_mm3 > 0 ? surface::keep_large_components(r.mesh, params.min_component_mm3) : 0;
  with_field("repair", [&] { require_valid(r.mesh, progress.part(0.9, 0.95)); });

  RepairResult result;
  result.method = method;
  result.triangles_count = r.mesh.triangles.size();
  result.points_merged_count = r.soup.merged;
  result.triangles_dropped_count = r.soup.sideless;
  result.duplicates_dropped_count = r.soup.duplicates;
  result.fins_dropped_count = r.soup.fins;
  result.sheets_dropped_count = r.soup.sheets;
  result.flipped_count = r.soup.flipped;
  result.points_split_count = r.soup.split;
  result.holes_filled_count = r.mended.holes;
  result.degenerate_removed_count = r.mended.degenerate;
  result.self_intersections_found_count = r.mended.self_intersections;
  result.united_count = r.mended.united;
  result.components_dropped_count = static_cast<std::size_t>(dropped);
  result.voxel_mm = r.voxel_mm;
  result.volume_ml = surface::volume_mm3(r.mesh) / 1000;
  result.to_input_max_mm = reach_mm(r.mesh, surface::PointToMesh(before), progress);
  result.from_input_max_mm = reach_mm(before, surface::PointToMesh(r.mesh), progress);
  progress.report(1);
  return {std::move(r.mesh), std::move(result), std::move(warnings)};
}

}  // namespace

Outcome<surface::TriMesh, RepairResult> repair(const surface::TriMesh& input, const RepairParams& params,
                                               const Progress& progress) {
  return within_time(params.total_limit_s, progress,
                     [&](const TimeLimit& limit) { return repair_now(input, params, limit.progress()); });
}

}  // namespace trephine::meshing
