// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/curriculum.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "base/joined.h"
#include "base/refusal.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "lesson/approval.h"

namespace trephine::lessons {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> classes_of(const CurriculumParams& params, const std::vector<std::string>& known_classes) {
  if (known_classes.empty()) return {""};
  const std::vector<std::string> all = split_at(params.classes, ',');
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (std::find(known_classes.begin(), known_classes.end(), all[n]) == known_classes.end())
      throw Error(ExitCode::usage, "", "--classes",
                  printable(all[n]) + " is no class that can be exercised; known are " + joined(known_classes));
    if (std::find(all.begin(), all.begin() + std::ptrdiff_t(n), all[n]) != all.begin() + std::ptrdiff_t(n))
      throw Error(ExitCode::usage, "", "--classes", all[n] + " is named twice");
  }
  return all;
}

// A number that belongs to the seed and the case, whatever else the library holds.
std::string chance_of(const CurriculumCase& c, const CurriculumParams& params) {
  return Sha256().integer(params.order_seed).text(c.token).hex();
}

std::string why_left_out(const fs::path& folder, const cases::CaseManifest& m, const LessonType& module,
                         CurriculumCase& out) {
  const std::optional<lesson::CaseApproval> approval = lesson::read_approval(folder);
  if (!approval) return "not approved";
  if (approval->case_sha256 != out.case_sha256) return "changed since " + approval->by + " approved it";
  module.require(m);
  if (!module.classes.empty()) out.patient_class = class_of(m);
  if (const std::string fault = class_fault(module, out.patient_class); !fault.empty()) return fault;
  if (m.case_token != folder.filename().string()) return "its folder has another name than the case, " + m.case_token;
  for (const LessonTask& t : offered_tasks(module, m)) out.tasks.push_back(t.name);
  out.token = m.case_token;
  out.approved_by = approval->by;
  out.difficulty_level = approval->difficulty_level;
  out.folder = folder;
  return "";
}

// A chest is no head that failed: only what could have served is named with the reason.
bool is_of_another_lesson(const cases::CaseManifest& m, const LessonType& module) {
  try {
    module.require(m);
    return false;
  } catch (const Error&) {
  }
  const std::vector<LessonType>& all = lesson_types();
  return std::any_of(all.begin(), all.end(), [&](const LessonType& other) {
    return other.name != module.name && use_of(other, m).why_not.empty();
  });
}

}  // namespace

LibraryCases cases_for_lessons(const fs::path& library, const LessonType& module) {
  std::vector<fs::path> folders;
  std::error_code fault;
  for (const auto& entry : fs::directory_iterator(library, fault))
    if (fs::exists(entry.path() / "case.json")) folders.push_back(entry.path());
  if (fault) throw Error(ExitCode::no_input, library.string(), "", "cannot be listed");
  std::sort(folders.begin(), folders.end());
  LibraryCases out;
  for (const fs::path& folder : folders) {
    CurriculumCase c;
    std::string why;
    try {
      const std::vector<char> bytes = read_file(folder / "case.json", 1 << 26);
      const cases::CaseManifest m = cases::parse_case_json({bytes.data(), bytes.size()});
      if (is_of_another_lesson(m, module)) {
        ++out.of_other_lessons;
        continue;
      }
      c.case_sha256 = sha256_of_bytes({bytes.data(), bytes.size()});
      why = why_left_out(folder, m, module, c);
    } catch (const Error& e) {  // one damaged case must not keep a class from its lesson
      why = e.what();
    }
    if (why.empty())
      out.approved.push_back(c);
    else
      out.left_out.emplace_back(folder.filename().string(), why);
  }
  return out;
}

void require_approved(const fs::path& case_folder, const std::string& case_sha256, const std::string& approved_sha256) {
  if (case_sha256 == approved_sha256) return;
  throw refusal("case.json", "was exchanged while the lesson ran: it is no longer the one that was approved",
                {"look at the case, approve it anew, and run `exercise` again: the recording is kept"})
      .in_file(case_folder.string());
}

std::string assigned_task(const CurriculumCase& c, const CurriculumParams& params) {
  if (c.tasks.empty()) return "";
  if (params.task.empty()) return c.tasks.front();
  if (params.task == "drawn")
    return c.tasks[std::stoul(Sha256().integer(params.order_seed).text(c.token).text("task").hex().substr(0, 8),
                              nullptr, 16) %
                   c.tasks.size()];
  if (std::find(c.tasks.begin(), c.tasks.end(), params.task) != c.tasks.end()) return params.task;
  throw Error(ExitCode::usage, "", "--task",
              printable(params.task) + " cannot be asked for in " + c.token + ", which has " + joined(c.tasks));
}

std::vector<CurriculumCase> plan_curriculum(const std::vector<CurriculumCase>& cases, const CurriculumParams& params,
                                            const LessonType& module) {
  if (params.least_difficulty_level > params.most_difficulty_level)
    throw Error(ExitCode::usage, "", "--least-difficulty-level", "is above --most-difficulty-level");
  std::vector<std::vector<CurriculumCase>> groups;
  for (const std::string& name : classes_of(params, module.classes)) {
    std::vector<CurriculumCase>& group = groups.emplace_back();
    for (const CurriculumCase& c : cases)
      if (c.patient_class == name && c.difficulty_level >= params.least_difficulty_level &&
          c.difficulty_level <= params.most_difficulty_level)
        group.push_back(c);
    const bool by_difficulty = params.order == CurriculumParams::Order::difficulty;
    std::sort(group.begin(), group.end(), [&](const CurriculumCase& a, const CurriculumCase& b) {
      if (by_difficulty && a.difficulty_level != b.difficulty_level) return a.difficulty_level < b.difficulty_level;
      return chance_of(a, params) < chance_of(b, params);
    });
  }
  std::vector<CurriculumCase> plan;
  for (std::size_t round = 0; plan.size() < std::size_t(params.cases_count); ++round) {
    bool any = false;
    for (const auto& group : groups)
      if (round < group.size() && plan.size() < std::size_t(params.cases_count)) {
        plan.push_back(group[round]);
        any = true;
      }
    if (!any) break;
  }
  return plan;
}

}  // namespace trephine::lessons
