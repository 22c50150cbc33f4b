// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/cut_surface.h"

#include "stages/cutters_of.h"

namespace trephine::stages {

StageType boolean_stage() {
  StageType s;
  s.name = "boolean";
  s.version = 3;
  s.typical.base_s = 1.5;
  s.place = StagePlace::scene;
  s.summary = "cuts burr holes and other solids out of a surface";
  s.description =
      "The cut is an exact corefinement in a bounded child process. Operands and result are checked: they must be "
      "closed, 2-manifold and free of self-intersections. The removed volume is compared with the exact one.";
  s.examples = {"trephine boolean skull.vtp --cutters hole.json --output drilled.vtp",
                "trephine boolean haptic.nrrd --cutters hole.json --shape skull --shape skin --output drilled.nrrd",
                "trephine boolean skull.vtp --kind sphere --position-mm 10,-40,60 --radius-mm 8 --output cut.vtp"};
  s.ports = {port("surface", DataKind::mesh).from(From::finished_surface).help("closed surface"),
             port("cutters.*", DataKind::cutters).help("what is cut away")};
  s.output = DataKind::mesh;
  s.declares<boolean::CutSurfaceParams, boolean::CutSurfaceResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(boolean::cut_surface(*in.get<surface::TriMesh>("surface"), cutters_of(in),
                                              params.as<boolean::CutSurfaceParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
