// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/results_table.h"

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "lessons/score_anew.h"
#include "lessons/score_recording.h"

namespace trephine::commands {

std::vector<cli::Argument> anew_arguments() {
  using Kind = cli::Argument::Kind;
  return {cli::argument("cases", Kind::in_folder,
                        "Score the attempts anew from their recordings, in the cases of this library; needs --rubric."),
          cli::argument("rubric", Kind::in_file, "The rubric by which they are scored anew (.json)."),
          cli::argument("scores_cache", Kind::out_folder,
                        "Keep here what was scored anew, by digest; nobody else should be able to write there."),
          cli::argument("signed_by", Kind::in_file,
                        "The teacher's public key (.pem): each attempt is then called signed or not signed; needs "
                        "--cases and --rubric, since only points that come from a signed recording are signed.")};
}

void score_anew(lessons::Results& results, const cli::ParsedCommand& parsed) {
  if (parsed.has("cases") != parsed.has("rubric"))
    throw Error(ExitCode::usage, "", parsed.has("cases") ? "--rubric" : "--cases",
                "is missing: attempts are scored anew by both");
  if (parsed.has("cases")) {
    lessons::ScoreAnew anew{parsed.path("cases"), lessons::read_rubric_file(parsed.path("rubric"))};
    if (parsed.has("signed_by")) anew.public_key = parsed.path("signed_by");
    if (parsed.has("scores_cache")) {
      anew.cache = parsed.path("scores_cache");
      make_output_folder(anew.cache);
    }
    lessons::score_anew(results, anew);
  } else if (parsed.has("scores_cache") || parsed.has("signed_by")) {
    throw Error(ExitCode::usage, "", parsed.has("signed_by") ? "--signed-by" : "--scores-cache",
                "needs --cases and --rubric");
  }
  lessons::require_one_rubric(results);
}

study::Table table_of(const lessons::Results& results) {
  study::Table all;
  std::vector<std::vector<std::pair<std::string, std::string>>> rows;
  for (const lessons::AttemptResult& r : results.attempts) {
    std::vector<std::pair<std::string, std::string>> row = {{"participant", r.participant},
                                                            {"group", r.group},
                                                            {"level", r.level},
                                                            {"phase", r.phase},
                                                            {"module", r.module},
                                                            {"attempt", std::to_string(r.attempt)},
                                                            {"case", r.case_token},
                                                            {"task", r.task},
                                                            {"outcome", r.outcome},
                                                            {"critical_errors", joined(r.critical, "+")},
                                                            {"signature", lessons::name_of(r.signature)},
                                                            {"points", std::to_string(r.points)},
                                                            {"most_points", std::to_string(r.most_points)},
                                                            {"completed", r.outcome.empty()          ? ""
                                                                          : r.outcome == "completed" ? "1"
                                                                                                     : "0"},
                                                            {"failed", r.outcome.empty()       ? ""
                                                                       : r.outcome == "failed" ? "1"
                                                                                               : "0"}};
    for (const lessons::ResultRow& one : r.rows)
      row.emplace_back(one.name + "_score", one.score ? std::to_string(*one.score) : "");
    for (const auto& [name, value] : r.figures) row.emplace_back(name, to_text(value));
    rows.push_back(row);
    for (const auto& [name, value] : row)
      if (!all.column(name)) all.columns.push_back(name);
  }
  for (std::size_t n = 0; n < rows.size(); ++n) {
    std::vector<std::string> cells(all.columns.size());
    for (const auto& [name, value] : rows[n]) cells[*all.column(name)] = value;
    all.rows.push_back(cells);
    all.lines.push_back(n + 2);
  }
  for (std::size_t c = all.columns.size(); c-- > 0;)
    if (std::all_of(all.rows.begin(), all.rows.end(), [&](const auto& row) { return row[c].empty(); })) {
      all.columns.erase(all.columns.begin() + std::ptrdiff_t(c));
      for (auto& row : all.rows) row.erase(row.begin() + std::ptrdiff_t(c));
    }
  return all;
}

}  // namespace trephine::commands
