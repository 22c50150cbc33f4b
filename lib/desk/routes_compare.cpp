// SPDX-License-Identifier: GPL-3.0-or-later
// A case before its last rebuild, beside what it is now.
#include <sys/stat.h>

#include "base/log.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "cases/load_case.h"
#include "compare/compare_cases.h"
#include "desk/desk.h"
#include "desk/json_reply.h"

namespace trephine::desk {
namespace fs = std::filesystem;
namespace {

fs::path before_folder(const DeskLibrary& library, const std::string& token) {
  return library.options().library / ".library" / "desk" / (token + ".before");
}

}  // namespace

// The files of a case are named by their content and never written again, so links to them are a copy. Where a file
// system has no links, there is no comparison, and the rebuild goes on.
void keep_before(const DeskLibrary& library, const std::string& token) {
  const fs::path now = library.options().library / token, before = before_folder(library, token);
  std::error_code error;
  if (!fs::exists(now / "case.json", error)) return;
  try {
    const cases::CaseManifest manifest = cases::read_case(now);
    fs::remove_all(before);
    make_output_folder(before);
    ::chmod(before.parent_path().c_str(), 0700);
    std::vector<std::string> names = {"case.json"};
    for (const auto& file : manifest.files) names.push_back(file.name);
    for (const std::string& name : names) {
      make_output_folder((before / name).parent_path());
      fs::create_hard_link(now / name, before / name);
    }
  } catch (const std::exception& e) {
    log_warning(token + ": what it was is not kept for a comparison");
    fs::remove_all(before, error);
  }
}

Reply Desk::compare(const Request& request) {
  const std::string token = request.value("case");
  const fs::path before = before_folder(library_, token);
  std::error_code ignored;
  if (token.empty() || !fs::exists(before / "case.json", ignored))
    throw Error(ExitCode::no_input, "", "case", "was not rebuilt by the desk: there is nothing to compare with");
  const Progress progress([](double) {}, &cancel_requested());
  const cases::LoadedCase was = cases::load_case(before), is = cases::load_case(library_.options().library / token);
  const compare::CaseComparison made = compare::compare_cases(was, is, {}, progress);
  return json_reply({{"identical", made.identical}, {"text", compare::comparison_text(made)}});
}

}  // namespace trephine::desk
