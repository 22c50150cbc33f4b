// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/smooth.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType smooth_stage() {
  StageType s;
  s.name = "smooth";
  s.version = 5;
  s.typical.base_s = 0.08;
  s.summary = "smooths a surface within a bound in mm";
  s.description =
      "Windowed sinc, Laplacian or feature-keeping smoothing. No point moves farther than the bound, and the volume is "
      "kept. Points stay where moving them would make the surface intersect itself.";
  s.examples = {"trephine smooth skull.vtp --max-displacement-mm 0.1 --output smooth.vtp",
                "trephine smooth fewer.vtp --reference skull.vtp --total-deviation-mm 0.3 --output smooth.vtp"};
  s.ports = {port("surface", DataKind::mesh).help("closed surface"),
             port("reference", DataKind::mesh)
                 .optional()
                 .help("the surface to which the total deviation is kept and measured")};
  s.output = DataKind::mesh;
  s.declares<meshing::SmoothParams, meshing::SmoothResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    parts.moved_mm = result_as<meshing::SmoothResult>(result).displacement_max_mm;
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(meshing::smooth(*in.get<surface::TriMesh>("surface"), params.as<meshing::SmoothParams>(),
                                         progress, in.get<surface::TriMesh>("reference")));
  };
  return s;
}

}  // namespace trephine::stages
