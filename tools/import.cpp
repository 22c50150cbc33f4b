// SPDX-License-Identifier: GPL-3.0-or-later
#include "dicom/import.h"

#include <sys/stat.h>

#include <iostream>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "dicom/input_files.h"
#include "look/look.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {

namespace {

struct ListParams {
  bool list = false;
  template <class V>
  static void describe(V& v) {
    v.flag(&ListParams::list, "list",
           "Say which series there are, what import would make of each, and what the picture of the one that would be "
           "read shows: how a head lies in it, where the scan cuts the body.");
  }
};

void check_usage(const cli::ParsedCommand& parsed) {
  const bool list = parsed.params<ListParams>().list;
  const auto contradicts = [](const char* field, const char* what) { throw Error(ExitCode::usage, "", field, what); };
  if (!list && !parsed.has("output")) contradicts("output", "is needed: give --output FILE.nrrd, or --list");
  if (list && parsed.has("output")) contradicts("output", "contradicts --list, which writes no volume");
  if (list && parsed.has("report")) contradicts("report", "contradicts --list: give --json");
  if (!list && parsed.has("file_map")) contradicts("file_map", "is for --list");
  if (!list && parsed.has("json")) contradicts("json", "is for --list: give --report");
}

/// For its owner's eyes alone.
void write_private_file(const std::filesystem::path& file, const std::string& bytes) {
  const mode_t before = ::umask(077);
  write_file(file, bytes);
  ::umask(before);
}

/// What the picture shows against what its files say.
Report look_at_result(const dicom::ImportResult& read, const Progress& progress) {
  const auto seen = look::look_at_ct(read.volume, read.figures, progress);
  return seen ? printed(figures_of(look::figures_of(*seen)), look::warnings_of(*seen)) : Report();
}

/// The series that would be read, or none.
dicom::SeriesSummary* meant(dicom::SeriesList& list, const std::string& token) {
  for (dicom::SeriesSummary& s : list.series) {
    const bool is_named = s.token == token || s.token.substr(0, s.token.find('-')) == token;
    if (s.usable && (token.empty() ? s.proposed || list.series.size() == 1 : is_named)) return &s;
  }
  return nullptr;
}

void look_at_meant(const cli::ParsedCommand& parsed, dicom::SeriesList& list, const Progress& progress) {
  dicom::ImportParams params = parsed.params<dicom::ImportParams>();
  dicom::SeriesSummary* series = meant(list, params.series);
  if (!series) return;
  params.series = series->token;
  try {
    series->seen = look_at_result(dicom::import_series(parsed.path("input"), params, progress.part(0, 0.8)),
                                  progress.part(0.8, 1));
  } catch (const Error& e) {  // found where pixels are decoded
    if (e.code() != ExitCode::bad_input) throw;
    series->usable = false;
    series->verdict = "refused: " + e.field() + ": " + e.what();
  }
}

ExitCode list(const cli::ParsedCommand& parsed) {
  // First, so that it is there also where the list is refused.
  if (parsed.has("file_map")) write_private_file(parsed.path("file_map"), dicom::scan_file_map(parsed.path("input")));
  dicom::SeriesList found;
  {
    cli::ProgressDisplay display(parsed.quiet);
    found = dicom::list_series(parsed.path("input"), parsed.params<dicom::ImportParams>(), display.start("list"));
    display.finish("list", "");
    look_at_meant(parsed, found, display.start("look"));
    display.finish("look", "");
  }
  if (parsed.has("json")) write_file(parsed.path("json"), dicom::list_json(found));
  for (const Warning& w : found.folder.warnings) log_warning(to_text(w));
  for (const dicom::SeriesSummary& s : found.series)
    for (const std::string& w : s.seen.warnings) log_warning(s.token + ": " + w);
  if (!parsed.quiet || !parsed.has("json")) std::cout << dicom::list_text(found);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand import_command([] {
  cli::Command c;
  c.name = "import";
  c.summary = "reads a CT series (DICOM folder, ZIP archive) or a volume file into a volume in HU";
  c.description =
      "With --list it only says which series there are, and whether each is usable, usable after rectification, or "
      "refused and why, and looks at the one that is named or proposed. Otherwise it reads one series: slices are "
      "ordered and placed by their positions, HU are "
      "computed slice by slice, a tilted gantry and uneven spacing are rectified by resampling, and padding becomes "
      "air. A series that cannot be read correctly is refused, naming file and tag. Names, IDs and UIDs of the patient "
      "are never written anywhere. A volume file that is no DICOM (NIfTI, MetaImage, NRRD, GIPL, VTK, MINC), or a "
      "volume of a 3D Slicer scene (.mrml, .mrb), is read where --volume-values says what its values are.";
  c.examples = {"trephine import DICOM-FOLDER --list", "trephine import DICOM-FOLDER --list --file-map private.tsv",
                "trephine import DICOM-FOLDER-OR-ZIP --output head.nrrd",
                "trephine import DICOM-FOLDER --series s2 --gaps interpolate --output head.nrrd",
                "trephine import head.nii.gz --volume-values hu --output head.nrrd"};
  cli::Argument from;
  from.name = "input";
  from.kind = cli::Argument::Kind::in_scan;
  from.help = "Folder (searched five levels deep), ZIP archive or file with the series.";
  from.required = from.positional = true;
  cli::Argument to;
  to.name = "output";
  to.kind = cli::Argument::Kind::out_file;
  to.help = "File for the volume (.nrrd); required except with --list.";
  cli::Argument json;
  json.name = "json";
  json.kind = cli::Argument::Kind::out_file;
  json.help = "With --list: write the table as JSON.";
  cli::Argument map;
  map.name = "file_map";
  map.kind = cli::Argument::Kind::out_file;
  map.help = "With --list: write which file has which number in messages, readable for its owner alone.";
  c.arguments = {from, to, report_argument(), json, map};
  c.groups = {cli::ParameterGroup::of<dicom::ImportParams>("Parameters"),
              cli::ParameterGroup::of<ListParams>("Listing")};
  c.run = [](const cli::ParsedCommand& parsed) {
    check_usage(parsed);
    if (parsed.params<ListParams>().list) return list(parsed);
    run_with_report(parsed, [&](const Progress& progress) {
      dicom::ImportResult result =
          dicom::import_series(parsed.path("input"), parsed.params<dicom::ImportParams>(), progress);
      const Report seen = look_at_result(result, progress);
      stages::save_data(parsed.path("output"), std::make_shared<const grid::HuVolume>(std::move(result.volume)));
      Report all = result.report();
      add(all, seen);
      add(all, printed(result.folder));
      return all;
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
