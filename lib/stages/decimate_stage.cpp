// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/decimate.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType decimate_stage() {
  StageType s;
  s.name = "decimate";
  s.version = 10;
  s.typical.base_s = 0.03;
  s.typical.per_million_triangles_s = 2.8;
  s.summary = "reduces the triangles of a surface within a bound in mm";
  s.description =
      "Collapses edges and keeps the surface closed, 2-manifold and free of self-intersections. It stops at the "
      "requested count or before the bound is exceeded, whichever comes first, and the report says which it was.";
  s.examples = {"trephine decimate skull.vtp --target-triangles-count 80000 --output fewer.vtp",
                "trephine decimate skull.vtp --max-deviation-mm 0.2 --output fewer.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("closed surface")};
  s.output = DataKind::mesh;
  s.declares<meshing::DecimateParams, meshing::DecimateResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    parts.moved_mm = result_as<meshing::DecimateResult>(result).deviation_max_mm;
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        meshing::decimate(*in.get<surface::TriMesh>("surface"), params.as<meshing::DecimateParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
