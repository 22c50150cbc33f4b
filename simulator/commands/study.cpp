// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study.h"

#include <iostream>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/results_table.h"
#include "study/plots.h"

namespace trephine::commands {
namespace {

namespace fs = std::filesystem;

study::Table input_table(const fs::path& input, const cli::ParsedCommand& parsed) {
  if (fs::is_directory(input)) {
    lessons::Results results = lessons::read_results(input);
    score_anew(results, parsed);
    for (const texts::Phrase& note : results.notes) log_warning(note.english());
    return table_of(results);
  }
  for (const char* name : {"cases", "rubric", "scores_cache"})
    if (parsed.has(name))
      throw Error(ExitCode::usage, "", "table", "must be a folder of reports and recordings to be scored anew");
  if (input.extension() == ".json") {
    lessons::Results one;
    one.attempts.push_back(lessons::read_report(input));
    return table_of(one);
  }
  return study::read_table(input);
}

// Where gnuplot is missing the page has no pictures, and that is told.
std::vector<std::pair<study::StudyPlot, std::string>> drawn(const study::Study& s) {
  std::vector<std::pair<study::StudyPlot, std::string>> pictures;
  try {
    for (const study::StudyPlot& plot : study::plots_of(s))
      pictures.emplace_back(plot, gnuplot_picture(gnuplot_svg(study::plot_width, study::plot_height), plot.script));
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    log_warning("the plots are left out: " + e.file() + ": " + e.what());
    pictures.clear();
  }
  return pictures;
}

ExitCode run_study(const cli::ParsedCommand& parsed) {
  const fs::path input = parsed.path("table");
  study::Table table = input_table(input, parsed);
  if (parsed.has("roster"))
    with_file(parsed.text("roster"), [&] {
      table = study::joined(table, study::read_table(parsed.path("roster")),
                            parsed.params<study::StudyParams>().participant);
    });
  const study::Study result =
      with_file(input.string(), [&] { return study::evaluate(table, parsed.params<study::StudyParams>()); });
  std::cout << study::study_text(result);
  if (!parsed.has("out")) return ExitCode::ok;
  const fs::path out = parsed.path("out");
  make_output_folder(out);
  const auto pictures = drawn(result);
  if (!pictures.empty()) make_output_folder(out / "plots");
  for (const auto& [plot, svg] : pictures) write_file(out / "plots" / (plot.file + ".svg"), svg);
  write_file(out / "table.csv", study::table_csv(table));
  write_file(out / "tests.csv", study::study_csv(result));
  write_file(out / "study.json", study::study_json(result));
  write_file(out / "study.html", study::study_page(result, pictures));
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand study_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "study";
  c.summary = "evaluates results of participants by the statistics of chapter 8";
  c.description =
      "Reads a table (CSV, a row for each attempt), a log of attempts, or a folder of the reports that lessons leave, "
      "and compares each measure: groups by Welch's t test, Mann-Whitney, Kruskal-Wallis and Dunn's test, phases and "
      "attempts within participants by the paired t test and the signed-rank test, with p values corrected by Holm or "
      "Bonferroni, effect sizes with intervals, and the learning curve. Of acceptable and other results it makes the "
      "table of the dissertation's last experiment. Participants are tokens. What is missing, too little or equal is "
      "listed, never left out silently. docs/how-to/study.md explains each number.\n\n"
      "With --out it writes study.html, study.json, tests.csv, table.csv, and box plots, histograms and learning "
      "curves as plots/*.svg.";
  c.arguments = {
      cli::positional_argument("table", Kind::in_path,
                               "The table (.csv), or a folder of reports, or one report (.json)."),
      cli::argument("roster", Kind::in_file, "Further columns by participant (.csv), such as group and level."),
      cli::argument("out", Kind::out_folder, "Folder of the page, the tables and the plots.")};
  for (cli::Argument& a : anew_arguments()) c.arguments.push_back(std::move(a));
  c.groups = {cli::ParameterGroup::of<study::StudyParams>("Parameters")};
  c.examples = {"trephine-sim study results --out study --measures points,procedure_s",
                "trephine-sim study screws.csv --count n --acceptable acceptable --unit row"};
  c.run = run_study;
  return c;
});

}  // namespace trephine::commands
