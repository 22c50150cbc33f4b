// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/decimate.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType decimate_stage() {
  StageType s;
  s.name = "decimate";
  s.version = 9;
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
  s.make_params = [] { return AnyParams::make<meshing::DecimateParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    return std::make_shared<const surface::TriMesh>(meshing::decimate(
        *in.get<surface::TriMesh>("surface"), params.as<meshing::DecimateParams>(), report, progress));
  };
  return s;
}

}  // namespace trephine::stages
