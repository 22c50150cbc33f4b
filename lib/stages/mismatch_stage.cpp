// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/mismatch.h"

#include "base/error.h"
#include "base/result.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType mismatch_stage() {
  StageType s;
  s.name = "mismatch";
  s.version = 5;
  s.typical.base_s = 0.1;
  s.typical.per_input_s = 0.09;
  s.place = StagePlace::scene;
  s.case_name = "haptic.mismatch";
  s.check.serves = "how far what is felt lies from what is seen";
  s.summary = "measures how far the felt surfaces lie from the displayed ones";
  s.description = "Looks along the normals of the displayed surfaces for the surface of the haptic volume.";
  s.examples = {"trephine mismatch haptic.nrrd --surface skull=skull.vtp"};
  s.ports = {port("haptic", DataKind::haptic).help("haptic volume"),
             port("surface.*", DataKind::mesh).from(From::felt_surfaces).help("displayed surfaces")};
  s.output = DataKind::nothing;
  s.declares<voxel::MismatchParams, voxel::MismatchResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    voxel::MismatchResult result;
    const voxel::HapticVolume& volume = *in.get<voxel::HapticVolume>("haptic");
    for (const auto& [name, mesh] : in.all<surface::TriMesh>("surface")) {
      const voxel::HapticShape* shape = volume.find_shape(name);
      if (!shape) throw Error(ExitCode::usage, "", "surface", name + ", the volume has no such shape");
      result.shapes.emplace_back(
          name, voxel::measure_mismatch(*mesh, volume, *shape, params.as<voxel::MismatchParams>(), progress));
    }
    return StageOutcome{{}, AnyParams::make(std::move(result)), {}};
  };
  return s;
}

}  // namespace trephine::stages
