// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine {

/// Only one run at a time builds a case: an flock on <case>/.lock, which a killed process cannot leave behind. Throws
/// Error 75 where another holds it, 73 where it cannot be made. Released with the object; the empty file stays.
class CaseLock {
 public:
  explicit CaseLock(const std::filesystem::path& case_folder);
  ~CaseLock();
  CaseLock(const CaseLock&) = delete;
  CaseLock& operator=(const CaseLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace trephine
