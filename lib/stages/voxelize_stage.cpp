// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/voxelize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <tuple>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/bits.h"
#include "mask/surface_field.h"
#include "meshing/contour.h"
#include "stages/cutters_of.h"
#include "surface/bounds.h"
#include "voxel/cut.h"

namespace trephine::stages {
namespace {

// Air around the shapes, in which their surfaces' ramp of occupancy must fit.
constexpr double rim_voxels = 3;

surface::Bounds grown(surface::Bounds b, double by_mm) {
  for (int i = 0; i < 3; ++i) {
    b.min_mm[i] -= by_mm;
    b.max_mm[i] += by_mm;
  }
  return b;
}

void intersect(surface::Bounds& b, const surface::Bounds& with) {
  for (int i = 0; i < 3; ++i) {
    b.min_mm[i] = std::max(b.min_mm[i], with.min_mm[i]);
    b.max_mm[i] = std::min(b.max_mm[i], with.max_mm[i]);
  }
}

// The surfaces of shapes that came as fields and need triangles.
using MadeOfFields = std::list<surface::TriMesh>;

surface::Bounds bounds_of_shape(const std::string& name, const grid::Field& field) {
  const mask::BitMask mask = mask::positive(field, field);
  if (!mask.any())
    throw refusal("shape." + name, fmt::format("nothing of its field is positive: 0 of {} voxels", field.count()),
                  {"look at what it was made of: `trephine preview` shows a field"});
  const grid::Box inside = mask.bounds();
  return surface::bounds_of(grid::cropped(field, grid::grown(inside, 1, field)), 0.5);
}

// The box that the scene asks for, but no larger than the shapes with their rim.
grid::Lattice lattice_of_region(const VoxelizeStageParams& params, const StageInputs& in) {
  const grid::Lattice& scan = grid::lattice_of(*in.get<grid::HuVolume>("volume"));
  surface::Bounds all;
  for (const auto& [name, mesh] : in.all<surface::TriMesh>("shape"))
    surface::include(all,
                     mesh ? surface::bounds_of(*mesh) : bounds_of_shape(name, *in.get<grid::Field>("shape." + name)));
  if (params.encoding == voxel::HapticEncoding::hu) all = surface::bounds_of(scan, 0.5);
  surface::Bounds region = all;
  if (!params.region_of.empty()) {
    const surface::TriMesh* of = in.get<surface::TriMesh>("shape." + params.region_of);
    const grid::Field* field = in.get<grid::Field>("shape." + params.region_of);
    if (!of) of = in.get<surface::TriMesh>("region");
    if (!of && !field) throw Error(ExitCode::bad_config, "", "region_of", params.region_of + ", has no surface");
    region = of ? surface::bounds_of(*of) : bounds_of_shape(params.region_of, *field);
  }
  region = grown(region, params.margin_mm);
  const auto& [low, high] = std::tie(params.region_min_mm, params.region_max_mm);
  intersect(region, {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  const double largest_mm = *std::max_element(params.spacing_mm.begin(), params.spacing_mm.end());
  intersect(region, grown(all, rim_voxels * largest_mm));
  for (int i = 0; i < 3; ++i)
    if (!(region.min_mm[i] < region.max_mm[i]))
      throw refusal("region", "holds nothing of any shape",
                    {"move `region_min_mm` and `region_max_mm`, or name another `region_of`"});
  return voxel::haptic_lattice(region, scan.direction, scan.origin_mm, params);
}

using MadeVolume = Outcome<voxel::HapticVolume, voxel::VoxelizeResult>;

const surface::TriMesh* surface_of(const std::string& name, const StageInputs& in, MadeOfFields& made,
                                   const Progress& progress) {
  const surface::TriMesh* mesh = in.get<surface::TriMesh>("shape." + name);
  if (!mesh) mesh = in.get<surface::TriMesh>("clear." + name);
  const grid::Field* field = in.get<grid::Field>("shape." + name);
  if (mesh || !field) return mesh;
  return &made.emplace_back(meshing::contour(*field, meshing::ContourParams(), progress.silent()).value);
}

MadeVolume make_volume(const VoxelizeStageParams& params, const grid::Lattice& lattice, const StageInputs& in,
                       const Progress& progress) {
  if (params.encoding == voxel::HapticEncoding::hu) {
    std::vector<voxel::HuWindow> windows;
    for (const auto& [name, s] : params.shapes)
      windows.push_back({name, static_cast<std::int16_t>(s.window_hu[0]), static_cast<std::int16_t>(s.window_hu[1])});
    return voxel::voxelize_hu(*in.get<grid::HuVolume>("volume"), lattice, windows, progress);
  }
  std::vector<voxel::VoxelizeShape> shapes;
  MadeOfFields made;
  for (const auto& [name, s] : params.shapes) {
    voxel::VoxelizeShape shape;
    shape.name = name;
    shape.shell_mm = s.shell_mm;
    shape.surface = s.shell_mm > 0 ? surface_of(name, in, made, progress) : in.get<surface::TriMesh>("shape." + name);
    if (!shape.surface) {
      shape.field = in.get<grid::Field>("shape." + name);
      if (!shape.field) throw Error(ExitCode::usage, "", "shape", name + ", has no surface");
      shape.turned =
          mask::turned_by_contour(*shape.field, meshing::ContourParams().min_component_mm3, progress.silent());
    }
    if (!s.clear_of.empty()) {
      shape.clear_of = surface_of(s.clear_of, in, made, progress);
      shape.clear_mm = s.clear_mm;
    }
    shapes.push_back(std::move(shape));
  }
  return voxel::voxelize(lattice, shapes, progress);
}

void cut(MadeVolume& made, const VoxelizeStageParams& params, const std::vector<boolean::Cutter>& cutters,
         const Progress& progress) {
  voxel::HapticVolume& volume = made.value;
  for (const boolean::Cutter& cutter : cutters) {
    voxel::CutVolumeResult removed;
    for (const auto& [name, shape] : params.shapes) {
      const DrillParams* drill = find_item(params.drill, name);
      if (!drill) continue;
      const boolean::Cutter own = boolean::widened(cutter, drill->widen_mm);
      const auto one = voxel::cut_volume(volume, boolean::distance_to(own), boolean::bounds_of(own),
                                         {volume.find_shape(name)->number}, progress);
      removed.shapes.insert(removed.shapes.end(), one.result.shapes.begin(), one.result.shapes.end());
      removed.voxels_count += one.result.voxels_count;
      for (Warning& w : boolean::warnings_of(cutter, one.warnings)) made.warnings.push_back(std::move(w));
      if (auto thin = boolean::thin_cutter(own, volume.voxels.spacing_mm)) made.warnings.push_back(std::move(*thin));
    }
    if (!removed.shapes.empty()) made.result.cutters.emplace_back(cutter.name, std::move(removed));
  }
}

void check_shapes(const VoxelizeStageParams& params) {
  const bool hu = params.encoding == voxel::HapticEncoding::hu;
  for (const auto& [name, s] : params.shapes) {
    if (s.clear_of == name) throw Error(ExitCode::usage, "", "shapes." + name + ".clear_of", "is the shape itself");
    if (hu && s.window_hu == HapticShapeParams().window_hu)
      throw Error(ExitCode::usage, "", "shapes." + name + ".window_hu", "is missing: the encoding is hu");
    if (hu && !s.clear_of.empty())
      throw Error(ExitCode::usage, "", "shapes." + name + ".clear_of", "needs surfaces, and encoding hu has none");
    if (hu && s.shell_mm > 0)
      throw Error(ExitCode::usage, "", "shapes." + name + ".shell_mm", "needs surfaces, and encoding hu has none");
  }
  for (const auto& [name, drill] : params.drill)
    if (!find_item(params.shapes, name))
      throw Error(ExitCode::usage, "", "drill." + name, "is no shape of the haptic volume");
}

// What the graph of a case has to find for the parameters.
std::vector<std::string> surfaces_of_shapes(const AnyParams& any) {
  const auto& params = any.as<VoxelizeStageParams>();
  std::vector<std::string> names;
  if (params.encoding == voxel::HapticEncoding::occupancy)
    for (const auto& shape : params.shapes) names.push_back(shape.first);
  return names;
}

bool is_solid(const AnyParams& any, const std::string& name) {
  const auto& params = any.as<VoxelizeStageParams>();
  const HapticShapeParams* shape = find_item(params.shapes, name);
  return shape && !(shape->shell_mm > 0);
}

std::vector<std::string> kept_clear_of(const AnyParams& any) {
  std::vector<std::string> names;
  for (const auto& shape : any.as<VoxelizeStageParams>().shapes) names.push_back(shape.second.clear_of);
  return names;
}

std::vector<std::string> region_of(const AnyParams& any) { return {any.as<VoxelizeStageParams>().region_of}; }

bool reads_hardness(const VoxelizeStageParams& params) { return params.hardness_high_hu > params.hardness_low_hu; }

bool reads_no_hu(const AnyParams& any) {
  const auto& params = any.as<VoxelizeStageParams>();
  return params.encoding == voxel::HapticEncoding::occupancy && !reads_hardness(params);
}

bool is_drilled(const AnyParams& any) { return !any.as<VoxelizeStageParams>().drill.empty(); }

}  // namespace

std::string HapticShapeParams::fault() const {
  if (clear_of.empty() != (clear_mm == 0)) return "clear_of: and clear_mm go together";
  if (window_hu[0] > window_hu[1] || window_hu[0] != std::floor(window_hu[0]) ||
      window_hu[1] != std::floor(window_hu[1]))
    return "window_hu: must be two whole HU, the lower one first";
  return "";
}

StageType voxelize_stage() {
  StageType s;
  s.name = "voxelize";
  s.version = 4;
  s.typical.base_s = 0.2;
  s.typical.per_million_triangles_s = 0.6;
  s.typical.per_input_s = 0.5;
  s.place = StagePlace::scene;
  s.case_name = "haptic.voxelize";
  s.summary = "makes the haptic volume, which is what the hand feels";
  s.description =
      "Each voxel says which shape fills it and how much of it, so that one lookup serves any number of shapes and the "
      "surface is felt to a fraction of a voxel. The volume is made of the same surfaces as the displayed ones, before "
      "decimation, or of the fields of what is not displayed otherwise, and cut by the same cutters.";
  s.examples = {
      "trephine voxelize volume.nrrd --shape brain=brain.nrrd --shape skull=skull.nrrd --shape skin=skin.nrrd "
      "--shapes skin:clear_of=brain,clear_mm=5 --output haptic.nrrd",
      "trephine voxelize volume.nrrd --encoding hu --shapes bone:window_hu=300,3000 --spacing-mm 0.5,0.5,1 --output "
      "haptic.nrrd"};
  s.ports = {
      port("volume", DataKind::volume)
          .lattice_does_where(reads_no_hu)
          .help("CT volume in HU, on whose axes the haptic volume lies"),
      port("shape.*", DataKind::mesh)
          .of(surfaces_of_shapes)
          .optional()
          .or_field(is_solid)
          .help("surfaces of the shapes, or fields, which take less time"),
      port("clear.*", DataKind::mesh)
          .of(kept_clear_of)
          .optional()
          .help("surfaces, other than shapes, that shapes keep clear of"),
      port("region", DataKind::mesh)
          .of(region_of)
          .optional()
          .help("surface whose box is the region, where region_of names no shape"),
      port("cutters.*", DataKind::cutters).where(is_drilled).optional().help("what is cut away, such as burr holes")};
  s.output = DataKind::haptic;
  s.declares<VoxelizeStageParams, voxel::VoxelizeResult>();
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress& progress) {
    const auto& params = any.as<VoxelizeStageParams>();
    check_shapes(params);
    const grid::Lattice lattice = lattice_of_region(params, in);
    MadeVolume made = make_volume(params, lattice, in, progress.part(0, 0.9));
    voxel::HapticVolume& volume = made.value;
    if (reads_hardness(params))
      volume.hardness = voxel::haptic_hardness(*in.get<grid::HuVolume>("volume"), lattice, params.hardness_low_hu,
                                               params.hardness_high_hu, progress.part(0.9, 0.93));
    cut(made, params, cutters_of(in), progress.part(0.93, 1));
    // The reported volume is the volume after the cuts.
    for (const auto& [shape, drill] : params.drill) {
      const double left_ml = voxel::shape_volume_mm3(volume, volume.find_shape(shape)->number) / 1000;
      if (!(left_ml > 0))
        throw refusal("drill." + shape, "the cutters leave nothing of it",
                      {"leave it out of `drill`, or make the hole smaller (`diameter_mm`)"});
      for (auto& [name, voxels] : made.result.shapes)
        if (name == shape) voxels.volume_ml = left_ml;
    }
    return stage_outcome(std::move(made));
  };
  return s;
}

}  // namespace trephine::stages
