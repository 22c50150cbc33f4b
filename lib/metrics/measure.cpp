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

void add_deviation(Report& report, const Deviation& d, double volume, double reference_volume) {
  add_deviation(report, d);
  report.add("reference_volume_mm3", reference_volume);
  if (reference_volume != 0) report.add("volume_difference_ratio", (volume - reference_volume) / reference_volume);
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
  Report ignored;
  return with_field("labels", [&] { return meshing::contour(field, params, ignored); });
}

void add_quality(Report& report, const MeshMeasures& m) {
  report.add("triangles_count", m.topology.triangles);
  report.add("points_count", m.topology.points);
  report.add("components_count", m.topology.components);
  report.add("genus_count", std::int64_t{m.topology.genus});
  report.add("closed", m.topology.closed());
  report.add("manifold", m.topology.manifold());
}

void add_validity(Report& report, const meshing::Validity& v) {
  report.add("oriented", v.oriented());
  report.add("valid", v.valid());
  // How many there are, and the positions of the first of them: x, y, z, x, y, z, ...
  const auto add = [&](const std::string& what, std::size_t count, const std::vector<Vec3>& places) {
    report.add(what + "_count", count);
    if (places.empty()) return;
    std::vector<double> flat;
    for (const Vec3 p : places)
      for (int a = 0; a < 3; ++a) flat.push_back(std::nearbyint(p[a] * 1e4) / 1e4 + 0.0);
    report.figures.emplace_back(what + "_places_mm", std::move(flat));
  };
  add("open_edges", v.topology.boundary_edges, v.places.open_edges);
  add("nonmanifold_edges", v.topology.nonmanifold_edges, v.places.nonmanifold_edges);
  add("nonmanifold_points", v.topology.nonmanifold_points, v.places.nonmanifold_points);
  add("misoriented_edges", v.topology.misoriented_edges, v.places.misoriented_edges);
  add("duplicate_triangles", v.topology.duplicate_triangles, v.places.duplicate_triangles);
  add("self_intersections", v.self_intersections, v.places.self_intersections);
  add("degenerate", v.degenerate, v.places.degenerate);
  add("slivers", v.slivers, v.places.slivers);
  if (!v.valid()) report.warn("the surface is not valid: " + v.text());
}

void add_geometry(Report& report, const MeshMeasures& m) {
  report.add("area_mm2", m.area_mm2);
  report.add("volume_mm3", m.volume_mm3);
  report.add("edge_min_mm", m.edge_length_mm.min);
  report.add("edge_median_mm", m.edge_length_mm.median);
  report.add("edge_max_mm", m.edge_length_mm.max);
  report.add("aspect_median_ratio", m.aspect_ratio.median);
  report.add("aspect_p99_ratio", m.aspect_ratio.p99);
  report.add("aspect_max_ratio", m.aspect_ratio.max);
}

}  // namespace

Report measure_surface(const surface::TriMesh& mesh, const MeasureReference& reference, const MeasureParams& params,
                       const Progress& progress) {
  surface::check_mesh(mesh);
  if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "surface", "has no triangles");
  Report report;
  const MeshMeasures m = measure_mesh(mesh);
  progress.report(0.1);
  add_quality(report, m);
  DeviationParams samples;
  samples.sample_count = params.sample_count;
  const Progress rest = progress.part(0.4, 1);
  const auto* against = std::get_if<MeshReference>(&reference);
  meshing::Validity validity;
  Deviation deviation;
  parallel_do({[&] {
                 if (against) deviation = measure_deviation(mesh, *against->mesh, samples, rest);
               },
               [&] {
                 if (params.validity) validity = meshing::check_validity(mesh, progress.part(0.1, 0.4));
               }});
  if (params.validity) add_validity(report, validity);
  add_geometry(report, m);

  if (against) {
    report.add("reference", "mesh");
    add_deviation(report, deviation, m.volume_mm3, surface::volume_mm3(*against->mesh));
  } else if (const auto* l = std::get_if<LabelReference>(&reference)) {
    report.add("reference", "labels");
    const grid::Mask label = select_label(*l->labels, l->label);
    const surface::TriMesh surface = surface_of(label);
    rest.report(0.2);
    add_deviation(report, measure_deviation(mesh, surface, samples, rest.part(0.2, 0.8)), m.volume_mm3,
                  volume_mm3(label));
    if (m.topology.closed())
      report.add("dice_ratio", dice(surface::voxelize_inside(mesh, label, rest.part(0.8, 1)), label));
    else
      report.warn("no Dice: the surface is not closed");
  } else if (const auto* t = std::get_if<TruthReference>(&reference)) {
    report.add("reference", "truth");
    add_deviation(report, measure_deviation_to_truth(mesh, t->distance, *t->mesh, samples, t->within, rest),
                  m.volume_mm3, surface::volume_mm3(*t->mesh));
  } else {
    report.add("reference", "none");
  }
  if (!m.topology.closed() && !std::holds_alternative<std::monostate>(reference))
    report.warn("the surface is not closed: bias and volume mean little");
  progress.report(1);
  return report;
}

}  // namespace trephine::metrics
