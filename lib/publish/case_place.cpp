// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/case_place.h"

#include "base/error.h"
#include "base/write_file.h"
#include "cases/new_case.h"

namespace trephine::publish {
namespace fs = std::filesystem;
namespace {

// What a killed run left there is no part of this run's case.
void clear_out(const fs::path& folder) {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(folder))
    if (!is_lock(entry.path().filename())) all.push_back(entry.path());
  std::error_code ignored;
  for (const fs::path& path : all) fs::remove_all(path, ignored);
}

}  // namespace

CasePlace::CasePlace(const fs::path& case_folder) : folder_(case_folder), made_in_(case_folder) {
  if (cases::is_free_for_case(folder_)) {
    made_in_ = cases::new_case_folder(folder_);
    make_output_folder(made_in_);
    try {
      lock_.emplace(made_in_);
    } catch (const Error&) {
      std::error_code ignored;
      fs::remove(made_in_, ignored);  // fails where another run writes in it
      throw;
    }
    if (cases::is_free_for_case(folder_)) {
      clear_out(made_in_);
      return;
    }
    // Another run published the case between the two looks.
    std::error_code ignored;
    fs::remove_all(made_in_, ignored);
    lock_.reset();
    made_in_ = folder_;
  }
  make_output_folder(folder_);
  lock_.emplace(folder_);
}

CasePlace::~CasePlace() {
  std::error_code ignored;
  if (made_in_ == folder_)
    remove_unpublished();
  else if (lock_)
    fs::remove_all(made_in_, ignored);
}

void CasePlace::require_held() const {
  if (!lock_ || lock_->is_held()) return;
  throw Error(
      ExitCode::busy, folder_.string(), "",
      "this process stood still for longer than its lease lasts, and another run may build the case: try again");
}

void CasePlace::appear() {
  if (made_in_ == folder_) return;
  cases::let_case_appear(made_in_, folder_);
  made_in_ = folder_;
}

// A folder in which nothing was ever published, for somebody's files lay there, shall not look like a case.
void CasePlace::remove_unpublished() const {
  std::error_code ignored;
  // Where the disk does not tell whether there is a case, one may be there.
  if (!lock_ || fs::symlink_status(folder_ / "case.json", ignored).type() != fs::file_type::not_found) return;
  // Only files that a run makes are removed; any other file keeps the folder.
  for (const char* ours : {"meshes", "report"}) fs::remove_all(folder_ / ours, ignored);
  for (const auto& entry : fs::directory_iterator(folder_, ignored))
    if (!is_lock(entry.path().filename())) return;
  std::vector<fs::path> locks;
  for (const auto& entry : fs::directory_iterator(folder_, ignored)) locks.push_back(entry.path());
  for (const fs::path& lock : locks) fs::remove_all(lock, ignored);
  fs::remove(folder_, ignored);
}

NewFolders::~NewFolders() {
  std::error_code ignored;
  for (auto f = missing_.rbegin(); f != missing_.rend(); ++f)
    fs::remove(*f, ignored);  // fails where the folder holds something
}

void NewFolders::expect(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path f = fs::absolute(folder).lexically_normal();
       f.has_relative_path() && fs::status(f, error).type() == fs::file_type::not_found; f = f.parent_path())
    missing.push_back(f);
  missing_.insert(missing_.end(), missing.rbegin(), missing.rend());
}

}  // namespace trephine::publish
