// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/preview.h"

#include <iostream>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "grid/bounded_read.h"
#include "named_values.h"
#include "stages/data_files.h"

namespace trephine::tools {
namespace {

namespace fs = std::filesystem;

class DisplayObserver : public pipeline::RunObserver {
 public:
  explicit DisplayObserver(cli::ProgressDisplay& display) : display_(display) {}
  void started(const std::string& node) override { display_.start(node); }
  void progressed(const std::string& node, double fraction) override { display_.report(node, fraction); }
  void finished(const std::string& node, bool cached, double, const stages::StageOutcome&) override {
    display_.finish(node, cached ? "from the cache" : "");
  }

 private:
  cli::ProgressDisplay& display_;
};

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// A file of a single tool, or of run --keep.
stages::StageData load_result(const fs::path& file) {
  const std::string name = file.filename().string();
  if (ends_with(name, ".vtp")) return stages::load_data(file, stages::DataKind::mesh);
  if (ends_with(name, ".json")) {
    try {
      return stages::load_data(file, stages::DataKind::cutters);
    } catch (const Error&) {
      return stages::load_data(file, stages::DataKind::landmarks);
    }
  }
  if (ends_with(name, ".seg.nrrd") || ends_with(name, ".nii.gz") || ends_with(name, ".nii"))
    return stages::load_data(file, stages::DataKind::labels);
  if (ends_with(name, ".nrrd")) return stages::load_field_or_volume(file);
  throw Error(ExitCode::usage, file.string(), "input", "must be .yaml, .nrrd, .vtp, .json, .seg.nrrd or .nii.gz");
}

publish::Preview preview_file(const cli::ParsedCommand& parsed, const Progress& progress) {
  const fs::path file = parsed.path("input");
  const stages::StageData data = load_result(file);
  std::optional<grid::HuVolume> volume;
  if (parsed.has("volume")) volume = grid::read_foreign_hu(parsed.path("volume"));
  return with_file(file.string(), [&] {
    return publish::draw_preview(file.stem().string(), data, volume ? &*volume : nullptr,
                                 parsed.params<publish::PreviewParams>(), progress);
  });
}

void check_flags(const cli::ParsedCommand& parsed, bool of_config) {
  if (of_config && parsed.has("volume")) throw Error(ExitCode::usage, "", "--volume", "is for a result's file");
  for (const char* flag : {"series", "scan", "set", "root", "landmarks", "cache"})
    if (!of_config && parsed.has(flag))
      throw Error(ExitCode::usage, "", std::string("--") + flag, "is for a configuration (.yaml)");
  for (const char* flag : {"stage", "allow_external"})
    if (!of_config && parsed.given.count(flag))
      throw Error(ExitCode::usage, "", std::string("--") + flag, "is for a configuration (.yaml)");
}

}  // namespace

const cli::OwnCommand preview_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "preview";
  c.summary = "draws a stage's result on three slices and as a small surface";
  c.description =
      "Of a configuration (.yaml): computes one stage and what it needs, on coarse cells, and draws it: an axial, a "
      "coronal and a sagittal slice of the scan with its outline, and its surface. So a threshold can be tried in "
      "seconds; with --cache only what changed is computed. Nothing is published. Of a file that a tool or `run "
      "--keep` "
      "wrote: draws that, on the slices of --volume.\n\n"
      "The picture shows the scan as it is, with its face unless the scene takes it away: it is a tool's picture and "
      "no "
      "part of a case.";
  c.examples = {"trephine preview configs/ct_head.yaml --series FOLDER --stage skull.segment --output skull.png",
                "trephine preview configs/ct_head.yaml --series FOLDER --stage skull.segment "
                "--set skull.segment.lower_hu=300 --cache tries --output skull.png",
                "trephine preview skull.nrrd --volume head.nrrd --output skull.png"};
  cli::Argument input =
      cli::argument("input", Kind::in_file, "A configuration (.yaml), or a result's file (.nrrd, .vtp, .json).");
  cli::Argument output = cli::argument("output", Kind::out_file, "Where the picture goes (.png).");
  input.positional = input.required = output.required = true;
  cli::Argument set = cli::argument("set", Kind::text, "Override anatomy.stage.parameter=value, as for `run`.");
  cli::Argument root =
      cli::argument("root", Kind::in_folder, "A further folder that paths in the configuration may lead to.");
  cli::Argument scan = cli::argument(
      "scan", Kind::text, "NAME=PATH: a further scan that the configuration names (mr=FOLDER); overrides its path.");
  set.repeated = root.repeated = scan.repeated = true;
  c.arguments = {
      input,
      output,
      cli::argument("volume", Kind::in_file, "Of a result's file: the CT volume that the slices show (.nrrd)."),
      cli::argument("series", Kind::in_scan, "Folder of the CT series; overrides the configuration's."),
      cli::argument("landmarks", Kind::in_file, "Landmarks that a person placed, as for `run`."),
      scan,
      set,
      root,
      cli::argument("cache", Kind::out_folder, "Folder of the stage cache, such as LIBRARY/.trephine-cache.")};
  c.groups = {cli::ParameterGroup::of<publish::PreviewParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const bool of_config = parsed.path("input").extension() == ".yaml" || parsed.path("input").extension() == ".yml";
    check_flags(parsed, of_config);
    publish::Preview made;
    {
      cli::ProgressDisplay display(parsed.quiet);
      if (of_config) {
        publish::PreviewRequest request;
        request.config = parsed.path("input");
        request.overrides.series = parsed.path("series");
        request.overrides.landmarks = parsed.path("landmarks");
        request.overrides.set = parsed.all("set");
        request.overrides.scans = named_paths("--scan", parsed.all("scan"));
        for (const std::string& r : parsed.all("root")) request.overrides.roots.emplace_back(r);
        request.params = parsed.params<publish::PreviewParams>();
        request.cache = parsed.path("cache");
        DisplayObserver observer(display);
        made = publish::preview_stage(request, observer);
      } else {
        made = preview_file(parsed, display.start("preview"));
        display.finish("preview", "");
      }
    }
    write_file(parsed.path("output"), made.png);
    for (const std::string& w : made.report.warnings) log_warning(w);
    made.report.warnings.clear();
    if (!parsed.quiet) std::cout << stages::report_text(made.report);
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
