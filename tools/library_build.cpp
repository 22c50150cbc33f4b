// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>

#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "library_display.h"
#include "library_request.h"

namespace trephine::tools {

std::vector<cli::Argument> library_arguments() {
  using Kind = cli::Argument::Kind;
  cli::Argument only = cli::argument("case", Kind::text, "Only this case.");
  cli::Argument set = cli::argument("set", Kind::text, "Override anatomy.stage.parameter=value in every case.");
  cli::Argument phantom = cli::argument("phantom", Kind::text, "Override parameter=value of every phantom.");
  cli::Argument root =
      cli::argument("root", Kind::in_folder, "A further folder that paths in the configurations may lead to.");
  only.repeated = set.repeated = phantom.repeated = root.repeated = true;
  return {
      cli::positional_argument("config", Kind::in_file, "The library's configuration (.yaml)."),
      cli::required_argument("out", Kind::out_folder, "The library: the folder in which the cases' folders are made."),
      only,
      set,
      phantom,
      root};
}

library::LibraryBuildRequest library_request(const cli::ParsedCommand& parsed) {
  library::LibraryBuildRequest request;
  request.config = parsed.path("config");
  request.library = parsed.path("out");
  request.only = parsed.all("case");
  request.overrides.set = parsed.all("set");
  request.overrides.phantom = parsed.all("phantom");
  for (const std::string& r : parsed.all("root")) request.overrides.roots.emplace_back(r);
  request.params = parsed.params<library::LibraryBuildParams>();
  request.program_version = "trephine " TREPHINE_VERSION;
  return request;
}

const cli::OwnCommand library_build_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "library build";
  c.summary = "brings every case of a library up to date";
  c.description =
      "Reads LIBRARY.yaml and finds by content which cases are stale: it compares their series, the parameters and "
      "stages that they depend on, the program, and their published files. It builds the stale cases with Ninja, each "
      "by `trephine run` on one thread, as many at a time as fit into memory. A case that fails keeps its last valid "
      "state and does not stop the others. A build that was stopped or killed is continued by the next one. With "
      "--engine "
      "slurm, or engine: in LIBRARY.yaml, a cluster builds them (docs/how-to/cluster.md). The exit status is that of "
      "the first "
      "case that failed.";
  c.examples = {"trephine library build configs/library.yaml --out library",
                "trephine library build LIBRARY.yaml --out library --dry-run",
                "trephine library build LIBRARY.yaml --out library --why head-01",
                "trephine library build LIBRARY.yaml --out library --engine slurm --no-wait",
                "trephine library build LIBRARY.yaml --out library --set skull.decimate.max_deviation_mm=0.2"};
  c.arguments = library_arguments();
  cli::Argument why = cli::argument("why", Kind::text, "Say why this case would be built, and build nothing.");
  why.repeated = true;
  c.arguments.push_back(why);
  c.arguments.push_back(
      cli::argument("json", Kind::out_file, "Also write here, as JSON, what was built and what failed."));
  c.groups = {cli::ParameterGroup::of<library::LibraryBuildParams>("Parameters")};
  c.only_looks = [](const cli::ParsedCommand& parsed) {
    return parsed.params<library::LibraryBuildParams>().dry_run || parsed.has("why");
  };
  c.run = [](const cli::ParsedCommand& parsed) {
    library::LibraryBuildRequest request = library_request(parsed);
    request.why = parsed.all("why");
    library::LibraryBuildResult result;
    {
      LibraryDisplay display(parsed.quiet);
      result = library::build_library(request, display);
    }
    const bool asked = request.params.dry_run || !request.why.empty();
    if (asked || !parsed.quiet) {
      std::cout << result.table;
    } else if (result.code != 0) {
      const std::string& t = result.table;
      for (std::size_t at = 0, end; (end = t.find('\n', at)) != std::string::npos; at = end + 1)
        log_line("trephine library build: " + t.substr(at, end - at));
    }
    if (parsed.has("json")) write_file(parsed.path("json"), result.json);
    return static_cast<ExitCode>(result.code);
  };
  return c;
});

}  // namespace trephine::tools
