// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/measure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "meshing/contour.h"
#include "meshing/validity.h"
#include "metrics/overlap.h"
#include "metrics/quality.h"
#include "surface/inside.h"

namespace trephine::metrics {
namespace {

void set_deviation(MeasureResult& r, const Deviation& d, double reference_volume) {
  r.deviation = d;
  r.reference_volume_mm3 = reference_volume;
  if (reference_volume != 0) r.volume_difference_ratio = (r.volume_mm3 - reference_volume) / reference_volume;
}

// The surface halfway between the voxels of the mask and the others.
surface::TriMesh surface_of(const grid::Mask& mask) {
  grid::Box box{mask.size, {0, 0, 0}};
  for (int k = 0; k < mask.size[2]; ++k)
    for (int j = 0; j < mask.size[1]; ++j)
      for (int i = 0; i < mask.size[0]; ++i)
        if (mask.at(i, j, k)) {
          const int at[3] = {i, j, k};
          for (int a = 0; a < 3; ++a) {
            box.begin[a] = std::min(box.begin[a], at[a]);
            box.end[a] = std::max(box.end[a], at[a] + 1);
          }
        }
  if (box.empty()) throw Error(ExitCode::bad_input, "", "labels", "no voxel has the label");
  const grid::Mask part = grid::crop(mask, grid::grown(box, 1, mask));
  grid::Field field(static_cast<const grid::Lattice&>(part));
  for (std::size_t i = 0; i < part.voxels.size(); ++i) field.voxels[i] = part.voxels[i] ? 0.5f : -0.5f;
  meshing::ContourParams params;
  params.min_component_mm3 = 0;
  params.keep_cavities = true;
  return with_field("labels", [&] { return meshing::contour(field, params).value; });
}

// One a mm^2 of a small surface, but no fewer than p99 needs: 100 of them lie beyond it.
int samples_on(double area_mm2, const MeasureParams& params) {
  constexpr double least = 10000;
  return static_cast<int>(std::min<double>(params.sample_count, std::max(least, area_mm2)));
}

MeasureResult figures_of_mesh(const MeshMeasures& m) {
  MeasureResult r;
  r.triangles_count = m.topology.triangles;
  r.points_count = m.topology.points;
  r.components_count = m.topology.components;
  r.genus_count = m.topology.genus;
  r.closed = m.topology.closed();
  r.manifold = m.topology.manifold();
  r.area_mm2 = m.area_mm2;
  r.volume_mm3 = m.volume_mm3;
  r.edge_min_mm = m.edge_length_mm.min;
  r.edge_median_mm = m.edge_length_mm.median;
  r.edge_max_mm = m.edge_length_mm.max;
  r.aspect_median_ratio = m.aspect_ratio.median;
  r.aspect_p99_ratio = m.aspect_ratio.p99;
  r.aspect_max_ratio = m.aspect_ratio.max;
  return r;
}

FaultsOfAKind faults_of(std::size_t count, const std::vector<Vec3>& places) {
  FaultsOfAKind out{count, {}};
  for (const Vec3 p : places)
    for (int a = 0; a < 3; ++a) out.places_mm.push_back(std::nearbyint(p[a] * 1e4) / 1e4 + 0.0);
  return out;
}

ValidityFigures figures_of_validity(const meshing::Validity& v) {
  return {v.oriented(),
          v.valid(),
          faults_of(v.topology.boundary_edges, v.places.open_edges),
          faults_of(v.topology.nonmanifold_edges, v.places.nonmanifold_edges),
          faults_of(v.topology.nonmanifold_points, v.places.nonmanifold_points),
          faults_of(v.topology.misoriented_edges, v.places.misoriented_edges),
          faults_of(v.topology.duplicate_triangles, v.places.duplicate_triangles),
          faults_of(v.self_intersections, v.places.self_intersections),
          faults_of(v.degenerate, v.places.degenerate),
          faults_of(v.slivers, v.places.slivers)};
}

}  // namespace

Outcome<std::monostate, MeasureResult> measure_surface(const surface::TriMesh& mesh, const MeasureReference& reference,
                                                       const MeasureParams& params, const Progress& progress) {
  surface::check_mesh(mesh);
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "surface", "has no triangles");
  Outcome<std::monostate, MeasureResult> out;
  MeasureResult& r = out.result;
  const MeshMeasures m = measure_mesh(mesh);
  progress.report(0.1);
  r = figures_of_mesh(m);
  DeviationParams samples;
  const auto* against = std::get_if<MeshReference>(&reference);
  samples.sample_count = samples_on(std::max(m.area_mm2, against ? surface::area_mm2(*against->mesh) : 0), params);
  const Progress rest = progress.part(0.4, 1);
  meshing::Validity validity;
  Deviation deviation;
  parallel_do({[&] {
                 if (against) deviation = measure_deviation(mesh, *against->mesh, samples, rest);
               },
               [&] {
                 if (params.validity) validity = meshing::check_validity(mesh, progress.part(0.1, 0.4));
               }});
  if (params.validity) {
    r.validity = figures_of_validity(validity);
    if (!validity.valid())
      out.warnings.push_back({"not_valid", "the surface is not valid: {faults}", {{"faults", validity.text()}}});
  }

  if (against) {
    r.reference = ReferenceKind::mesh;
    set_deviation(r, deviation, surface::volume_mm3(*against->mesh));
  } else if (const auto* l = std::get_if<LabelReference>(&reference)) {
    r.reference = ReferenceKind::labels;
    const grid::Mask label = select_label(*l->labels, l->label);
    const surface::TriMesh surface = surface_of(label);
    rest.report(0.2);
    set_deviation(r, measure_deviation(mesh, surface, samples, rest.part(0.2, 0.8)), volume_mm3(label));
    if (m.topology.closed())
      r.dice_ratio = dice(surface::voxelize_inside(mesh, label, rest.part(0.8, 1)), label);
    else
      out.warnings.push_back({"no_dice", "no Dice: the surface is not closed", {}});
  } else if (const auto* t = std::get_if<TruthReference>(&reference)) {
    r.reference = ReferenceKind::truth;
    set_deviation(r, measure_deviation_to_truth(mesh, t->distance, *t->mesh, samples, t->within, rest),
                  surface::volume_mm3(*t->mesh));
  }
  if (!m.topology.closed() && !std::holds_alternative<std::monostate>(reference))
    out.warnings.push_back({"not_closed", "the surface is not closed: bias and volume mean little", {}});
  progress.report(1);
  return out;
}

}  // namespace trephine::metrics
