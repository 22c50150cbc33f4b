// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/signed_points.h"

#include <nlohmann/json.hpp>

#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"
#include "lessons/results.h"
#include "lessons/score_recording.h"
#include "lessons/signature.h"

namespace trephine::lessons {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const Remedy take_it_out{"take its files out of the folder, and `exercise` has the attempt to do"};
const Remedy make_it_again{"take the report out of the folder, and `exercise` makes it again of the recording"};

[[noreturn]] void refuse(const fs::path& file, const std::string& field, const std::string& what,
                         const Remedy& remedy = make_it_again) {
  Error error = refusal(field, what, remedy);
  error.in_file(file.string());
  throw error;
}

void require_same(const fs::path& file, const char* field, const std::string& is, const std::string& must) {
  if (is != must) refuse(file, field, "is " + printable(is) + ", and the attempt is of " + must, take_it_out);
}

// What two reports of one attempt may differ in: who looked at it, and beside whose motion it is shown.
Json without_onlookers(Json report) {
  for (const char* key : {"signature", "checked", "experts", "advice"}) report.erase(key);
  return report;
}

void require_same_report(const fs::path& file, const std::string& fresh) {
  const std::vector<char> bytes = read_file(file, 8 << 20);
  with_file(file.string(), [&] { parse_report({bytes.data(), bytes.size()}); });  // refuses what is no report
  const Json shown = without_onlookers(Json::parse(bytes.begin(), bytes.end()));
  const Json given = without_onlookers(Json::parse(fresh));
  if (shown == given) return;
  if (shown.value("rubric_sha256", Json()) != given["rubric_sha256"])
    refuse(file, "rubric_sha256", "is of another rubric than the one that is given",
           {"give `exercise` the one of the report"});
  for (const auto& [key, value] : given.items())
    if (shown.value(key, Json()) != value) refuse(file, key, "is not what the signed recording gives");
  refuse(file, "", "says more than the signed recording gives");
}

}  // namespace

const char* to_text(SignedState state) {
  switch (state) {
    case SignedState::not_signed:
      return "not signed";
    case SignedState::recording:
      return "recording signed, points not compared";
    case SignedState::other_rubric:
      return "recording signed, which names another rubric or none";
    case SignedState::points:
      return "signed";
  }
  return "";
}

SignedState signed_state(const SignedAttempt& attempt, const fs::path& case_folder,
                         const lesson::CompiledRubric* rubric, const fs::path& public_key) {
  const haptics::Recording recording = haptics::read_recording(attempt.recording);
  const Signature signature = signature_of(recording.sha256, attempt.recording, public_key);
  require_no_misfit(signature, attempt.recording);
  if (signature != Signature::fits) return SignedState::not_signed;
  require_same(attempt.recording, "participant", recording.header.participant, attempt.participant);
  require_same(attempt.recording, "lesson", recording.header.lesson, attempt.module);
  require_same(attempt.recording, "case", recording.header.case_token, attempt.case_token);
  if (!rubric || case_folder.empty() || !fs::exists(attempt.report)) return SignedState::recording;
  const ScoredLesson fresh = score_recording(attempt.recording, case_folder, *rubric, Answers::replayed, public_key);
  if (fresh.recording.sha256 != recording.sha256)
    throw Error(ExitCode::bad_input, attempt.recording.string(), "", "changed while it was read: run it again");
  require_same_report(attempt.report, score_json(fresh.head, *fresh.facts, fresh.score));
  // Where it names no rubric, nobody signed points by this one.
  return fresh.head.signature == Signature::fits ? SignedState::points : SignedState::other_rubric;
}

}  // namespace trephine::lessons
