// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/rubric.h"

#include <iostream>

#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/rubric_types.h"
#include "rubric_file.h"

namespace trephine::tools {

const cli::OwnCommand rubric_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "rubric";
  c.summary = "checks a rubric, by which lessons are scored, and compiles it for the simulator";
  c.description =
      "A rubric (configs/rubrics/*.yaml) gives the limits by which `trephine-sim score` judges a recorded lesson, and "
      "says of each whether it is the dissertation's or ours, and why. The simulator reads no YAML: it takes the JSON "
      "that this command writes, which is checked and carries the SHA-256 of what it says. docs/explanation/lessons.md "
      "tells what "
      "each row measures.";
  c.examples = {"trephine rubric configs/rubrics/ventriculostomy.yaml --output ventriculostomy.rubric.json"};
  const cli::Argument file = cli::positional_argument("config", Kind::in_file, "The rubric (.yaml).");
  const cli::Argument output = cli::required_argument("output", Kind::out_file, "Write the compiled rubric here.");
  c.arguments = {file, output};
  c.run = [](const cli::ParsedCommand& parsed) {
    const std::filesystem::path from = parsed.path("config");
    const std::string json = lesson::compile_rubric(read_rubric_yaml(from));
    const lesson::CompiledRubric again =
        lesson::read_rubric(json, lessons::rubric_types());  // what is written is what will be read
    write_file(parsed.path("output"), json);
    if (!parsed.quiet) std::cout << parsed.text("output") << "  rubric " << again.sha256.substr(0, 16) << "\n";
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
