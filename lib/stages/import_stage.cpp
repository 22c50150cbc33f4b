// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "base/error.h"
#include "look/look.h"
#include "stages/import.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType import_stage() {
  StageType s;
  s.name = "import";
  s.version = 8;
  s.typical.base_s = 0.1;
  s.typical.per_million_voxels_s = 0.007;
  s.place = StagePlace::scene;
  s.summary = "reads a CT series from a DICOM folder or ZIP archive into a volume in HU";
  s.output = DataKind::volume;
  s.declares<ImportStageParams, ImportStageResult>();
  s.contribute = [](const AnyParams& result, CaseParts& parts) {
    const auto& seen = result_as<ImportStageResult>(result).seen;
    if (seen && seen->blank_slices_count)
      parts.evidence.push_back({"", "", fmt::format("{} slices were not measured", *seen->blank_slices_count)});
  };
  s.run = [](const AnyParams& any, const StageInputs& in, const Progress& progress) {
    const auto& params = any.as<ImportStageParams>();
    dicom::ImportResult imported = dicom::import_series(params.input, params, progress.part(0, 0.9));
    // If the series has changed, the new result must not be stored under the key of the old content.
    const auto expected = in.file_sha256.find("input");
    if (expected != in.file_sha256.end() && imported.input_sha256 != expected->second)
      throw Error(ExitCode::bad_input, "scan", "", "the series changed while it was read");
    ImportStageResult result{std::move(imported.figures), {}};
    if (const auto seen = look::look_at_ct(imported.volume, result.scan, progress.part(0.9, 1))) {
      result.seen = look::figures_of(*seen);
      for (Warning& w : look::warnings_of(*seen)) imported.warnings.push_back(std::move(w));
      look::require_orientation(*seen, params.orientation_reason);
    }
    return stage_outcome(Outcome<grid::HuVolume, ImportStageResult>{std::move(imported.volume), std::move(result),
                                                                    std::move(imported.warnings)});
  };
  return s;
}

}  // namespace trephine::stages
