// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/normals.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType normals_stage() {
  StageType s;
  s.name = "normals";
  s.version = 2;
  s.typical.base_s = 0.01;
  s.summary = "gives every point of a surface a normal";
  s.description =
      "Gives smooth normals, one for each point. No point is split at a sharp edge, so a closed surface stays closed. "
      "An open surface is accepted too.";
  s.examples = {"trephine normals smooth.vtp --output skull.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("surface")};
  s.output = DataKind::mesh;
  s.declares<meshing::NormalsParams, meshing::NormalsResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    Outcome<surface::TriMesh, meshing::NormalsResult> made{*in.get<surface::TriMesh>("surface"), {}, {}};
    made.result = meshing::compute_normals(made.value, params.as<meshing::NormalsParams>(), progress);
    return stage_outcome(std::move(made));
  };
  return s;
}

}  // namespace trephine::stages
