// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/normals.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType normals_stage() {
  StageType s;
  s.name = "normals";
  s.version = 1;
  s.typical.base_s = 0.01;
  s.summary = "gives every point of a surface a normal";
  s.description =
      "Gives smooth normals, one for each point. No point is split at a sharp edge, so a closed surface stays closed. "
      "An open surface is accepted too.";
  s.examples = {"trephine normals smooth.vtp --output skull.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("surface")};
  s.output = DataKind::mesh;
  s.make_params = [] { return AnyParams::make<meshing::NormalsParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    auto mesh = std::make_shared<surface::TriMesh>(*in.get<surface::TriMesh>("surface"));
    meshing::compute_normals(*mesh, params.as<meshing::NormalsParams>(), report, progress);
    return std::shared_ptr<const surface::TriMesh>(mesh);
  };
  return s;
}

}  // namespace trephine::stages
