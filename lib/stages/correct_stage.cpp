// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/correct.h"

#include <filesystem>

#include "base/error.h"
#include "pacs/label_objects.h"
#include "segmentation/edit_list.h"
#include "stages/stage.h"

namespace trephine::stages {

namespace {

/// Of one painted correction, or of a list of edits.
struct CorrectResult {
  std::optional<std::int64_t> added_voxels_count, removed_voxels_count;  ///< of a painted one
  double added_ml = 0, removed_ml = 0, already_ratio = 0;
  std::optional<bool> resampled;            ///< of a painted one
  std::optional<std::int64_t> edits_count;  ///< of a list
  template <class V>
  static void describe(V& v) {
    using P = CorrectResult;
    v.integer(&P::added_voxels_count, "added_voxels_count", "Voxels that were added.");
    v.integer(&P::removed_voxels_count, "removed_voxels_count", "Voxels that were removed.");
    v.number(&P::added_ml, "added_ml", Range{}, "Volume that was added.");
    v.number(&P::removed_ml, "removed_ml", Range{}, "Volume that was removed.");
    v.number(&P::already_ratio, "already_ratio", Range{}, "Share of the correction that held without it.");
    v.flag(&P::resampled, "resampled", "Whether it was made on another raster.");
    v.integer(&P::edits_count, "edits_count", "Edits.");
  }
};

}  // namespace

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
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    const auto& made = result_as<CorrectResult>(result);
    parts.made_of.emplace_back("added_ml", made.added_ml);
    parts.made_of.emplace_back("removed_ml", made.removed_ml);
    parts.made_of.emplace_back("already_ratio", made.already_ratio);
  };
  s.declares<segmentation::CorrectParams, CorrectResult>();
  s.run = [](const AnyParams& params, const StageInputs& in, const Progress& progress) {
    const auto& p = params.as<segmentation::CorrectParams>();
    if (p.file.empty()) throw Error(ExitCode::usage, "", "file", "is needed: the correction");
    const grid::HuVolume& volume = *in.get<grid::HuVolume>("volume");
    const grid::Field& field = *in.get<grid::Field>("field");
    return stage_outcome(with_file(p.file, [&]() -> Outcome<grid::Field, CorrectResult> {
      if (segmentation::is_edit_list(p.file)) {
        auto made = segmentation::apply_edits(field, volume, segmentation::read_edit_list(p.file),
                                              std::filesystem::path(p.file).parent_path(), progress);
        const auto& r = made.result;
        return {std::move(made.value),
                {{}, {}, r.added_ml, r.removed_ml, r.already_ratio, {}, static_cast<std::int64_t>(r.edits_count)},
                std::move(made.warnings)};
      }
      auto made = segmentation::corrected(field, grid::lattice_of(volume), pacs::read_label_file(p.file), progress);
      const auto& r = made.result;
      const auto& c = r.changed;
      return {std::move(made.value),
              {static_cast<std::int64_t>(c.added_voxels_count),
               static_cast<std::int64_t>(c.removed_voxels_count),
               c.added_ml,
               c.removed_ml,
               r.already_ratio,
               r.resampled,
               {}},
              std::move(made.warnings)};
    }));
  };
  return s;
}

}  // namespace trephine::stages
