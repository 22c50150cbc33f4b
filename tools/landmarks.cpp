// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/landmarks.h"

#include "base/error.h"
#include "commands.h"
#include "named_values.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine {
namespace {

/// A fault of a landmark that the file gave names the file.
template <class F>
auto with_given_file(const ParsedCommand& parsed, F&& f) {
  try {
    return f();
  } catch (Error& e) {
    const bool by_flag = named_positions("--landmark", parsed.all("landmark")).count(e.field()) > 0;
    if (parsed.has("given") && !by_flag)
      for (const CaseLandmark& l : read_landmark_file(parsed.path("given")))
        if (l.name == e.field()) e.in_file(parsed.path("given").string());
    throw;
  }
}

/// Those of the flags, then those of the file that no flag names.
std::vector<CaseLandmark> given_landmarks(const ParsedCommand& parsed) {
  std::vector<CaseLandmark> given;
  for (const auto& [name, at] : named_positions("--landmark", parsed.all("landmark")))
    given.push_back({name, at, 1, "given"});
  if (!parsed.has("given")) return given;
  const std::size_t flags = given.size();
  for (const CaseLandmark& l : read_landmark_file(parsed.path("given"))) {
    bool named = false;
    for (std::size_t i = 0; i < flags; ++i) named = named || given[i].name == l.name;
    if (!named) given.push_back(l);
  }
  return given;
}

}  // namespace

Command landmarks_command() {
  Command c = make_stage_command(
      landmarks_stage(),
      {"trephine landmarks volume.nrrd --skin skin.nrrd --skull skull.nrrd --ventricles ventricles.nrrd --output "
       "landmarks.json",
       "trephine landmarks volume.nrrd --skin skin.nrrd --skull skull.nrrd --given points.mrk.json --output "
       "landmarks.json"});
  Argument landmark, given;
  landmark.name = "landmark";
  landmark.kind = Argument::Kind::text;
  landmark.repeated = true;
  landmark.help = "NAME=X,Y,Z: a landmark that is known, LPS, mm; it wins over what is found.";
  given.name = "given";
  given.help = "File with landmarks that are known: 3D Slicer's .mrk.json or .fcsv, or .json as this command writes.";
  c.arguments.push_back(landmark);
  c.arguments.push_back(given);
  c.run = [](const ParsedCommand& parsed) {
    const std::filesystem::path to = parsed.path("output");
    if (to.extension() != file_extension(DataKind::landmarks))
      throw Error(ExitCode::usage, to.string(), "output",
                  std::string("must end in ") + file_extension(DataKind::landmarks));
    const StageType stage = landmarks_stage(given_landmarks(parsed));
    run_with_report(parsed, [&](const Progress& progress) {
      StageInputs inputs;
      for (const Port& port : stage.ports)
        if (parsed.has(port.name)) inputs.by_port[port.name] = load_data(parsed.path(port.name), port.kind);
      Report report;
      save_data(to, with_given_file(parsed, [&] { return stage.run(parsed.groups[0], inputs, report, progress); }));
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
