// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/preview.h"

#include <algorithm>
#include <cmath>
#include <list>

#include "base/error.h"
#include "base/joined.h"
#include "base/refusal.h"
#include "base/text.h"
#include "dicom/import.h"
#include "meshing/contour.h"
#include "picture/render.h"
#include "picture/slice.h"
#include "publish/case_pictures.h"
#include "publish/face_clearance.h"
#include "publish/scan_checks.h"
#include "publish/series_hashes.h"
#include "surface/bounds.h"
#include "voxel/shape_field.h"

namespace trephine::publish {
namespace {

constexpr double isovalue_hu = 226.5;
constexpr std::size_t max_shapes = 12;

/// One thing to be drawn: its outline is that of `field` or `mesh`, its surface that of `coarse` or `mesh`.
struct Shape {
  std::string name;
  picture::Rgb colour_rgb{0.9, 0.3, 0.2};
  std::list<grid::Field> own_field;
  const grid::Field* field = nullptr;
  std::list<surface::TriMesh> own_mesh;
  const surface::TriMesh* mesh = nullptr;
};

picture::Rgb colour_of(std::size_t number) {
  constexpr picture::Rgb all[] = {{0.95, 0.45, 0.1}, {0.2, 0.75, 0.3},  {0.25, 0.55, 0.95},
                                  {0.95, 0.8, 0.15}, {0.7, 0.35, 0.85}, {0.1, 0.75, 0.75}};
  return all[number % 6];
}

/// Every n-th voxel along each axis, so that cells are of about this size.
template <class T>
grid::Grid<T> thinned(const grid::Grid<T>& grid, double cell_mm) {
  grid::Lattice l = grid;
  int step[3];
  for (int a = 0; a < 3; ++a) {
    step[a] = cell_mm > 0 ? std::max(1, int(std::lround(cell_mm / grid.spacing_mm[a]))) : 1;
    step[a] = std::min(step[a], std::max(1, (grid.size[std::size_t(a)] - 1) / 4));
    l.size[std::size_t(a)] = (grid.size[std::size_t(a)] - 1) / step[a] + 1;
    l.spacing_mm[a] = grid.spacing_mm[a] * step[a];
  }
  grid::Grid<T> out(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) out.at(i, j, k) = grid.at(i * step[0], j * step[1], k * step[2]);
  return out;
}

/// The surface on coarse cells; nothing where the shape falls through them.
void add_surface(Shape& shape, double cell_mm, const Progress& progress) {
  meshing::ContourParams params;
  params.min_component_mm3 = 0;
  try {
    shape.own_mesh.push_back(meshing::contour(thinned(*shape.field, cell_mm), params, progress).value);
    shape.mesh = &shape.own_mesh.back();
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
  }
}

std::list<Shape> shapes_of(const std::string& name, const stages::StageData& data, double cell_mm,
                           const Progress& progress) {
  std::list<Shape> shapes;
  const auto add = [&](const std::string& called) -> Shape& {
    if (shapes.size() == max_shapes)
      throw Error(ExitCode::usage, "", "stage", "has more than " + std::to_string(max_shapes) + " shapes to be drawn");
    shapes.emplace_back();
    shapes.back().name = called;
    shapes.back().colour_rgb = colour_of(shapes.size() - 1);
    return shapes.back();
  };
  const auto add_field = [&](const std::string& called, grid::Field field) {
    Shape& shape = add(called);
    shape.own_field.push_back(std::move(field));
    shape.field = &shape.own_field.back();
    add_surface(shape, cell_mm, progress);
  };
  const auto add_mesh = [&](const std::string& called, surface::TriMesh mesh) {
    Shape& shape = add(called);
    shape.own_mesh.push_back(std::move(mesh));
    shape.mesh = &shape.own_mesh.back();
  };
  if (const auto* volume = std::get_if<std::shared_ptr<const grid::HuVolume>>(&data)) {
    Shape& shape = add(name + " at " + to_text(isovalue_hu) + " HU");
    std::visit(
        [&](const auto& g) {
          auto coarse = thinned(g, cell_mm);
          grid::Field field(static_cast<const grid::Lattice&>(coarse));
          for (std::size_t i = 0; i < field.voxels.size(); ++i) field.voxels[i] = float(coarse.voxels[i] - isovalue_hu);
          shape.own_field.push_back(std::move(field));
        },
        **volume);
    shape.field = &shape.own_field.back();
    add_surface(shape, 0, progress);
  } else if (const auto* field = std::get_if<std::shared_ptr<const grid::Field>>(&data)) {
    Shape& shape = add(name);
    shape.field = field->get();
    add_surface(shape, cell_mm, progress);
  } else if (const auto* mesh = std::get_if<std::shared_ptr<const surface::TriMesh>>(&data)) {
    add(name).mesh = mesh->get();
  } else if (const auto* haptic = std::get_if<std::shared_ptr<const voxel::HapticVolume>>(&data)) {
    for (const voxel::HapticShape& s : (*haptic)->shapes)
      add_field(s.name, voxel::shape_field(**haptic, s.number, progress));
  } else if (const auto* labels = std::get_if<std::shared_ptr<const grid::LabelFile>>(&data)) {
    std::vector<std::string> names;
    for (const grid::LabelSegment& s : (*labels)->segments) names.push_back(s.name);
    if (names.empty()) names.emplace_back("");
    for (const std::string& label : names) {
      const grid::PickedLabel picked = grid::pick_label(**labels, label);
      if (!picked.voxels) continue;
      grid::Field field(picked.mask);
      std::transform(picked.mask.voxels.begin(), picked.mask.voxels.end(), field.voxels.begin(),
                     [](std::uint8_t v) { return v ? 0.5f : -0.5f; });
      add_field(label.empty() ? name : label, std::move(field));
    }
  } else if (const auto* cutters = std::get_if<std::shared_ptr<const std::vector<boolean::Cutter>>>(&data)) {
    for (const boolean::Cutter& cutter : **cutters) add_mesh(name, boolean::mesh_of(cutter, 0.2));
  } else if (const auto* landmarks = std::get_if<std::shared_ptr<const head::HeadLandmarks>>(&data)) {
    for (const cases::CaseLandmark& l : (*landmarks)->landmarks) {
      if (shapes.size() == max_shapes) break;
      add_mesh(l.name, ball_at(l.position_mm, 0.2));
    }
  } else {
    throw Error(ExitCode::usage, "", "stage", name + ": gives a report, of which there is no picture");
  }
  return shapes;
}

surface::Bounds bounds_of_shapes(const std::list<Shape>& shapes) {
  surface::Bounds all;
  for (const Shape& s : shapes)
    if (s.mesh) surface::include(all, surface::bounds_of(*s.mesh));
  return all;
}

picture::Image slice_of(const grid::HuVolume& volume, picture::SlicePlane plane, Vec3 at,
                        const std::list<Shape>& shapes, const PreviewParams& params) {
  picture::SliceParams slice;
  slice.plane = plane;
  const auto range = picture::slice_range_mm(grid::lattice_of(volume), plane);
  const int axis = picture::axis_of(plane);
  slice.position_mm = std::clamp(at[axis], range[0], range[1]);
  slice.window_center_hu = params.window_center_hu;
  slice.window_width_hu = params.window_width_hu;
  slice.longer_side_px = params.size_px;
  std::vector<picture::OverlayShape> outlines;
  for (const Shape& s : shapes) outlines.push_back({s.field ? nullptr : s.mesh, s.colour_rgb, s.name, s.field});
  return picture::slice_overlay(volume, slice, outlines);
}

/// The nodes that these need, and only they; `wanted` become their numbers in the new graph.
pipeline::Graph needed_part(const pipeline::Graph& graph, std::vector<int>& wanted) {
  std::vector<int> number(graph.nodes.size(), -1);
  std::vector<bool> needed(graph.nodes.size(), false);
  for (const int w : wanted) needed[std::size_t(w)] = true;
  for (std::size_t i = graph.nodes.size(); i-- > 0;)
    if (needed[i])
      for (const auto& [port, source] : graph.nodes[i].sources) needed[std::size_t(source)] = true;
  pipeline::Graph out;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (!needed[i]) continue;
    number[i] = int(out.nodes.size());
    out.nodes.push_back(graph.nodes[i]);
    for (auto& [port, source] : out.nodes.back().sources) source = number[std::size_t(source)];
  }
  for (int& w : wanted) w = number[std::size_t(w)];
  return out;
}

/// A scene computes what it shows; so it shows the anatomy of this stage, too.
void show_anatomy_of(const std::string& stage, config::CaseConfig& config) {
  const std::string name = stage.substr(0, stage.find('.'));
  const config::RecipeAnatomy* anatomy = config.find_anatomy(name);
  if (!anatomy || anatomy->steps.empty() || anatomy->steps.back().type->output != stages::DataKind::mesh) return;
  if (config.find_shown(name)) return;
  config::SceneAnatomy more;
  more.name = name;
  config.scene.push_back(more);
}

int find_stage_node(const pipeline::Graph& graph, const std::string& stage) {
  if (const int found = graph.find(stage); found >= 0) return found;
  std::vector<std::string> known;
  for (const pipeline::Node& node : graph.nodes) known.push_back(node.name);
  const std::string near = nearest_name(stage, known);
  throw Error(ExitCode::usage, "", "--stage",
              printable(stage) + ": the scene needs no such stage" +
                  (near.empty() ? ", but " + joined(known) : ", did you mean " + near + "?"));
}

}  // namespace

Preview draw_preview(const std::string& name, const stages::StageData& data, const grid::HuVolume* volume,
                     const PreviewParams& params, const Progress& progress) {
  if (const auto* own = std::get_if<std::shared_ptr<const grid::HuVolume>>(&data); own && !volume) volume = own->get();
  const std::list<Shape> shapes = shapes_of(name, data, params.cell_mm, progress.part(0, 0.6));
  Preview out;
  std::vector<picture::SurfaceView> views;
  for (const Shape& s : shapes) {
    if (!s.mesh) {
      out.report.warn(s.name + " is too thin for cells of " + to_text(params.cell_mm) +
                      " mm: no surface of it is drawn; a smaller cell_mm shows it");
      continue;
    }
    views.push_back({s.mesh, s.colour_rgb, shapes.size() > 1 && &s == &shapes.front() ? 0.4 : 1.0});
    out.report.add(s.name + ".volume_ml", std::abs(surface::volume_mm3(*s.mesh)) / 1000);
  }
  if (views.empty())
    throw refusal(name, "there is nothing to be seen: it is empty, or too thin",
                  {"set a smaller `cell_mm`, or other values of the stage"});
  const surface::Bounds bounds = bounds_of_shapes(shapes);
  const bool given = params.at_mm != std::array<double, 3>{0, 0, 0};
  const Vec3 at = given ? Vec3{params.at_mm[0], params.at_mm[1], params.at_mm[2]} : (bounds.min_mm + bounds.max_mm) / 2;
  std::vector<picture::Image> cells;
  if (volume)
    for (const picture::SlicePlane plane :
         {picture::SlicePlane::axial, picture::SlicePlane::coronal, picture::SlicePlane::sagittal}) {
      progress.check();
      cells.push_back(slice_of(*volume, plane, at, shapes, params));
    }
  picture::RenderParams render;
  render.width = render.height = params.size_px;
  render.title = name;
  cells.push_back(picture::render_surfaces(views, render, progress.part(0.7, 1)));
  out.png = picture::encode_png(picture::contact_sheet(cells, volume ? 2 : 1));
  return out;
}

Preview preview_stage(const PreviewRequest& request, pipeline::RunObserver& observer) {
  config::ConfigOverrides overrides = request.overrides;
  if (request.params.stage.empty())
    throw Error(ExitCode::usage, "", "--stage", "is needed: which stage's result shall be drawn, such as import");
  if (request.params.cell_mm > 0) {
    const std::string cell = to_text(request.params.cell_mm);
    overrides.set.insert(overrides.set.begin(), "resample.spacing_mm=[" + cell + "," + cell + "," + cell + "]");
  }
  // A head that lies otherwise than said is to be looked at, too; the warning stays.
  overrides.set.insert(overrides.set.begin(), "import.orientation_reason=preview");
  config::CaseConfig config = config::read_case_config(request.config, overrides);
  show_anatomy_of(request.params.stage, config);
  if (config.series.empty())
    throw Error(ExitCode::usage, request.config.string(), "series",
                "the configuration names none, give --series FOLDER");
  const Progress cancelled({}, &cancel_requested());
  const pipeline::Graph whole = SeriesHashes(cancelled).graph_of(config);
  const bool without_face = config.takes_face_away();
  std::vector<int> wanted{find_stage_node(whole, request.params.stage), without_face ? whole.scan : 0};
  require_made_without_face(config, whole, wanted[0]);
  std::vector<std::string> scans;
  for (const auto& [name, node] : whole.scans)
    if (const auto needs = whole.needs_of(wanted[0]); std::count(needs.begin(), needs.end(), node))
      scans.push_back(name);
  const std::vector<std::string> about_patients = require_one_patient(config, scans, cancelled);
  const pipeline::Graph graph = needed_part(whole, wanted);
  const pipeline::StageCache cache(request.cache);
  pipeline::ExecuteOptions options;
  options.cache = &cache;
  options.cancel = &cancel_requested();
  options.allow_external = request.params.allow_external;
  const std::vector<pipeline::NodeResult> results = pipeline::execute(graph, wanted, options, observer);
  require_modalities(config, graph, results);
  const pipeline::NodeResult &drawn = results[std::size_t(wanted[0])], &scan = results[std::size_t(wanted[1])];
  Preview out =
      draw_preview(request.params.stage, drawn.data, std::get<std::shared_ptr<const grid::HuVolume>>(scan.data).get(),
                   request.params, cancelled);
  if (without_face) out.report.warn("whether the face is gone was not checked, as a run does before it publishes");
  for (const std::string& w : about_patients) out.report.warn(w);
  for (const pipeline::NodeResult& r : results)
    for (const std::string& w : r.report().warnings)
      out.report.warn(graph.nodes[std::size_t(&r - results.data())].name + ": " + w);
  return out;
}

}  // namespace trephine::publish
