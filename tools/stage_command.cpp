// SPDX-License-Identifier: GPL-3.0-or-later
#include "stage_command.h"

#include <cstdio>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/progress_display.h"
#include "stages/data_files.h"

namespace trephine {

Argument report_argument() {
  Argument a;
  a.name = "report";
  a.kind = Argument::Kind::out_file;
  a.help = "Write what was achieved as JSON.";
  return a;
}

void run_with_report(const ParsedCommand& parsed, const std::function<Report(const Progress&)>& work) {
  Report report;
  {
    ProgressDisplay display(parsed.quiet);
    report = work(display.start(parsed.command->name));
    display.finish(parsed.command->name, "");
  }
  const std::string json = report_json(report);
  for (const std::string& w : report.warnings) log_warning(w);
  report.warnings.clear();
  if (!parsed.quiet) std::fputs(report_text(report).c_str(), stdout);
  if (parsed.has("report")) write_file(parsed.path("report"), json);
}

Command make_stage_command(const StageType& stage, std::vector<std::string> examples) {
  Command c;
  c.name = stage.name;
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = std::move(examples);
  for (const Port& port : stage.ports) {
    Argument a;
    a.name = port.name;
    a.kind = Argument::Kind::in_file;
    a.help = port.help + " (" + file_extension(port.kind) + ").";
    a.positional = &port == &stage.ports[0];
    a.required = port.required;
    c.arguments.push_back(a);
  }
  Argument output;
  output.name = "output";
  output.kind = Argument::Kind::out_file;
  output.help = std::string("Where the ") + to_text(stage.output) + " goes (" + file_extension(stage.output) + ").";
  output.required = true;
  c.arguments.push_back(output);
  c.arguments.push_back(report_argument());
  c.groups.push_back({"Parameters", stage.make_params});
  c.run = [stage](const ParsedCommand& parsed) {
    const std::filesystem::path to = parsed.path("output");
    if (to.extension() != file_extension(stage.output))
      throw Error(ExitCode::usage, to.string(), "output", std::string("must end in ") + file_extension(stage.output));
    run_with_report(parsed, [&](const Progress& progress) {
      StageInputs inputs;
      for (const Port& port : stage.ports)
        if (parsed.has(port.name))
          inputs.by_port[port.name] = port.or_volume ? load_field_or_volume(parsed.path(port.name))
                                                     : load_data(parsed.path(port.name), port.kind);
      Report report;
      save_data(to, stage.run(parsed.groups[0], inputs, report, progress));
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
