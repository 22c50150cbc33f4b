// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "lessons/lesson_type.h"

namespace trephine::commands {
namespace {

struct LessonsParams {
  bool json = false;
  template <class V>
  static void describe(V& v) {
    v.flag(&LessonsParams::json, "json", "Print one JSON object instead of text.");
  }
};

void print_text(const cases::CaseManifest& manifest) {
  for (const lessons::LessonType& type : lessons::lesson_types()) {
    const lessons::LessonUse use = lessons::use_of(type, manifest);
    std::vector<std::string> sure, doubtful;
    for (const std::string& task : use.tasks) {
      std::string why;
      for (const auto& [name, doubt] : use.doubtful)
        if (name == task) why = doubt;
      (why.empty() ? sure : doubtful).push_back(why.empty() ? task : task + " (" + why + ")");
    }
    std::string said = use.why_not.empty() ? "" : ": cannot serve: " + use.why_not;
    if (!sure.empty()) said += ": serves: " + joined(sure);
    if (!doubtful.empty()) said += (sure.empty() ? ": doubtful: " : "; doubtful: ") + joined(doubtful);
    std::cout << type.name << printable(said) << "\n";
  }
}

void print_json(const cases::CaseManifest& manifest, const std::string& sha256) {
  nlohmann::ordered_json out = {
      {"case", manifest.case_token}, {"case_sha256", sha256}, {"lessons", nlohmann::ordered_json::array()}};
  for (const lessons::LessonType& type : lessons::lesson_types()) {
    const lessons::LessonUse use = lessons::use_of(type, manifest);
    nlohmann::ordered_json doubtful = nlohmann::ordered_json::object();
    for (const auto& [task, why] : use.doubtful) doubtful[task] = why;
    out["lessons"].push_back(
        {{"name", type.name}, {"tasks", use.tasks}, {"doubtful", doubtful}, {"why_not", use.why_not}});
  }
  std::cout << out.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << "\n";
}

ExitCode run_lessons(const cli::ParsedCommand& parsed) {
  const std::filesystem::path file = parsed.path("case") / "case.json";
  std::string sha256;
  const cases::CaseManifest manifest = with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 26);
    sha256 = sha256_of_bytes({bytes.data(), bytes.size()});
    return cases::parse_case_json({bytes.data(), bytes.size()});
  });
  if (parsed.params<LessonsParams>().json)
    print_json(manifest, sha256);
  else
    print_text(manifest);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand lessons_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "lessons";
  c.summary = "says which lessons a case can serve, what each may ask for, and why another cannot be done in it";
  c.description =
      "Reads case.json alone. `trephine library approve` prints the same before a reviewer's token stands beside the "
      "case. A task whose landmark is doubtful is named with the reason: what a lesson measures from it is not judged.";
  c.arguments = {cli::positional_argument("case", Kind::in_folder, "Folder of the case.")};
  c.groups = {cli::ParameterGroup::of<LessonsParams>("Parameters")};
  c.examples = {"trephine-sim lessons library/sample", "trephine-sim lessons library/sample --json"};
  c.run = run_lessons;
  return c;
});

}  // namespace trephine::commands
