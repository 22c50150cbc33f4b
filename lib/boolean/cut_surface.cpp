// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/cut_surface.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "base/text.h"
#include "boolean/clean_cut.h"
#include "boolean/corefine.h"
#include "boolean/cutter_shape.h"
#include "boolean/cutter_use.h"
#include "boolean/overlap.h"
#include "boolean/rim.h"
#include "meshing/normals.h"
#include "meshing/validity.h"
#include "surface/point_to_mesh.h"

namespace trephine::boolean {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void refuse(const std::string& what) {
  throw refusal("", what, {"move the cutter a little by `position_mm`, or take another `cutter_deviation_mm`"});
}

/// How the cutter is placed in one try.
struct Placing {
  double turn_ratio = 0;
  Vec3 shift_mm;
  double slimmer_mm = 0;
  double moved_mm() const { return norm(shift_mm) + slimmer_mm; }
};

double size_mm(const Cutter& c) { return std::cbrt(volume_mm3(c)); }

/// First the cutter as it is; then a little slimmer and longer, so that a hole drilled twice stays as it is and no film
/// is left at an end; then with its facets turned, which moves nothing; then moved, ever further, in directions that
/// lie in none of its own planes.
std::vector<Placing> placings(const Cutter& c) {
  const double scale = std::min(1.0, size_mm(c) / 10);
  std::vector<Placing> all{{}};
  if (c.kind != Cutter::Kind::mesh) {
    for (const double slimmer : {0.001, 0.003}) all.push_back({0, {}, slimmer * scale});
    for (const double turn : {0.5, 0.25, 0.75, 0.37, 0.62}) all.push_back({turn, {}, 0});
  }
  const Mat3 frame = frame_of(c);
  const Vec3 directions[] = {{0.31, 0.23, 0.92}, {-0.27, 0.35, -0.9}, {0.83, -0.41, 0.37}, {-0.71, -0.6, -0.36}};
  int n = 0;
  for (const double length : {0.001, 0.003, 0.01, 0.02, 0.05})
    for (const Vec3 d : directions)
      all.push_back({std::fmod(0.17 * ++n, 1.0), frame * normalized(d) * (length * scale), 0});
  return all;
}

surface::TriMesh solid_of(Cutter c, double deviation_mm, const Placing& p) {
  if (p.slimmer_mm > 0) {
    const auto less = [&](double& r) { r = std::max(r - p.slimmer_mm, 0.9 * r); };
    less(c.radius_mm);
    less(c.end_radius_mm);
    for (double& r : c.radii_mm) less(r);
    c.above_mm += p.slimmer_mm;
    c.depth_mm += p.slimmer_mm;
  }
  return mesh_of(c, deviation_mm, p.turn_ratio, p.shift_mm);
}

/// Removes pieces, oriented outwards and smaller than the volume, that the cut made or touched, with what lies in them.
struct Dropped {
  int count = 0;
  double mm3 = 0;
};

surface::TriMesh part_of(const surface::TriMesh& m, const std::vector<int>& piece_of, int piece) {
  surface::TriMesh out;
  out.origin_mm = m.origin_mm;
  out.points_mm = m.points_mm;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (piece_of[t] == piece) out.triangles.push_back(m.triangles[t]);
  surface::drop_unused_points(out);
  return out;
}

Dropped drop_loose(Difference& d, double below_mm3) {
  std::vector<int> piece_of;
  const int pieces = surface::label_components(d.mesh, piece_of);
  if (pieces < 2) return {};
  std::vector<char> cut(pieces), goes(pieces);
  std::vector<double> volume(pieces);
  for (std::size_t t = 0; t < d.mesh.triangles.size(); ++t) {
    const auto& v = d.mesh.triangles[t];
    cut[piece_of[t]] |= d.old_triangle[t] == Difference::none;
    volume[piece_of[t]] += dot(d.mesh.points_mm[v[0]], cross(d.mesh.points_mm[v[1]], d.mesh.points_mm[v[2]])) / 6;
  }
  const auto largest = std::max_element(volume.begin(), volume.end()) - volume.begin();
  Dropped result;
  for (int p = 0; p < pieces; ++p) {
    if (p == largest || !cut[p] || !(volume[p] >= 0 && volume[p] < below_mm3)) continue;
    goes[p] = 1;
    ++result.count;
    result.mm3 += volume[p];
    const surface::TriMesh shell = part_of(d.mesh, piece_of, p);
    const surface::PointToMesh inside(shell);
    for (int q = 0; q < pieces; ++q) {
      if (q == p || volume[q] >= 0 || goes[q]) continue;
      const auto first = std::size_t(std::find(piece_of.begin(), piece_of.end(), q) - piece_of.begin());
      if (inside.signed_distance_mm(d.mesh.world_mm(d.mesh.triangles[first][0])) >= 0) continue;
      goes[q] = 1;
      result.mm3 += volume[q];
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < piece_of.size(); ++t)
    if (!goes[piece_of[t]]) {
      d.mesh.triangles[kept] = d.mesh.triangles[t];
      d.old_triangle[kept++] = d.old_triangle[t];
    }
  d.mesh.triangles.resize(kept);
  d.old_triangle.resize(kept);
  surface::drop_unused_points(d.mesh);
  return result;
}

/// The validity of a cut through a valid surface: triangles that existed before are known not to intersect each other.
meshing::Validity validity_of(const Difference& d, const Progress& progress) {
  meshing::Validity v;
  const surface::Incidence incidence(d.mesh);
  v.topology = surface::topology_of(d.mesh, incidence);
  if (!v.topology.closed() || !v.topology.manifold()) surface::locate_topology_faults(d.mesh, incidence, v.places);
  v.volume_mm3 = surface::volume_mm3(d.mesh);
  const auto degenerate = meshing::degenerate_triangles(d.mesh);
  v.degenerate = degenerate.size();
  if (!degenerate.empty()) v.places.degenerate = {d.mesh.world_mm(d.mesh.triangles[degenerate.front()][0])};
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t t = 0; t < d.old_triangle.size(); ++t)
    if (d.old_triangle[t] == Difference::none) fresh.push_back(t);
  if (fresh.empty()) return v;
  const auto pairs = meshing::self_intersections(d.mesh, incidence, progress, fresh);
  v.self_intersections = pairs.size();
  if (!pairs.empty())
    v.places.self_intersections = {surface::place_of_intersection_mm(d.mesh, pairs.front()[0], pairs.front()[1])};
  return v;
}

/// A surface that is cut again and again.
class Cutting {
 public:
  Cutting(surface::TriMesh surface, const CutSurfaceParams& params)
      : mesh(std::move(surface)), params_(params), step_(meshing::float32_step_mm(mesh)), start_(Clock::now()) {}

  surface::TriMesh mesh;
  double moved_mm = 0;
  int tries = 0;
  bool changed = false;
  Dropped dropped;

  struct Removed {
    double mm3 = 0, expected_mm3 = 0;
  };
  Removed cut(const Cutter& cutter, const Progress& progress);

 private:
  double expected(const Cutter& cutter) const;
  bool attempt(const Cutter& cutter, const Placing& placing, Removed& removed, const Progress& progress);
  bool accept(Difference d, const Placing& placing, Removed& removed, const Progress& progress);
  static bool near_expected(double mm3, const Removed& removed) {
    return std::abs(mm3 - removed.expected_mm3) <= std::max(0.01 * removed.expected_mm3, 0.5);
  }

  const CutSurfaceParams& params_;
  double step_;
  Clock::time_point start_;
  std::string fault_;  ///< of the last attempt
};

/// The expected volume, of facets so fine that they are as good as the cutter itself.
double Cutting::expected(const Cutter& cutter) const {
  const double asked = params_.cutter_deviation_mm;
  return overlap_mm3(mesh, mesh_of(cutter, std::min(asked, std::max(asked / 2, size_mm(cutter) / 10000))),
                     cutter.direction);
}

bool Cutting::attempt(const Cutter& cutter, const Placing& placing, Removed& removed, const Progress& progress) {
  const double left = params_.time_limit_s - std::chrono::duration<double>(Clock::now() - start_).count();
  if (left <= 0)
    throw Error(ExitCode::internal, "", "time_limit_s", to_text(params_.time_limit_s) + " s, the cut takes longer");
  const surface::TriMesh solid = solid_of(cutter, params_.cutter_deviation_mm, placing);
  Difference d = corefine_difference(mesh, solid, left, progress.part(0, 0.6));
  fault_ = d.fault;
  if (!fault_.empty()) return false;
  // Where the two surfaces are the same, slivers may be left.
  if (d.mesh.triangles.empty() || surface::volume_mm3(d.mesh) < 1e-6 * surface::volume_mm3(mesh)) {
    fault_ = "nothing is left of the surface";
    if (near_expected(surface::volume_mm3(mesh), removed)) refuse(fault_);
    return false;
  }
  if (d.mesh.triangles.size() == mesh.triangles.size() && d.old_triangle.back() != Difference::none) {
    removed.mm3 = 0;
    if (near_expected(0, removed)) return true;
    fault_ = "the cut removed nothing, expected are " + to_text(removed.expected_mm3) + " mm3";
    return false;
  }
  const double shortest = std::max(8 * step_, std::min(0.005, size_mm(cutter) / 1000));
  clean_cut(d, step_, shortest, std::max(4 * step_, shortest / 4));
  const double width = std::min(params_.rim_mm, size_mm(cutter) / 20);
  if (width > 10 * shortest) {
    Difference divided = d;
    divide_rim(divided, step_, width);
    if (accept(std::move(divided), placing, removed, progress.part(0.6, 0.8))) return true;
  }
  return accept(std::move(d), placing, removed, progress.part(0.8, 1));
}

bool Cutting::accept(Difference d, const Placing& placing, Removed& removed, const Progress& progress) {
  removed.mm3 = surface::volume_mm3(mesh) - surface::volume_mm3(d.mesh);
  if (!near_expected(removed.mm3, removed)) {
    fault_ = "the cut removed " + to_text(removed.mm3) + " mm3, expected are " + to_text(removed.expected_mm3) + " mm3";
    return false;
  }
  const Dropped loose = drop_loose(d, params_.min_component_mm3);
  const meshing::Validity v = validity_of(d, progress);
  if (!v.valid()) {
    fault_ = "the cut surface has " + v.text();
    return false;
  }
  mesh = std::move(d.mesh);
  changed = true;
  moved_mm = std::max(moved_mm, placing.moved_mm());
  dropped.count += loose.count;
  dropped.mm3 += loose.mm3;
  return true;
}

Cutting::Removed Cutting::cut(const Cutter& cutter, const Progress& progress) {
  Removed removed;
  removed.expected_mm3 = std::max(0.0, expected(cutter));
  // The solids are apart or touch: a smaller volume is rounding.
  if (removed.expected_mm3 < 1e-6 * std::min(1.0, volume_mm3(cutter))) return {};
  for (const Placing& p : placings(cutter)) {
    ++tries;
    if (attempt(cutter, p, removed, progress)) return removed;
  }
  // A cutter that hardly touches the surface may leave it unchanged.
  if (removed.expected_mm3 <= 0.5) return {0, removed.expected_mm3};
  const surface::Bounds b = bounds_of(cutter);
  const Vec3 at = (b.min_mm + b.max_mm) / 2;
  const auto rounded = [](double v) { return to_text(std::nearbyint(v * 100) / 100 + 0.0); };
  refuse(fault_ + "; the cutter's middle is at " + rounded(at.x) + ", " + rounded(at.y) + ", " + rounded(at.z) + " mm");
}

/// On float32's raster and valid.
surface::TriMesh checked(const surface::TriMesh& surface, const Progress& progress) {
  surface::check_mesh(surface);
  surface::TriMesh mesh = surface;
  mesh.normals.clear();
  meshing::snap_to_float32(mesh);
  with_field("surface", [&] { meshing::require_valid(mesh, progress); });
  surface::drop_unused_points(mesh);
  return mesh;
}

}  // namespace

Outcome<surface::TriMesh, CutSurfaceResult> cut_surface(const surface::TriMesh& surface,
                                                        const std::vector<Cutter>& given,
                                                        const CutSurfaceParams& params, const Progress& progress) {
  std::vector<Cutter> cutters;
  for (const Cutter& c : given) cutters.push_back(widened(c, params.widen_mm));
  const auto name_of = [&](std::size_t i) {
    return cutters[i].name.empty() ? "cutter_" + std::to_string(i + 1) : cutters[i].name;
  };
  for (std::size_t i = 0; i < cutters.size(); ++i)
    with_field(name_of(i), [&] { check_cutter(cutters[i], ExitCode::bad_input); });
  Cutting cutting(checked(surface, progress.part(0, 0.1)), params);

  CutSurfaceResult result;
  Warnings warnings;
  for (std::size_t i = 0; i < cutters.size(); ++i) {
    const double n = double(cutters.size());
    const auto removed = with_field(
        name_of(i), [&] { return cutting.cut(cutters[i], progress.part(0.1 + 0.9 * i / n, 0.1 + 0.9 * (i + 1) / n)); });
    result.cutters.emplace_back(name_of(i), RemovedBySurface{removed.mm3, removed.expected_mm3});
    if (removed.mm3 == 0) warnings.push_back({"removes_nothing", "{cutter} removes nothing", {{"cutter", name_of(i)}}});
    result.removed_mm3 += removed.mm3;
  }
  surface::TriMesh out = cutting.changed ? std::move(cutting.mesh) : surface;
  if (!cutting.changed) meshing::snap_to_float32(out);
  if (cutting.changed && !surface.normals.empty()) meshing::compute_normals(out, {});
  result.cutters_count = cutters.size();
  result.dropped_count = cutting.dropped.count;
  result.dropped_mm3 = cutting.dropped.mm3;
  result.moved_mm = cutting.moved_mm;
  result.tries_count = cutting.tries;
  result.triangles_count = out.triangles.size();
  progress.report(1);
  return {std::move(out), std::move(result), std::move(warnings)};
}

}  // namespace trephine::boolean
