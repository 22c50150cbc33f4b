// SPDX-License-Identifier: GPL-3.0-or-later
// The commands that look at a library, or keep it clean.
#include <iostream>

#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "library/job.h"
#include "library/keeping.h"
#include "library/metrics.h"
#include "library/sheet.h"

namespace trephine::tools {
namespace {

cli::Argument library_argument() {
  return cli::positional_argument("library", cli::Argument::Kind::in_folder, "The library's folder.");
}

cli::Argument json_argument() {
  cli::Argument a;
  a.name = "json";
  a.kind = cli::Argument::Kind::out_file;
  a.help = "Also write the result as JSON here (/dev/stdout: instead of the table).";
  return a;
}

// The text goes to stdout, unless the JSON does.
void tell(const cli::ParsedCommand& parsed, const std::string& text, const std::string& json) {
  const bool to_stdout = parsed.path("json") == "/dev/stdout";
  std::cout << (to_stdout ? json : text);
  if (parsed.has("json") && !to_stdout) write_file(parsed.path("json"), json);
}

struct VerifyParams {
  bool load = true;
  template <class V>
  static void describe(V& v) {
    v.flag(&VerifyParams::load, "load", "Also load every case as a simulator would.");
  }
};

struct SheetParams {
  bool sheet = false, metrics = false;
  template <class V>
  static void describe(V& v) {
    v.flag(&SheetParams::sheet, "sheet", "Make the library's contact sheet again: contact_sheet.png and index.html.");
    v.flag(&SheetParams::metrics, "metrics",
           "Write the state of the library as Prometheus reads it, instead of the table.");
  }
};

}  // namespace

const cli::OwnCommand library_list_command([] {
  cli::Command c;
  c.name = "library list";
  c.summary = "lists the cases of a library with their figures";
  c.description =
      "Lists class, volume of the ventricles, Evans' index, shift of the midline, triangles, largest deviation, "
      "warnings, age and version of every case, from case.json and run.json. What is wrong with a case is shown in its "
      "row.";
  c.examples = {"trephine library list library", "trephine library list library --class hydrocephalic",
                "trephine library list library --json list.json --sheet", "trephine library list library --metrics"};
  c.arguments = {library_argument(), json_argument()};
  c.groups = {cli::ParameterGroup::of<library::LibraryFilter>("Filter"),
              cli::ParameterGroup::of<SheetParams>("Output")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const std::filesystem::path folder = parsed.path("library");
    const bool metrics = parsed.params<SheetParams>().metrics;
    library::LibraryTable table;
    library::LibraryMetrics figures;
    library::LibraryJson json;
    library::each_case(folder, parsed.params<library::LibraryFilter>(), [&](const library::CaseRow& row) {
      if (metrics)
        figures.add(row);
      else
        table.add(row);
      if (parsed.has("json")) json.add(row);
    });
    tell(parsed, metrics ? figures.text(library::read_batches(library::LibraryState(folder), true)) : table.text(),
         json.text());
    if (parsed.params<SheetParams>().sheet) library::make_sheet(folder);
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_show_command([] {
  cli::Command c;
  c.name = "library show";
  c.summary = "shows all figures of one case of a library";
  c.description =
      "Shows surfaces, felt shapes, landmarks, burr holes, the patient's figures, and the warnings of the case's run.";
  c.examples = {"trephine library show library head-01"};
  const cli::Argument token = cli::positional_argument("case", cli::Argument::Kind::text, "Name of the case.");
  c.arguments = {library_argument(), token, json_argument()};
  c.run = [](const cli::ParsedCommand& parsed) {
    const library::CaseRow row = library::read_library_case(parsed.path("library"), parsed.text("case"));
    library::LibraryJson json;
    json.add(row);
    tell(parsed, library::case_text(row), json.text());
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_verify_command([] {
  cli::Command c;
  c.name = "library verify";
  c.summary = "compares every byte of a library's cases with their checksums";
  c.description = "Ends with exit code 65 where a case is damaged, and names every damaged case.";
  c.examples = {"trephine library verify library", "trephine library verify library --case head-01"};
  cli::Argument only;
  only.name = "case";
  only.kind = cli::Argument::Kind::text;
  only.help = "Only this case.";
  only.repeated = true;
  c.arguments = {library_argument(), only};
  c.groups = {cli::ParameterGroup::of<VerifyParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    library::VerifyResult result;
    {
      cli::ProgressDisplay display(parsed.quiet);
      result = library::verify_library(parsed.path("library"), parsed.all("case"), parsed.params<VerifyParams>().load,
                                       display.start("verify"));
    }
    std::cout << result.table;
    return result.faults.empty() ? ExitCode::ok : ExitCode::bad_input;
  };
  return c;
});

const cli::OwnCommand library_gc_command([] {
  cli::Command c;
  c.name = "library gc";
  c.summary = "removes from a library what nothing refers to any more";
  c.description =
      "Removes files of older states of a case, remains of killed runs, outputs of stages that were not used for long, "
      "records of cases that are gone, what the desk kept of them, and what batches of Slurm left that ended an hour "
      "ago or more. With --config also scans that were dropped on the desk's page and that no case uses. It is safe "
      "beside "
      "running builds: a case that is being built is left alone. "
      "No case is ever removed.";
  c.examples = {"trephine library gc library", "trephine library gc library --dry-run",
                "trephine library gc library --config configs/library.yaml"};
  c.arguments = {library_argument(),
                 cli::argument("config", cli::Argument::Kind::in_file,
                               "Its LIBRARY.yaml: scans that were dropped on the desk lie beside it.")};
  c.groups = {cli::ParameterGroup::of<library::GcParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const Progress progress([](double) {}, &cancel_requested());
    const library::GcResult result =
        library::collect_garbage(parsed.path("library"), parsed.params<library::GcParams>(), progress,
                                 parsed.has("config") ? parsed.path("config") : std::filesystem::path());
    std::cout << result.table;
    return ExitCode::ok;
  };
  return c;
});

const cli::OwnCommand library_job_command([] {
  cli::Command c;
  c.name = "library job";
  c.summary = "does one job of a library build";
  c.hidden = true;
  c.arguments = {cli::positional_argument("name", cli::Argument::Kind::text, "Which of the build's jobs.")};
  c.run = [](const cli::ParsedCommand& parsed) {
    return static_cast<ExitCode>(library::run_library_job(parsed.text("name")));
  };
  return c;
});

}  // namespace trephine::tools
