// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/remesh.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType remesh_stage() {
  StageType s;
  s.name = "remesh";
  s.version = 1;
  s.typical.base_s = 6;
  s.summary = "makes a surface's triangles even, within a bound in mm";
  s.description =
      "Isotropic remeshing: near equilateral triangles with edges of one length and points on the input's surface. "
      "Where the result is not valid or exceeds the bound, shorter edges are tried.";
  s.examples = {"trephine remesh skull.vtp --edge-mm 1.5 --output even.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("closed surface")};
  s.output = DataKind::mesh;
  s.declares<meshing::RemeshParams, meshing::RemeshResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    parts.moved_mm = result_as<meshing::RemeshResult>(result).deviation_max_mm;
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        meshing::remesh(*in.get<surface::TriMesh>("surface"), params.as<meshing::RemeshParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
