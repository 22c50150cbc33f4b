// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/contour.h"

#include "stages/stage.h"

namespace trephine::stages {

StageType contour_stage() {
  StageType s;
  s.name = "contour";
  s.version = 1;
  s.typical.base_s = 0.01;
  s.typical.per_million_triangles_s = 0.9;
  s.summary = "makes the closed surface of a field, or of a volume at an isovalue";
  s.description =
      "Marching cubes on real values: the surface lies between the voxels, where the field says. Where the edge of the "
      "volume cuts the anatomy, the surface is capped. Flat parts can be made of fewer triangles at once (within_mm). "
      "On "
      "a volume of whole numbers an isovalue that is a whole number "
      "is moved by a half, and the report says so.";
  s.examples = {"trephine contour skull.nrrd --output skull.vtp",
                "trephine contour head.nrrd --isovalue-hu 300 --output bone.vtp"};
  s.ports = {port("field", DataKind::field).or_volume().help("field of the segment stage, or a CT volume")};
  s.output = DataKind::mesh;
  s.declares<meshing::ContourParams, meshing::ContourResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    if (const auto& merged = result_as<meshing::ContourResult>(result).merged)
      parts.moved_mm = merged->within_proven_mm;
  };
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const auto& p = params.as<meshing::ContourParams>();
    const grid::Field* field = in.get<grid::Field>("field");
    return stage_outcome(field ? meshing::contour(*field, p, progress)
                               : meshing::contour(*in.get<grid::HuVolume>("field"), p, progress));
  };
  return s;
}

}  // namespace trephine::stages
