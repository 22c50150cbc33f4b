// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_anew.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/refusal.h"
#include "base/spawn.h"
#include "base/write_file.h"
#include "lessons/score_recording.h"

namespace trephine::lessons {
namespace {

namespace fs = std::filesystem;

fs::path case_of(const AttemptResult& r, const fs::path& cases) {
  const fs::path token = r.case_token;
  if (token.empty() || token.filename() != token || token == "." || token == "..")
    throw Error(ExitCode::bad_input, "", "case", "is no case's token");
  const fs::path folder = cases / token;
  if (!fs::exists(folder / "case.json"))
    throw Error(ExitCode::no_input, folder.string(), "", "is missing: " + r.report + " is of that case");
  return folder;
}

AttemptResult scored(const fs::path& recording, const fs::path& folder, const ScoreAnew& params) {
  fs::path kept;
  if (!params.cache.empty()) {
    static const std::string program = sha256_of_file(own_program());  // another version may judge otherwise
    const std::string key =
        sha256_of_file(recording) + sha256_of_file(folder / "case.json") + params.rubric.sha256 + program;
    kept = params.cache / (sha256_of_bytes(key) + ".json");
    if (fs::exists(kept)) return read_report(kept);
  }
  const ScoredLesson lesson = score_recording(recording, folder, params.rubric);
  const std::string json = score_json(lesson.head, *lesson.facts, lesson.score);
  if (!kept.empty()) write_file(kept, json);
  return parse_report(json);
}

std::string said(const std::optional<int>& score) { return score ? std::to_string(*score) : "not judged"; }
std::string said(const std::vector<std::string>& names) {
  const std::string all = joined(names, "+");
  return all.empty() ? "none" : all;
}

// Throws where the report says anything that people and studies read and that its recording does not give.
void require_same(const AttemptResult& report, const AttemptResult& now) {
  const auto differs = [&](const std::string& field, const std::string& is, const std::string& gives) {
    throw refusal(field, "says " + is + ", and its recording gives " + gives + ": it was changed after it was written",
                  {"remove it, and `score` the recording again"})
        .in_file((report.folder / (report.report + ".json")).string());
  };
  const auto same = [&](const std::string& field, const std::string& is, const std::string& gives) {
    if (is != gives) differs(field, is.empty() ? "nothing" : is, gives.empty() ? "nothing" : gives);
  };
  same("recording_sha256", report.recording_sha256, now.recording_sha256);
  same("motion_sha256", report.motion_sha256, now.motion_sha256);
  same("participant", report.participant, now.participant);
  same("case", report.case_token, now.case_token);
  same("task", report.task, now.task);
  same("outcome", report.outcome, now.outcome);
  same("critical", said(report.critical), said(now.critical));
  for (const ResultRow& row : now.rows) {
    std::optional<int> score;
    for (const ResultRow& r : report.rows)
      if (r.name == row.name) score = r.score;
    same("rows." + row.name, said(score), said(row.score));
  }
  same("rows", std::to_string(report.rows.size()), std::to_string(now.rows.size()));
  same("points", std::to_string(report.points), std::to_string(now.points));
  same("most_points", std::to_string(report.most_points), std::to_string(now.most_points));
  for (const auto& [name, value] : report.figures)
    if (now.figure(name) != value)
      differs("figures." + name, std::to_string(value), now.figure(name) ? std::to_string(*now.figure(name)) : "none");
}

}  // namespace

void score_anew(Results& results, const ScoreAnew& params) {
  std::vector<AttemptResult> kept;
  for (AttemptResult& r : results.attempts) {
    if (r.module != params.rubric.module) {
      kept.push_back(r);
      continue;
    }
    if (!r.recording_is_there) {
      results.notes.push_back({"{}: the recording is gone, so that it cannot be scored anew: left out", {r.report}});
      continue;
    }
    const fs::path recording = r.folder / (r.report + ".lesson");
    AttemptResult now = scored(recording, case_of(r, params.cases), params);
    if (r.rubric_sha256 == params.rubric.sha256)
      require_same(r, now);
    else
      results.notes.push_back({"{}: was scored by another rubric, and is scored anew", {r.report}});
    now.signature = signature_for(signature_of(now.recording_sha256, recording, params.public_key),
                                  now.announced_rubric_sha256, params.rubric);
    if (now.signature == Signature::of_another_rubric)
      results.notes.push_back({"{}: what is signed names another rubric or none: not signed", {r.report}});
    if (now.signature == Signature::of_other_bytes)
      results.notes.push_back({"{}: its signature is of another recording: not signed", {r.report}});
    if (now.signature == Signature::by_another_key)
      results.notes.push_back({"{}: its signature is not by the owner of the public key: not signed", {r.report}});
    now.report = r.report;
    now.folder = r.folder;
    now.recording_is_there = true;
    now.group = r.group, now.level = r.level, now.phase = r.phase, now.attempt = r.attempt;
    kept.push_back(now);
  }
  results.attempts = kept;
  number_attempts(results);  // by the motions that the recordings have, whatever the reports said
}

}  // namespace trephine::lessons
