// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/lesson_uses.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/own_files.h"
#include "base/spawn.h"
#include "base/temporary_folder.h"
#include "base/text.h"
#include "base/write_file.h"

namespace trephine::library {

std::optional<std::vector<LessonUse>> lesson_uses(const std::filesystem::path& case_folder,
                                                  const std::string& case_sha256) {
  const std::filesystem::path simulator = own_file({"trephine-sim"});
  if (simulator.empty()) return {};
  const TemporaryFolder temporary;
  SpawnRequest request;
  request.argv = {simulator.string(), "lessons", case_folder.string(), "--json", "--quiet"};
  request.output = temporary.path() / "said";
  request.own_group = true;
  const Ended ended = wait_for(spawn(request), until_it_ends_s);
  const std::vector<char> said = read_file(request.output, 16 << 20);
  if (ended.code != 0) throw Error(ExitCode::bad_input, "", "", printable({said.data(), said.size()}));
  std::vector<LessonUse> uses;
  try {
    const auto all = nlohmann::ordered_json::parse(said.begin(), said.end());
    if (!case_sha256.empty() && all.at("case_sha256") != case_sha256)
      throw Error(ExitCode::bad_input, (case_folder / "case.json").string(), "",
                  "changed while it was read; try again");
    for (const auto& lesson : all.at("lessons")) {
      LessonUse use{lesson.at("name"), lesson.at("tasks"), {}, lesson.at("why_not")};
      for (const auto& [task, why] : lesson.at("doubtful").items()) use.doubtful.emplace_back(task, why);
      uses.push_back(std::move(use));
    }
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::internal, simulator.string(), "lessons", "says what is none of its answers");
  }
  return uses;
}

}  // namespace trephine::library
