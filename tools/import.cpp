// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/import.h"
#include "commands.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine {

Command import_command() {
  Command c;
  c.name = "import";
  c.summary = "reads a CT series from a DICOM folder into a volume in HU";
  c.description =
      "Slices are ordered and placed by their positions, HU are computed slice by slice, a tilted gantry and uneven "
      "spacing "
      "are rectified by resampling, padding becomes air. What cannot be read rightly is refused, naming file and tag. "
      "Names, "
      "IDs and UIDs of the patient go nowhere.";
  c.examples = {"trephine import DICOM-FOLDER --output head.nrrd",
                "trephine import DICOM-FOLDER --series s2 --gaps interpolate --output head.nrrd"};
  Argument from;
  from.name = "folder";
  from.kind = Argument::Kind::in_path;
  from.help = "Folder (searched five levels deep) with the series.";
  from.required = from.positional = true;
  Argument to;
  to.name = "output";
  to.kind = Argument::Kind::out_file;
  to.help = "Where the volume goes (.nrrd).";
  to.required = true;
  c.arguments = {from, to, report_argument()};
  c.groups = {ParameterGroup::of<ImportParams>("Parameters")};
  c.run = [](const ParsedCommand& parsed) {
    run_with_report(parsed, [&](const Progress& progress) {
      ImportResult result = import_series(parsed.path("folder"), parsed.params<ImportParams>(), progress);
      save_data(parsed.path("output"), std::make_shared<const HuVolume>(std::move(result.volume)));
      Report all = std::move(result.report);
      for (auto& f : result.folder.figures) all.figures.push_back(std::move(f));
      for (auto& w : result.folder.warnings) all.warnings.push_back(std::move(w));
      return all;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
