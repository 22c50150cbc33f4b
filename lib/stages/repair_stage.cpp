// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType repair_stage() {
  StageType s;
  s.name = "repair";
  s.version = 1;
  s.typical.base_s = 5;
  s.summary = "makes a closed, valid surface from a mesh of another program";
  s.description =
      "Merges points, turns triangles, separates what more than one sheet shares, fills holes, removes slivers, "
      "duplicates and self-intersections, and unites pieces that overlap. Each repair is counted. Where the result is "
      "not a closed 2-manifold free of self-intersections, a new surface is made through voxels, and the report says "
      "how far it lies from the input.";
  s.examples = {"trephine repair model.stl --output model.vtp",
                "trephine repair model.obj --recontour-voxels-count 0 --output model.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("surface of triangles of any kind, also of a broken one")};
  s.output = DataKind::mesh;
  s.declares<meshing::RepairParams, meshing::RepairResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        meshing::repair(*in.get<surface::TriMesh>("surface"), params.as<meshing::RepairParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
