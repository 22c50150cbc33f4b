// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/haptic.h"

#include <algorithm>
#include <tuple>

#include "base/error.h"
#include "stages/cut.h"
#include "surface/bounds.h"
#include "voxel/cut.h"
#include "voxel/mismatch.h"

namespace trephine {
namespace {

// Air around what there is to feel: the surface's own ramp of occupancy must fit in.
constexpr double rim_voxels = 3;

Bounds grown(Bounds b, double by_mm) {
  for (int i = 0; i < 3; ++i) {
    b.min_mm[i] -= by_mm;
    b.max_mm[i] += by_mm;
  }
  return b;
}

void intersect(Bounds& b, const Bounds& with) {
  for (int i = 0; i < 3; ++i) {
    b.min_mm[i] = std::max(b.min_mm[i], with.min_mm[i]);
    b.max_mm[i] = std::min(b.max_mm[i], with.max_mm[i]);
  }
}

Bounds bounds_of_scan(const Lattice& lattice) {
  Bounds b;
  for (int corner = 0; corner < 8; ++corner)
    include(b,
            lattice.to_world_mm({corner & 1 ? lattice.size[0] - 0.5 : -0.5, corner & 2 ? lattice.size[1] - 0.5 : -0.5,
                                 corner & 4 ? lattice.size[2] - 0.5 : -0.5}));
  return b;
}

// The box that the scene asks for, and no more than there is to feel.
Lattice lattice_of_region(const HapticSpec& spec, const VoxelizeParams& params, const StageInputs& in) {
  const Lattice& scan = lattice_of(*in.get<HuVolume>("volume"));
  Bounds all;
  for (const auto& [name, mesh] : in.all<TriMesh>("shape")) include(all, bounds_of(*mesh));
  if (spec.encoding == HapticEncoding::hu) all = bounds_of_scan(scan);
  Bounds region = all;
  if (!spec.region_of.empty()) {
    const TriMesh* of = in.get<TriMesh>("shape." + spec.region_of);
    if (!of) of = in.get<TriMesh>("region");
    if (!of) throw Error(ExitCode::bad_config, "", "region_of", spec.region_of + ", has no surface");
    region = bounds_of(*of);
  }
  region = grown(region, params.margin_mm);
  const auto& [low, high] = std::tie(params.region_min_mm, params.region_max_mm);
  intersect(region, {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  const double largest_mm = *std::max_element(params.spacing_mm.begin(), params.spacing_mm.end());
  intersect(region, grown(all, rim_voxels * largest_mm));
  for (int i = 0; i < 3; ++i)
    if (!(region.min_mm[i] < region.max_mm[i]))
      throw Error(ExitCode::quality, "", "region", "holds nothing of any shape");
  return haptic_lattice(region, scan.direction, scan.origin_mm, params);
}

HapticVolume make_volume(const HapticSpec& spec, const Lattice& lattice, const StageInputs& in, Report& report,
                         const Progress& progress) {
  if (spec.encoding == HapticEncoding::hu) {
    std::vector<HuWindow> windows;
    for (const HapticShapeSpec& s : spec.shapes) windows.push_back({s.name, s.low_hu, s.high_hu});
    return voxelize_hu(*in.get<HuVolume>("volume"), lattice, windows, report, progress);
  }
  std::vector<VoxelizeShape> shapes;
  for (const HapticShapeSpec& s : spec.shapes) {
    VoxelizeShape shape;
    shape.name = s.name;
    shape.surface = in.get<TriMesh>("shape." + s.name);
    if (!s.clear_of.empty()) {
      shape.clear_of = in.get<TriMesh>("shape." + s.clear_of);
      if (!shape.clear_of) shape.clear_of = in.get<TriMesh>("clear." + s.clear_of);
      shape.clear_mm = s.clear_mm;
    }
    shapes.push_back(shape);
  }
  return voxelize(lattice, shapes, report, progress);
}

void cut(HapticVolume& volume, const HapticSpec& spec, const std::vector<Cutter>& cutters, Report& report,
         const Progress& progress) {
  for (const Cutter& cutter : cutters)
    for (const HapticShapeSpec& s : spec.shapes) {
      if (!s.drilled) continue;
      const Cutter own = widened(cutter, s.widen_mm);
      Report one;
      cut_volume(volume, distance_to(own), bounds_of(own), {volume.find_shape(s.name)->number}, one, progress);
      add_of_cutter(report, cutter, one);
      warn_of_thin(report, own, volume.voxels.spacing_mm);
    }
}

}  // namespace

std::string to_text(const HapticSpec& spec) {
  std::string text = spec.encoding == HapticEncoding::hu ? "hu" : "occupancy";
  text += " of " + spec.region_of;
  for (const HapticShapeSpec& s : spec.shapes)
    text += "; " + s.name + " clear " + s.clear_of + " " + to_text(ParameterValue(s.clear_mm)) + " window " +
            std::to_string(s.low_hu) + " " + std::to_string(s.high_hu) +
            (s.drilled ? " drilled " + to_text(ParameterValue(s.widen_mm)) : "");
  return text;
}

StageType voxelize_stage(const HapticSpec& spec) {
  StageType s;
  s.name = "voxelize";
  s.version = 2;
  s.summary = "makes the haptic volume: what the hand feels";
  s.description =
      "Each voxel says which shape fills it and how much of it, so that one lookup serves any number of shapes and the "
      "surface is felt to a fraction of a voxel. It is made of the same surfaces as what is displayed, before "
      "decimation, and cut by the same cutters.";
  s.ports = {{"volume", DataKind::volume, true, "the scan"},
             {"shape.*", DataKind::mesh, false, "surfaces of the shapes"},
             {"region", DataKind::mesh, false, "what the region is the box of"},
             {"clear.*", DataKind::mesh, false, "what a shape keeps away from"},
             {"cutters.*", DataKind::cutters, false, "what is cut away"}};
  s.output = DataKind::haptic;
  s.make_params = [] { return AnyParams::make<VoxelizeParams>(); };
  s.run = [spec](const AnyParams& any, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const auto& params = any.as<VoxelizeParams>();
    const Lattice lattice = lattice_of_region(spec, params, in);
    HapticVolume volume = make_volume(spec, lattice, in, report, progress.part(0, 0.9));
    if (params.hardness_high_hu > params.hardness_low_hu)
      volume.hardness = haptic_hardness(*in.get<HuVolume>("volume"), lattice, params.hardness_low_hu,
                                        params.hardness_high_hu, progress.part(0.9, 0.93));
    cut(volume, spec, cutters_of(in), report, progress.part(0.93, 1));
    // What is reported is what is left.
    for (const HapticShapeSpec& s : spec.shapes)
      if (s.drilled)
        for (auto& [name, value] : report.figures)
          if (name == s.name + ".volume_ml") value = shape_volume_mm3(volume, volume.find_shape(s.name)->number) / 1000;
    return std::make_shared<const HapticVolume>(std::move(volume));
  };
  return s;
}

StageType mismatch_stage() {
  StageType s;
  s.name = "mismatch";
  s.version = 2;
  s.summary = "measures how far what is felt lies from what is seen";
  s.description = "Along the normals of the displayed surfaces, where the haptic volume's surface lies.";
  s.ports = {{"haptic", DataKind::haptic, true, "haptic volume"},
             {"surface.*", DataKind::mesh, true, "displayed surfaces"}};
  s.output = DataKind::nothing;
  s.make_params = [] { return AnyParams::make<MismatchParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const HapticVolume& volume = *in.get<HapticVolume>("haptic");
    for (const auto& [name, mesh] : in.all<TriMesh>("surface")) {
      const Mismatch m =
          measure_mismatch(*mesh, volume, *volume.find_shape(name), params.as<MismatchParams>(), progress);
      report.add(name + ".mismatch_bias_mm", m.bias_mm);
      report.add(name + ".mismatch_rms_mm", m.rms_mm);
      report.add(name + ".mismatch_p99_mm", m.p99_mm);
      report.add(name + ".mismatch_max_mm", m.max_mm);
      report.add(name + ".mismatch_missed_ratio", m.missed_ratio);
      report.add(name + ".mismatch_samples_count", m.samples);
    }
    return {};
  };
  return s;
}

}  // namespace trephine
