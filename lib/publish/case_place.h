// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "publish/case_lock.h"

namespace trephine::publish {

/// Where a run writes its case, under the case's lock: in its place where it is there already, else in a hidden folder
/// beside it, which appear() renames (cases/new_case.h). Without appear() nothing is left of a case that was not there
/// before: a folder that somebody else put files into keeps those.
class CasePlace {
 public:
  /// Makes the folder. Throws Error 73, and 75 where another run builds the case.
  explicit CasePlace(const std::filesystem::path& case_folder);
  ~CasePlace();
  CasePlace(const CasePlace&) = delete;
  CasePlace& operator=(const CasePlace&) = delete;

  const std::filesystem::path& made_in() const { return made_in_; }
  /// Throws Error 75 where the lock was a lease that was lost: another run may build the case.
  void require_held() const;
  /// To be called when everything is written. Throws Error 74.
  void appear();

 private:
  void remove_unpublished() const;
  const std::filesystem::path folder_;
  std::filesystem::path made_in_;
  std::optional<CaseLock> lock_;
};

/// Removes the folders that a run made and left empty because it failed.
class NewFolders {
 public:
  ~NewFolders();
  /// To be called before the folder is made.
  void expect(const std::filesystem::path& folder);

 private:
  std::vector<std::filesystem::path> missing_;
};

}  // namespace trephine::publish
