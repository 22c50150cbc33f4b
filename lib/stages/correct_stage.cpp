// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/correct.h"

#include <filesystem>

#include "base/error.h"
#include "segmentation/edit_list.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType correct_stage() {
  StageType s;
  s.name = "correct";
  s.version = 1;
  s.summary = "applies a correction that a person painted";
  s.description =
      "Adds to a field and removes from it what a person painted at the desk, or in 3D Slicer or ITK-SNAP, and "
      "`trephine correction` took out as a difference. A file that ends in .json lists edits instead, which are done "
      "one after the other: painted patches, balls that grow over what has their HU (snakes), cuts by a plane, places "
      "that are smoothed. Further than about two voxels from a changed voxel the field keeps its values. A case's "
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
    const grid::HuVolume& volume = *in.get<grid::HuVolume>("volume");
    const grid::Field& field = *in.get<grid::Field>("field");
    return std::make_shared<const grid::Field>(with_file(p.file, [&] {
      if (segmentation::is_edit_list(p.file))
        return segmentation::apply_edits(field, volume, segmentation::read_edit_list(p.file),
                                         std::filesystem::path(p.file).parent_path(), report, progress);
      return segmentation::corrected(field, grid::lattice_of(volume), grid::read_labels(p.file), report, progress);
    }));
  };
  return s;
}

}  // namespace trephine::stages
