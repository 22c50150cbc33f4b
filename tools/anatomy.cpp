// SPDX-License-Identifier: GPL-3.0-or-later
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "consistency/anatomy_gate.h"
#include "grid/bounded_read.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine::tools {
namespace {

/// Does the stage's work and makes a picture of the worst place where one is asked for.
Report examine(const cli::ParsedCommand& parsed, const Progress& progress) {
  const char* const names[] = {"skin", "skull", "brain", "ventricles"};
  std::optional<grid::Field> given[4];
  bool any = false;
  for (int a = 0; a < 4; ++a)
    if (parsed.has(names[a])) {
      given[a] = grid::read_foreign_field(parsed.path(names[a]));
      any = true;
    }
  if (!any) throw Error(ExitCode::usage, "", "--skin, --skull, --brain, --ventricles", "none is given");
  const auto field = [&](int a) { return given[a] ? &*given[a] : nullptr; };
  std::optional<grid::HuVolume> volume;
  mask::ScanFigures scan;
  if (parsed.has("volume")) {
    volume = grid::read_foreign_hu(parsed.path("volume"));
    scan = mask::measure_scan(*volume, progress);
  }
  const head::HeadFields fields{field(0), field(1), field(2), field(3), volume ? &scan : nullptr};
  stages::StageData landmarks;
  const head::HeadLandmarks* known = nullptr;
  if (parsed.has("landmarks")) {
    landmarks = stages::load_data(parsed.path("landmarks"), stages::DataKind::landmarks);
    known = std::get<std::shared_ptr<const head::HeadLandmarks>>(landmarks).get();
  }
  const consistency::AnatomyFindings found =
      consistency::examine_anatomy(fields, known, parsed.params<consistency::AnatomyGateParams>(), progress);
  const Report report = printed(figures_of(found.result), found.warnings);
  if (parsed.has("picture") && !found.faults.empty())
    write_file(parsed.path("picture"), consistency::anatomy_picture(*volume, fields, found.faults[0]));
  if (!found.faults.empty()) {
    // The measurements are useful even where the check refuses the case.
    if (parsed.has("report")) write_file(parsed.path("report"), stages::report_json(report));
    consistency::require_anatomy(found);
  }
  return report;
}

}  // namespace

const cli::OwnCommand anatomy_command([] {
  const stages::StageType& stage = stages::stage_named("anatomy");
  cli::Command c;
  c.name = stage.name;
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = stage.examples;
  for (const stages::Port& port : stage.ports) {
    cli::Argument a = cli::argument(port.name.c_str(), cli::Argument::Kind::in_file, "");
    a.help = "File of " + port.help + " (" + stages::file_extension(port.kind) + ").";
    c.arguments.push_back(a);
  }
  c.arguments.push_back(cli::argument("picture", cli::Argument::Kind::out_file,
                                      "File for slices through the worst place, if something is wrong (.png)."));
  c.arguments.push_back(report_argument());
  c.groups = {{"Parameters", stage.make_params}};
  c.run = [](const cli::ParsedCommand& parsed) {
    if (parsed.has("picture") && !parsed.has("volume"))
      throw Error(ExitCode::usage, "", "--picture", "needs --volume, of which it is a picture");
    run_with_report(parsed, [&](const Progress& progress) { return examine(parsed, progress); });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
