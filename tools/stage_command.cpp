// SPDX-License-Identifier: GPL-3.0-or-later
#include "stage_command.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include "base/error.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/progress_display.h"
#include "grid/bounded_read.h"
#include "head/landmarks.h"
#include "named_values.h"
#include "stages/data_files.h"

namespace trephine::tools {

cli::Argument report_argument() {
  cli::Argument a;
  a.name = "report";
  a.kind = cli::Argument::Kind::out_file;
  a.help = "Write the stage's report as JSON.";
  return a;
}

void run_with_report(const cli::ParsedCommand& parsed, const std::function<Report(const Progress&)>& work) {
  Report report;
  {
    cli::ProgressDisplay display(parsed.quiet);
    report = work(display.start(parsed.command->name));
    display.finish(parsed.command->name, "");
  }
  const std::string json = stages::report_json(report);
  for (const std::string& w : report.warnings) log_warning(w);
  report.warnings.clear();
  if (!parsed.quiet) std::cout << stages::report_text(report);
  if (parsed.has("report")) write_file(parsed.path("report"), json);
}

namespace {

constexpr const char* landmark_flag = "landmark";

bool takes_landmarks(const stages::StageType& stage) {
  return std::any_of(stage.ports.begin(), stage.ports.end(),
                     [](const stages::Port& p) { return p.kind == stages::DataKind::landmarks; });
}

cli::Argument argument_of(const stages::Port& port, bool positional) {
  cli::Argument a;
  a.name = port.group();
  a.positional = positional;
  a.required = port.required;
  std::string extension = stages::file_extension(port.kind);
  if (port.or_field) extension += ", .nrrd";
  if (port.kind == stages::DataKind::landmarks) extension += ", .mrk.json, .fcsv";
  a.help = port.help + " (" + extension + ").";
  if (!port.is_many()) return a;
  a.kind = cli::Argument::Kind::text;
  a.repeated = true;
  a.help = (port.kind == stages::DataKind::cutters ? "FILE: " : "NAME=FILE: ") + a.help;
  return a;
}

stages::StageData load_surface_or_field(const std::filesystem::path& file) {
  if (file.extension() != ".nrrd") return stages::load_data(file, stages::DataKind::mesh);
  grid::BoundedGrid nrrd = with_file(file.string(), [&] { return grid::read_nrrd_bounded(file, grid::labels_limit); });
  if (holds_hu(nrrd.keys))
    throw Error(ExitCode::bad_input, file.string(), "content", "HU, must be a field: segment it first");
  return std::make_shared<const grid::Field>(grid::to_field(std::move(nrrd.grid)));
}

stages::StageData load_port(const stages::Port& port, const std::filesystem::path& file) {
  if (port.or_volume) return stages::load_field_or_volume(file);
  if (port.or_field) return load_surface_or_field(file);
  return stages::load_data(file, port.kind);
}

// The landmarks of the file, if there is one; those of the flags replace them.
stages::StageData load_landmarks(const cli::ParsedCommand& parsed, const std::string& port) {
  std::vector<cases::CaseLandmark> own;
  for (const auto& [name, at] : named_positions("--landmark", parsed.all(landmark_flag)))
    own.push_back({name, at, 1, "given"});
  if (!parsed.has(port)) {
    head::HeadLandmarks given;
    given.landmarks = std::move(own);
    return std::make_shared<const head::HeadLandmarks>(std::move(given));
  }
  const auto read = std::get<std::shared_ptr<const head::HeadLandmarks>>(
      stages::load_data(parsed.path(port), stages::DataKind::landmarks));
  return std::make_shared<const head::HeadLandmarks>(head::merged(*read, own));
}

// Adds the file's name to a fault of a landmark that it gave.
template <class F>
auto naming_landmarks_file(const stages::StageType& stage, const cli::ParsedCommand& parsed, F&& f) {
  try {
    return f();
  } catch (Error& e) {
    const auto given = named_positions("--landmark", parsed.all(landmark_flag));
    for (const std::string& name : e.about())
      for (const stages::Port& port : stage.ports)
        if (port.kind == stages::DataKind::landmarks && parsed.has(port.name) && given.count(name) == 0)
          for (const cases::CaseLandmark& l : head::read_landmark_file(parsed.path(port.name)))
            if (l.name == name) e.in_file(parsed.path(port.name).string());
    throw;
  }
}

void check_output(const stages::StageType& stage, const cli::ParsedCommand& parsed) {
  if (stage.output == stages::DataKind::nothing) return;
  const std::filesystem::path to = parsed.path("output");
  if (to.extension() != stages::file_extension(stage.output))
    throw Error(ExitCode::usage, to.string(), "output",
                std::string("must end in ") + stages::file_extension(stage.output));
}

}  // namespace

stages::StageInputs stage_inputs(const stages::StageType& stage, const cli::ParsedCommand& parsed) {
  stages::StageInputs inputs;
  bool took_landmarks = false;  // --landmark is of the first such port; another one holds what nobody gave
  for (const stages::Port& port : stage.ports) {
    const std::string flag = port.group();
    const bool takes_flags = port.kind == stages::DataKind::landmarks && !std::exchange(took_landmarks, true);
    if (takes_flags && (parsed.has(flag) || parsed.has(landmark_flag))) {
      inputs.by_port[port.name] = load_landmarks(parsed, flag);
    } else if (port.is_many()) {
      const std::vector<std::string> given = parsed.all(flag);
      for (std::size_t i = 0; i < given.size(); ++i) {
        const bool named = port.kind != stages::DataKind::cutters;
        const auto [name, file] =
            named ? named_value("--" + flag, given[i]) : std::make_pair(std::to_string(1000 + i), given[i]);
        if (inputs.by_port.count(flag + "." + name))
          throw Error(ExitCode::usage, "", "--" + flag, name + ", is given twice");
        inputs.by_port[flag + "." + name] = load_port(port, file);
      }
    } else if (parsed.has(flag)) {
      inputs.by_port[port.name] = load_port(port, parsed.path(flag));
    }
  }
  return inputs;
}

cli::Command make_stage_command(const stages::StageType& stage) {
  cli::Command c;
  c.name = stage.name;
  std::replace(c.name.begin(), c.name.end(), '_', '-');
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = stage.examples;
  for (const stages::Port& port : stage.ports)
    c.arguments.push_back(argument_of(port, &port == &stage.ports[0] && !port.is_many()));
  if (takes_landmarks(stage)) {
    cli::Argument landmark;
    landmark.name = landmark_flag;
    landmark.kind = cli::Argument::Kind::text;
    landmark.repeated = true;
    landmark.help = "NAME=X,Y,Z: a landmark, LPS, mm; it replaces the file's.";
    c.arguments.push_back(landmark);
  }
  if (stage.output != stages::DataKind::nothing) {
    cli::Argument output;
    output.name = "output";
    output.kind = cli::Argument::Kind::out_file;
    output.help = std::string("Where the ") + stages::to_text(stage.output) + " goes (" +
                  stages::file_extension(stage.output) + ").";
    output.required = true;
    c.arguments.push_back(output);
  }
  c.arguments.push_back(report_argument());
  c.groups.push_back({"Parameters", stage.make_params});
  c.run = [stage](const cli::ParsedCommand& parsed) {
    check_output(stage, parsed);
    run_with_report(parsed, [&](const Progress& progress) {
      const stages::StageInputs inputs = stage_inputs(stage, parsed);
      const stages::StageOutcome made =
          naming_landmarks_file(stage, parsed, [&] { return stage.run(parsed.groups[0], inputs, progress); });
      if (stage.output != stages::DataKind::nothing) stages::save_data(parsed.path("output"), made.data);
      return made.report();
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine::tools
