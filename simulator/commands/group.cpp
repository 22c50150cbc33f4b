// SPDX-License-Identifier: GPL-3.0-or-later
#include <iostream>
#include <set>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/results_table.h"
#include "group/group_view.h"
#include "group/group_words.h"
#include "study/plots.h"

namespace trephine::commands {
namespace {

namespace fs = std::filesystem;

// Groups and levels by participant, where the plans do not say them.
void add_roster(lessons::Results& results, const fs::path& file) {
  with_file(file.string(), [&] {
    const study::Table roster = study::read_table(file);
    const std::optional<std::size_t> who = roster.column("participant");
    if (!who) throw Error(ExitCode::bad_input, "", "participant", "is no column of the roster");
    for (const char* name : {"group", "level"}) {
      const std::optional<std::size_t> at = roster.column(name);
      if (!at) continue;
      const auto put = [&](const std::string& participant, std::string& value) {
        for (const auto& row : roster.rows)
          if (row[*who] == participant && value.empty()) value = row[*at];
      };
      const bool group = std::string(name) == "group";
      for (lessons::AttemptResult& r : results.attempts) put(r.participant, group ? r.group : r.level);
      for (lessons::ExercisePlan& p : results.plans) put(p.participant, group ? p.group : p.level);
    }
  });
}

// Points by phase and level, and over attempts, by the plots of a study.
auto pictures_of(const study::Table& table, const group::GroupView& view, texts::Language language) {
  const auto words = [&](const texts::Phrase& phrase) { return group::group_words(language, phrase); };
  decltype(group::GroupPageParts::pictures) pictures;
  try {
    for (const group::ModuleView& m : view.modules) {
      study::StudyParams params;
      params.measures = "points";
      params.only = "module=" + m.module;
      std::set<std::string> levels;
      for (const lessons::AttemptResult& r : m.attempts) levels.insert(r.level);
      if (levels.size() > 1 && table.column("level")) params.group = "level";
      if (m.attempts.empty()) continue;
      for (const study::StudyPlot& plot : study::plots_of(study::evaluate(table, params), words))
        if (plot.file.find("-histogram") == std::string::npos)
          pictures[m.module].emplace_back(
              plot.title, gnuplot_picture(gnuplot_svg(study::plot_width, study::plot_height), plot.script));
    }
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    log_warning("the plots are left out: " + e.file() + ": " + e.what());
  }
  return pictures;
}

ExitCode run_group(const cli::ParsedCommand& parsed) {
  lessons::Results results = lessons::read_results(parsed.path("results"));
  score_anew(results, parsed);
  if (parsed.has("roster")) add_roster(results, parsed.path("roster"));
  const group::GroupView view = group::view_of(results, parsed.params<group::GroupParams>());
  const texts::Language language = parsed.params<group::GroupParams>().language;
  const study::Table table = table_of(results);
  for (const texts::Phrase& note : view.notes) log_warning(note.english());
  if (parsed.has("csv")) write_file(parsed.path("csv"), study::table_csv(table));
  group::GroupPageParts parts{pictures_of(table, view, language), {}};
  if (parsed.has("answers"))
    with_file(parsed.text("answers"),
              [&] { parts.answers = study::evaluate(study::read_table(parsed.path("answers")), {}); });
  write_file(parsed.path("page"), group::group_page(view, parts, language));
  if (!parsed.quiet)
    for (const group::ModuleView& m : view.modules)
      std::cout << m.module << ": " << m.participants.size() << " participants, " << m.attempts.size() << " attempts\n";
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand group_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "group";
  c.summary = "shows what a group of participants did, as one page for the teacher";
  c.description =
      "Reads the plans and reports that `exercise` leaves in a folder, and writes one HTML page: who did what, points "
      "by phase and over attempts, rows of the score, critical errors and by whom, what was kept until a later test, "
      "the pass mark that two contrasting levels set, and figures of motion beside those of experts. Reports that are "
      "damaged and recordings that are gone are listed. With --cases and --rubric all is scored anew from the "
      "recordings, "
      "and a report that says something else is refused (80); reports by several rubrics are not shown together. --csv "
      "writes the same results as a table for `study`.";
  c.arguments = {cli::positional_argument("results", Kind::in_folder, "Folder of plans and reports."),
                 cli::required_argument("page", Kind::out_file, "Write the page to this file (.html)."),
                 cli::argument("csv", Kind::out_file, "Write a row for each attempt to this file (.csv)."),
                 cli::argument("answers", Kind::in_file,
                               "Answers to a questionnaire, as `trephine questionnaire` writes them (.csv)."),
                 cli::argument("roster", Kind::in_file,
                               "Columns participant, group and level (.csv), where the plans do not say them.")};
  for (cli::Argument& a : anew_arguments()) c.arguments.push_back(std::move(a));
  c.groups = {cli::ParameterGroup::of<group::GroupParams>("Parameters")};
  c.examples = {"trephine-sim group results --page group.html --less-level student --more-level expert",
                "trephine-sim group results --page group.html --cases library --rubric ventriculostomy.rubric.json"};
  c.run = run_group;
  return c;
});

}  // namespace trephine::commands
