// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/decimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "meshing/edge_collapse.h"
#include "meshing/exact.h"
#include "meshing/float32_raster.h"
#include "meshing/measure_deviation.h"
#include "meshing/validity.h"
#include "surface/incidence.h"

namespace trephine::meshing {
namespace {

/// After this many rounds of undoing, collapses elsewhere make up for the undone ones only when nothing is left to
/// undo. That is repeated this often, and more often where this share of the target is missing.
constexpr int rounds_that_collapse = 12, times_made_up = 3, times_share_made_up = 12;
constexpr double missing_share = 0.01;
/// Where more than this share of the triangles was undone, as on a surface of noise, nothing is collapsed any more:
/// most of it would be undone again, and the time would grow without end. Other surfaces lose a few percent.
constexpr double max_undone_share = 0.1;
/// Share of the bound that samples may use; the rest is for what lies between them.
constexpr double sampled_share = 0.9;

std::size_t target_count(const surface::TriMesh& mesh, const DecimateParams& p) {
  const auto share = static_cast<std::int64_t>(std::ceil(p.keep_ratio * static_cast<double>(mesh.triangles.size())));
  const std::int64_t asked = std::max(p.target_triangles_count, share);
  // Where no count is asked for, the bound alone decides.
  return asked > 0 ? static_cast<std::size_t>(std::max<std::int64_t>(asked, 4)) : p.max_deviation_mm > 0 ? 4 : 0;
}

/// Finds what is invalid in a mesh that collapses, looking only at what changed since the last time.
class Inspection {
 public:
  /// The collapsing mesh's triangles that are degenerate or intersect; the mesh is given as a plain one as well.
  std::vector<std::uint32_t> faults(const CollapseMesh& mesh, const surface::TriMesh& plain,
                                    const std::vector<std::uint32_t>& triangle_of, const Progress& progress) {
    std::vector<std::uint32_t> changed, found;
    const bool first = seen_.empty();
    seen_.resize(mesh.triangles(), unseen);
    std::vector<std::uint32_t> seen(mesh.triangles(), unseen);  // what is dead now is new when it comes back
    for (std::uint32_t t = 0; t < triangle_of.size(); ++t) {
      const auto& v = plain.triangles[t];
      const std::uint32_t now = mesh.last_change(triangle_of[t]);
      seen[triangle_of[t]] = now;
      if (seen_[triangle_of[t]] == now) continue;
      changed.push_back(t);
      if (on_a_line(plain.points_mm[v[0]], plain.points_mm[v[1]], plain.points_mm[v[2]])) found.push_back(t);
    }
    seen_.swap(seen);
    if (first) changed.clear();  // stands for all of them
    if (first || !changed.empty())
      for (const auto& pair : self_intersections(plain, progress, changed))
        found.insert(found.end(), pair.begin(), pair.end());
    for (auto& t : found) {
      t = triangle_of[t];
      seen_[t] = unseen;
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  static constexpr std::uint32_t unseen = CollapseMesh::none - 1;
  std::vector<std::uint32_t> seen_;  ///< what had last changed the triangle when it was looked at
};

/// Finds pieces that collapses turned inside out: none of their triangles need meet, so nothing else finds them.
class Sides {
 public:
  explicit Sides(const surface::TriMesh& input) : input_(input) {}

  /// The collapsing mesh's triangles of such pieces.
  std::vector<std::uint32_t> turned(const surface::TriMesh& plain, const std::vector<std::uint32_t>& triangle_of) {
    std::vector<int> piece_of;
    const int pieces = surface::label_fan_components(plain, piece_of);  // collapses keep one fan a point
    const std::vector<double> volume = surface::piece_volumes(plain, piece_of, pieces);
    if (pieces == 1 && volume[0] > 0) return {};  // the input, which is valid, looks outwards
    if (input_piece_of_.empty()) {
      const int n = surface::label_components(input_, input_piece_of_);
      input_volume_ = surface::piece_volumes(input_, input_piece_of_, n);
    }
    std::vector<std::uint32_t> found;
    for (std::uint32_t t = 0; t < piece_of.size(); ++t)
      if (!(volume[piece_of[t]] * input_volume_[input_piece_of_[triangle_of[t]]] > 0)) found.push_back(triangle_of[t]);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  const surface::TriMesh& input_;
  std::vector<int> input_piece_of_;  ///< once there is more than one
  std::vector<double> input_volume_;
};

/// The mesh as the collapses need it: without normals, rounded to float32, and without unused points.
bool fit(const surface::TriMesh& mesh) {
  if (!mesh.normals.empty()) return false;
  std::vector<bool> used(mesh.points_mm.size(), false);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  return std::find(used.begin(), used.end(), false) == used.end() && on_float32_raster(mesh);
}

struct Collapsed {
  surface::TriMesh mesh;
  DeviationFigures deviation;
  std::size_t undone = 0, undone_for_validity = 0;
  bool limited = false;
};

Collapsed collapse_all(const surface::TriMesh& input, std::size_t target, double bound_mm, const Progress& progress) {
  Collapsed o;
  const double limit_mm = sampled_share * bound_mm;
  const double step = float32_step_mm(input);
  EdgeCollapse collapse(input, limit_mm, step);
  std::optional<DeviationMeter> meter;
  Inspection inspection;
  Sides sides(input);
  std::vector<std::uint32_t> triangle_of;
  int made_up = 0;
  bool clean = false;
  for (int round = 0;; ++round) {
    const bool in_vain = double(o.undone) > max_undone_share * double(input.triangles.size());
    if ((round < rounds_that_collapse && !in_vain) || clean)
      o.limited |= collapse.run(target, round == 0 ? progress.part(0.1, 0.7) : progress.part(0.9, 0.9));
    if (clean && collapse.mesh().live_triangles() == o.mesh.triangles.size()) break;
    clean = false;
    std::vector<std::uint32_t> faults;
    parallel_do({[&] {
                   o.mesh = collapse.mesh().to_mesh(input.origin_mm, &triangle_of);
                   faults = inspection.faults(collapse.mesh(), o.mesh, triangle_of, progress.part(0.7, 0.75));
                 },
                 [&] {
                   if (!meter) meter.emplace(collapse.input(), limit_mm, bound_mm);
                 }});
    if (faults.empty()) faults = sides.turned(o.mesh, triangle_of);
    if (!faults.empty()) {
      const std::size_t n = collapse.undo(faults);
      if (n == 0) throw refusal("decimate", "intersections that cannot be undone", remedies::other_triangles);
      o.undone += n;
      o.undone_for_validity += n;
      continue;
    }
    faults = meter->measure(o.mesh, triangle_of, collapse.carried(), progress.part(0.75, 0.9));
    if (faults.empty()) {
      const double most = (1 + missing_share) * static_cast<double>(target);
      const int times = static_cast<double>(o.mesh.triangles.size()) <= most ? times_share_made_up : times_made_up;
      if (o.mesh.triangles.size() <= target || in_vain || made_up++ >= times) break;
      clean = true;
      continue;
    }
    const std::size_t n = collapse.undo(faults);
    if (n == 0) throw refusal("decimate", "max_deviation_mm cannot be kept", {"raise `max_deviation_mm`"});
    o.undone += n;
    o.limited = true;
  }
  o.deviation = meter->figures();
  return o;
}

}  // namespace

std::string DecimateParams::fault() const {
  return max_deviation_mm > 0 && input_within_mm >= max_deviation_mm
             ? "input_within_mm: must be less than max_deviation_mm"
             : "";
}

Outcome<surface::TriMesh, DecimateResult> decimate(const surface::TriMesh& mesh, const DecimateParams& params,
                                                   const Progress& progress) {
  surface::check_mesh(mesh);
  if (!params.fault().empty())
    throw Error(ExitCode::usage, "", "input_within_mm", "must be less than max_deviation_mm");
  surface::TriMesh copy;
  if (!fit(mesh)) {
    copy = mesh;
    copy.normals.clear();
    surface::drop_unused_points(copy);
    snap_to_float32(copy);
  }
  const surface::TriMesh& input = copy.triangles.empty() ? mesh : copy;
  with_field("decimate: input", [&] { require_valid(input, progress.part(0, 0.1)); });
  const std::size_t target = target_count(input, params);
  const double volume = surface::volume_mm3(input);

  Collapsed o;
  const char* stopped_by = "count";
  const bool collapsed = target != 0 && input.triangles.size() > target;
  if (collapsed) {
    const double rest_mm = params.max_deviation_mm > 0 ? params.max_deviation_mm - params.input_within_mm : 0;
    o = collapse_all(input, target, rest_mm, progress);
    if (o.mesh.triangles.size() > target) stopped_by = o.limited ? "deviation" : "validity";
  } else {
    o.mesh = input;
  }
  with_field("decimate", [&] { require_valid(o.mesh, progress.part(0.9, 1)); });

  DecimateResult result;
  result.triangles_before_count = input.triangles.size();
  result.triangles_count = o.mesh.triangles.size();
  result.reduction_percent = 100 * (1 - double(o.mesh.triangles.size()) / double(input.triangles.size()));
  result.stopped_by = stopped_by;
  result.deviation_max_mm = o.deviation.max_mm;
  result.deviation_p99_mm = o.deviation.p99_mm;
  result.deviation_rms_mm = o.deviation.rms_mm;
  if (collapsed && params.max_deviation_mm > 0) result.deviation_proven_mm = params.max_deviation_mm;
  result.volume_change_percent = 100 * (surface::volume_mm3(o.mesh) / volume - 1);
  result.collapses_undone_count = o.undone;
  result.collapses_undone_for_validity_count = o.undone_for_validity;
  progress.report(1);
  return {std::move(o.mesh), std::move(result), {}};
}

}  // namespace trephine::meshing
