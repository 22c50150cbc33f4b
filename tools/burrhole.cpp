// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/burr_hole.h"

#include "commands.h"
#include "named_values.h"
#include "segmentation/landmarks.h"
#include "stage_command.h"
#include "stages/data_files.h"

namespace trephine {
namespace {

// The file's landmarks; those of the command line win.
StageData with_given(const std::filesystem::path& file, const std::map<std::string, Vec3>& given) {
  std::vector<CaseLandmark> own;
  for (const auto& [name, position_mm] : given) own.push_back({name, position_mm, 1, "given"});
  return std::make_shared<const HeadLandmarks>(merged(read_head_landmarks(file), own));
}

}  // namespace

Command burrhole_command() {
  const StageType stage = burr_hole_stage("burr_hole", {});
  Command c;
  c.name = "burrhole";
  c.summary = stage.summary;
  c.description = stage.description;
  c.examples = {
      "trephine burrhole skull.vtp --skin skin.vtp --landmark nasion=0,-95,10 --landmark inion=0,98,0 --output "
      "hole.json",
      "trephine burrhole skull.vtp --at position --position-mm -30,-40,70 --diameter-mm 12 --output hole.json"};
  Argument skull, skin, landmark, landmarks, output;
  skull.name = "skull";
  skull.help = stage.ports[0].help + " (.vtp).";
  skull.positional = skull.required = true;
  skin.name = "skin";
  skin.help = stage.ports[1].help + " (.vtp).";
  landmark.name = "landmark";
  landmark.kind = Argument::Kind::text;
  landmark.repeated = true;
  landmark.help = "NAME=X,Y,Z: a landmark, LPS, mm: nasion, inion, tragus_left, tragus_right, or what --toward names.";
  landmarks.name = "landmarks";
  landmarks.help = "File of landmarks: of `trephine landmarks` (.json), or of 3D Slicer (.mrk.json, .fcsv).";
  output.name = "output";
  output.kind = Argument::Kind::out_file;
  output.help = "Where the cutter goes (.json).";
  output.required = true;
  c.arguments = {skull, skin, landmark, landmarks, output, report_argument()};
  c.groups = {ParameterGroup::of<BurrHoleParams>("Parameters")};
  c.run = [](const ParsedCommand& parsed) {
    const auto given = named_positions("--landmark", parsed.all("landmark"));
    // Contradictions of the command line are told before anything is read.
    const auto& params = parsed.params<BurrHoleParams>();
    if (parsed.has("landmarks"))
      check_request(params, ExitCode::usage);
    else
      request_of(params, "burr_hole", given, ExitCode::usage);
    run_with_report(parsed, [&](const Progress& progress) {
      StageInputs inputs;
      for (const char* port : {"skull", "skin"})
        if (parsed.has(port)) inputs.by_port[port] = load_data(parsed.path(port), DataKind::mesh);
      if (parsed.has("landmarks")) inputs.by_port["landmarks"] = with_given(parsed.path("landmarks"), given);
      Report report;
      save_data(parsed.path("output"),
                burr_hole_stage("burr_hole", given).run(parsed.groups[0], inputs, report, progress));
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
