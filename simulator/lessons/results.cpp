// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "lesson/approval.h"

namespace trephine::lessons {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int max_levels = 16;

struct NoReport {};

Json parsed(std::string_view bytes) {
  try {
    Json j = Json::parse(bytes.begin(), bytes.end(), [](int depth, Json::parse_event_t, Json&) {
      if (depth > max_levels) throw Error(ExitCode::bad_input, "", "", "nests too deep");
      return true;
    });
    if (!j.is_object() || !j.contains("trephine_score")) throw NoReport();
    return j;
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, "", "", "is no JSON");
  }
}

Json parsed(const fs::path& file) {
  const std::vector<char> bytes = read_file(file, 8 << 20);
  return parsed(std::string_view(bytes.data(), bytes.size()));
}

template <class T>
T value_of(const Json& j, const char* key, T otherwise) {
  const auto at = j.find(key);
  return at == j.end() || at->is_null() ? otherwise : at->get<T>();
}

void add_figure(AttemptResult& r, const std::string& name, const Json& value) {
  if (r.figure(name)) return;
  if (value.is_boolean()) r.figures.emplace_back(name, value.get<bool>() ? 1 : 0);
  if (value.is_number()) r.figures.emplace_back(name, value.get<double>());
}

AttemptResult report_of(const Json& j) {
  AttemptResult r;
  r.participant = j.at("participant").get<std::string>();
  r.module = j.at("module").get<std::string>();
  r.case_token = j.at("case").get<std::string>();
  for (const std::string* token : {&r.participant, &r.module}) lesson::validate_token(*token, "participant");
  r.task = value_of<std::string>(j, "task", "");
  r.outcome = value_of<std::string>(j, "outcome", "");
  r.reason = value_of<std::string>(j, "reason", "");
  r.checked = value_of<std::string>(j, "checked", "");
  r.seal = value_of<std::string>(j, "seal", "");
  r.recording_sha256 = value_of<std::string>(j, "recording_sha256", "");
  r.motion_sha256 = value_of<std::string>(j, "motion_sha256", "");
  r.rubric_sha256 = value_of<std::string>(j, "rubric_sha256", "");
  r.announced_rubric_sha256 = value_of<std::string>(j, "announced_rubric_sha256", "");
  r.points = j.at("points").get<int>();
  r.most_points = j.at("most_points").get<int>();
  for (const Json& row : j.at("rows")) {
    const Json& score = row.at("score");
    r.rows.push_back({row.at("name").get<std::string>(), row.at("title").get<std::string>(),
                      score.is_number_integer() ? std::optional<int>(score.get<int>()) : std::nullopt});
    for (const auto& [name, value] : row.at("measured").items()) add_figure(r, name, value);
  }
  if (j.contains("critical"))
    for (const Json& e : j["critical"]) r.critical.push_back(e.at("error").get<std::string>());
  if (j.contains("facts")) {
    r.procedure_s = value_of<double>(j["facts"], "procedure_s", 0);
    add_figure(r, "procedure_s", j["facts"].value("procedure_s", Json()));
    add_figure(r, "most_force_n", j["facts"].value("most_force_n", Json()));
  }
  for (const char* part : {"figures", "motion"})
    if (j.contains(part))
      for (const auto& [name, value] : j[part].items()) add_figure(r, name, value);
  if (j.contains("motion"))
    for (const auto& [name, value] : j["motion"].items())
      if (value.is_number()) r.motion.emplace_back(name, value.get<double>());
  return r;
}

// Files in an order that does not depend on the file system.
std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->path().extension() == ".json" && at->is_regular_file(failed)) files.push_back(at->path());
  if (failed) throw Error(ExitCode::no_input, folder.string(), "", "cannot be listed");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

void number_attempts(Results& all) {
  std::map<std::pair<std::string, std::string>, int> counts;
  std::map<std::string, std::string> motions;
  std::vector<AttemptResult> kept;
  for (AttemptResult& r : all.attempts) {
    if (!r.motion_sha256.empty()) {
      const auto [at, is_new] = motions.emplace(r.motion_sha256, r.report);
      if (!is_new) {
        all.notes.push_back({"{}: its motion is that of {}, and it is left out", {r.report, at->second}});
        continue;
      }
    }
    r.attempt = ++counts[{r.participant, r.module}];
    kept.push_back(r);
  }
  all.attempts = kept;
}

std::optional<double> AttemptResult::figure(const std::string& name) const {
  for (const auto& [known, value] : figures)
    if (known == name) return value;
  return std::nullopt;
}

AttemptResult parse_report(std::string_view json) {
  try {
    return report_of(parsed(json));
  } catch (const Json::exception&) {
    throw Error(ExitCode::bad_input, "", "", "is no report of a lesson, or a damaged one");
  } catch (const NoReport&) {
    throw Error(ExitCode::bad_input, "", "", "is no report of a lesson (score --json writes one)");
  }
}

void require_one_rubric(const Results& results) {
  std::map<std::string, const AttemptResult*> first;  // by module
  for (const AttemptResult& r : results.attempts) {
    const AttemptResult& other = *first.emplace(r.module, &r).first->second;
    if (other.rubric_sha256 == r.rubric_sha256) continue;
    throw Error(
        ExitCode::bad_input, "", r.module,
        other.report + " and " + r.report + " were scored by different rubrics (rubric_sha256 " +
            other.rubric_sha256.substr(0, 12) + " and " + r.rubric_sha256.substr(0, 12) +
            "), so that their points cannot stand together; --cases and --rubric score all of them anew by one");
  }
}

AttemptResult read_report(const fs::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 8 << 20);
    AttemptResult r = parse_report({bytes.data(), bytes.size()});
    r.report = file.stem().string();
    r.folder = file.parent_path();
    std::error_code ignored;
    r.recording_is_there = fs::exists(fs::path(file).replace_extension(".lesson"), ignored);
    return r;
  });
}

Results read_results(const fs::path& folder) {
  Results all;
  std::map<std::string, std::pair<const ExercisePlan*, std::size_t>> planned;  // by name of the report
  const std::vector<fs::path> files = files_of(folder);
  const std::string ending = ".plan.json";
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    if (name.size() <= ending.size() || name.compare(name.size() - ending.size(), ending.size(), ending) != 0) continue;
    try {
      all.plans.push_back(read_plan(file));
    } catch (const Error& e) {
      all.notes.push_back({"{}: left out: {}", {name, e.what()}});
    }
  }
  for (const ExercisePlan& plan : all.plans)
    for (std::size_t n = 0; n < plan.cases.size(); ++n)
      planned[planned_file(folder, plan, n, "").filename().string()] = {&plan, n};
  std::vector<std::pair<std::size_t, AttemptResult>> found;  // with the place in its plan
  for (const fs::path& file : files) {
    if (file.stem().extension() == ".plan") continue;
    try {
      parsed(file);
    } catch (const NoReport&) {
      continue;
    } catch (const Error& e) {
      all.notes.push_back({"{}: left out: {}", {file.filename().string(), e.what()}});
      continue;
    }
    try {
      AttemptResult r = read_report(file);
      std::size_t place = 0;
      if (const auto at = planned.find(r.report); at != planned.end()) {
        const auto& [plan, n] = at->second;
        r.group = plan->group;
        r.level = plan->level;
        r.phase = plan->cases[n].phase;
        place = n;
      }
      if (!r.recording_is_there)
        all.notes.push_back({"{}: the recording is gone; the report stands and cannot be judged again", {r.report}});
      found.emplace_back(place, r);
    } catch (const Error& e) {
      all.notes.push_back({"{}: left out: {}", {file.filename().string(), e.what()}});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::tie(a.second.participant, a.second.module, a.first) <
           std::tie(b.second.participant, b.second.module, b.first);
  });
  for (auto& [place, r] : found) all.attempts.push_back(r);
  number_attempts(all);
  if (all.attempts.empty() && all.plans.empty())
    throw Error(ExitCode::no_input, folder.string(), "", "holds no report of a lesson and no plan of an exercise");
  return all;
}

}  // namespace trephine::lessons
