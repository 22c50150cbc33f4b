// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/simplify_topology.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType simplify_stage() {
  StageType s;
  s.name = "simplify";
  s.version = 1;
  s.typical.base_s = 0;
  s.typical.per_million_voxels_s = 0.005;
  s.summary = "closes a field's small tunnels and cavities, for display";
  s.description =
      "Closes tunnels narrower than close_handles_mm by membranes of one voxel and fills small cavities; everywhere "
      "else the surface stays as it is. This allows a surface with fewer triangles, because a decimation that stays "
      "2-manifold keeps every tunnel. The report gives the topology before and after, and how far the new surface lies "
      "from the old one.";
  s.examples = {"trephine simplify skull.nrrd --close-handles-mm 2 --output display.nrrd"};
  s.ports = {port("field", DataKind::field).help("field of the segment stage")};
  s.output = DataKind::field;
  s.declares<mask::SimplifyParams, mask::SimplifyResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    return stage_outcome(
        mask::simplify_topology(*in.get<grid::Field>("field"), params.as<mask::SimplifyParams>(), progress));
  };
  return s;
}

}  // namespace trephine::stages
