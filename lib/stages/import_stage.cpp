// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "look/look.h"
#include "stages/import.h"
#include "stages/stage.h"

namespace trephine::stages {

StageType import_stage() {
  StageType s;
  s.name = "import";
  s.version = 7;
  s.typical.base_s = 0.1;
  s.typical.per_million_voxels_s = 0.007;
  s.place = StagePlace::scene;
  s.summary = "reads a CT series from a DICOM folder or ZIP archive into a volume in HU";
  s.output = DataKind::volume;
  s.make_params = [] { return AnyParams::make<ImportStageParams>(); };
  s.run = [](const AnyParams& any, const StageInputs& in, Report& report, const Progress& progress) -> StageData {
    const auto& params = any.as<ImportStageParams>();
    dicom::ImportResult imported = dicom::import_series(params.input, params, progress.part(0, 0.9));
    // If the series has changed, the new result must not be stored under the key of the old content.
    const auto expected = in.file_sha256.find("input");
    if (expected != in.file_sha256.end() && imported.input_sha256 != expected->second)
      throw Error(ExitCode::bad_input, "scan", "", "the series changed while it was read");
    report = std::move(imported.report);
    const auto said = [&](const char* figure) {
      const ParameterValue* value = report.find(figure);
      return value ? std::get<std::string>(*value) : std::string();
    };
    if (said("modality") == "CT") {
      const look::ScanLook seen = look::look_at(imported.volume, said("patient_position"), progress.part(0.9, 1));
      look::tell(seen, report);
      look::require_orientation(seen, params.orientation_reason);
    }
    return std::make_shared<const grid::HuVolume>(std::move(imported.volume));
  };
  return s;
}

}  // namespace trephine::stages
