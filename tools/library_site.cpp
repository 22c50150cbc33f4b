// SPDX-License-Identifier: GPL-3.0-or-later
// The commands by which a site builds a library on a cluster, or with another engine.
#include <iostream>

#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "library/catalogue.h"
#include "library/plan_formats.h"
#include "library/slurm_engine.h"
#include "library/status.h"
#include "library/timeline.h"
#include "library_request.h"

namespace trephine::tools {
namespace {

using Kind = cli::Argument::Kind;

struct PlanFormatParams {
  library::PlanFormat format = library::PlanFormat::json;
  template <class V>
  static void describe(V& v) {
    using F = library::PlanFormat;
    v.choice(&PlanFormatParams::format, "format", {{"json", F::json}, {"ninja", F::ninja}, {"make", F::make}},
             "For which engine: a build file of Ninja, a makefile, or JSON for any other.");
  }
};

// --flag, or the library's folder by its place.
cli::Argument library_folder() { return cli::positional_argument("library", Kind::in_folder, "The library's folder."); }

}  // namespace

const cli::OwnCommand library_plan_command([] {
  cli::Command c;
  c.name = "library plan";
  c.summary = "writes what a library build would do, for another engine to do";
  c.description =
      "Finds by content which cases are stale, as `library build` does, and writes the jobs that make them: a build "
      "file of Ninja, a makefile, or JSON with each job's name, what it comes after, its memory, its time limit, why "
      "it is stale, and its command. Each command is `trephine library one`. The plan is of this moment: make a new "
      "one for every build.";
  c.examples = {"trephine library plan LIBRARY.yaml --out library --format ninja --output library.ninja",
                "trephine library plan LIBRARY.yaml --out library --format make --output library.mk"};
  c.arguments = library_arguments();
  c.arguments.push_back(cli::argument("output", Kind::out_file, "Where to write it; else to standard output."));
  c.groups = {cli::ParameterGroup::of<PlanFormatParams>("Format"),
              cli::ParameterGroup::of<library::LibraryBuildParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const library::LibraryBuildRequest request = library_request(parsed);
    std::string text;
    {
      cli::ProgressDisplay display(parsed.quiet);
      text = library::plan_text(library::plan_of_library(request, display.start("plan")),
                                parsed.params<PlanFormatParams>().format);
    }
    if (parsed.has("output"))
      write_file(parsed.path("output"), text);
    else
      std::cout << text;
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_one_command([] {
  cli::Command c;
  c.name = "library one";
  c.summary = "does one job of a library's plan";
  c.description =
      "Builds one case of a library (case.NAME), or makes one phantom (phantom.NAME), if it is stale, and records what "
      "it was built of. Several may work on a library at once. It is what the plans of `library plan` run.";
  c.examples = {"trephine library one LIBRARY.yaml --out library case.head-01"};
  c.arguments = library_arguments();
  c.arguments.insert(c.arguments.begin() + 1,
                     cli::positional_argument("job", Kind::text, "case.NAME or phantom.NAME, as the plan says."));
  c.groups = {cli::ParameterGroup::of<library::LibraryBuildParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const library::JobResult result = library::do_one_of_library(library_request(parsed), parsed.text("job"));
    if (result.code != 0) throw Error(static_cast<ExitCode>(result.code), "", parsed.text("job"), result.reason);
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_status_command([] {
  cli::Command c;
  c.name = "library status";
  c.summary = "says what a cluster does of a library, and what failed";
  c.description =
      "Lists the jobs of a library that Slurm has: which run and where, which wait, were built, failed, or were lost "
      "and will be submitted again, and how often each was submitted; then the cases whose last build failed. With "
      "--config also which cases are stale and not under way.";
  c.examples = {"trephine library status library", "trephine library status library --config LIBRARY.yaml"};
  c.arguments = {library_folder(),
                 cli::argument("config", Kind::in_file, "The library's configuration, to find what is stale."),
                 cli::argument("json", Kind::out_file, "Also write it as JSON here.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    std::optional<library::LibraryBuildRequest> request;
    if (parsed.has("config")) {
      request.emplace();
      request->config = parsed.path("config");
      request->library = parsed.path("library");
      request->program_version = "trephine " TREPHINE_VERSION;
    }
    const library::LibraryStatus status = library::status_of_library(parsed.path("library"), request);
    std::cout << status.table;
    if (parsed.has("json")) write_file(parsed.path("json"), status.json);
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_cancel_command([] {
  cli::Command c;
  c.name = "library cancel";
  c.summary = "ends what a cluster does of a library";
  c.description =
      "Cancels all jobs of the library that wait or run in Slurm. Cases that are published stay as they are; "
      "`library build` later builds what is missing.";
  c.examples = {"trephine library cancel library"};
  c.arguments = {library_folder()};
  c.run = [](const cli::ParsedCommand& parsed) {
    const int count = library::cancel_batches(
        library::LibraryState(std::filesystem::absolute(parsed.path("library")).lexically_normal()));
    if (!parsed.quiet)
      std::cout << (count == 0 ? "no cluster works on this library\n"
                               : std::to_string(count) + (count == 1 ? " batch" : " batches") + " cancelled\n");
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_timeline_command([] {
  cli::Command c;
  c.name = "library timeline";
  c.summary = "draws when each case of the last build ran, and where its time went";
  c.description =
      "Writes an SVG picture of the library's last build: a lane for each place on each node, a bar for each job, "
      "parted by the stages that took its time, and the sum of each stage.";
  c.examples = {"trephine library timeline library --output timeline.svg"};
  c.arguments = {library_folder(), cli::required_argument("output", Kind::out_file, "The picture (.svg) to write.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const library::LibraryState state(std::filesystem::absolute(parsed.path("library")).lexically_normal());
    if (!std::filesystem::exists(state.timeline_file()))
      throw Error(ExitCode::no_input, state.library().string(), "", "has no timeline yet: `library build` writes it");
    const auto items = library::read_timeline(state);
    library::StagesOfCases stages;
    library::each_case(state.library(), {},
                       [&](const library::CaseRow& row) { stages[row.token] = row.stage_seconds; });
    write_file(parsed.path("output"), library::timeline_svg(items, stages));
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_task_command([] {
  cli::Command c;
  c.name = "library task";
  c.summary = "does one task of a job array";
  c.hidden = true;
  c.arguments = {cli::positional_argument("batch", Kind::in_folder, "The batch's folder."),
                 cli::positional_argument("array", Kind::text, "Which of its arrays.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const int array = std::atoi(parsed.text("array").c_str());
    return static_cast<ExitCode>(library::run_slurm_task(parsed.path("batch"), array));
  };
  return c;
});

const cli::OwnCommand library_finish_command([] {
  cli::Command c;
  c.name = "library finish";
  c.summary = "ends a batch of jobs, or submits again what was lost";
  c.hidden = true;
  c.arguments = {cli::positional_argument("batch", Kind::in_folder, "The batch's folder.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    return static_cast<ExitCode>(library::run_last_slurm_job(parsed.path("batch")));
  };
  return c;
});

}  // namespace trephine::tools
