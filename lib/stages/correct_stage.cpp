// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/correct.h"

#include "base/error.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType correct_stage() {
  StageType s;
  s.name = "correct";
  s.version = 1;
  s.summary = "applies a correction that a person painted";
  s.description =
      "Adds to a field and removes from it what a person painted in 3D Slicer or ITK-SNAP and `trephine correction` "
      "took "
      "out as a difference. Further than about two voxels from a changed voxel the field keeps its values. A case's "
      "configuration names corrections by anatomy (corrections: {skull: FILE}), and case.json records each with the "
      "SHA-256 of its file and the volume that it added and removed.";
  s.examples = {
      "trephine correct skull.nrrd --volume head.nrrd --file skull_correction.nrrd --output skull_corrected.nrrd"};
  s.ports = {port("field", DataKind::field).help("Field to correct"),
             port("volume", DataKind::volume).help("CT volume in HU")};
  s.output = DataKind::field;
  s.provenance = {"added_ml", "removed_ml", "already_ratio"};
  s.make_params = [] { return AnyParams::make<segmentation::CorrectParams>(); };
  s.run = [](const AnyParams& params, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const auto& p = params.as<segmentation::CorrectParams>();
    if (p.file.empty()) throw Error(ExitCode::usage, "", "file", "is needed: the correction");
    const grid::Lattice& volume = grid::lattice_of(*in.get<grid::HuVolume>("volume"));
    return std::make_shared<const grid::Field>(with_file(p.file, [&] {
      return segmentation::corrected(*in.get<grid::Field>("field"), volume, grid::read_labels(p.file), report,
                                     progress);
    }));
  };
  return s;
}

}  // namespace trephine::stages
